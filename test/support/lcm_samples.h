// One well-formed message of each type, small enough to count its bytes by hand.
#ifndef LCM_SAMPLES_H
#define LCM_SAMPLES_H

#include <bot_core_gps_data_t.h>
#include <bot_core_image_t.h>
#include <bot_core_pose_t.h>
#include <vdna_msg_command_result_t.h>
#include <vdna_msg_command_t.h>
#include <vdna_msg_localisation_t.h>
#include <vdna_msg_ranking_t.h>
#include <vdna_msg_status_t.h>

static char *sample_experiences[] = {"autumn", "snow"};
static double sample_distances[] = {5.5, 7.25};
static int8_t sample_tied[] = {0, 1};
static int8_t sample_bound[] = {1, 0};
static double sample_recalls[] = {0.75, 0.5};
static double sample_lows[] = {0.625, 0.375};
static double sample_highs[] = {0.875, 0.625};
static double sample_transfers[] = {0.8125, 0.25};

static char *sample_taps[] = {"embedding", "feat"};
static int32_t sample_neurons[] = {512, 3};
static double sample_reason_bins[] = {0.5, -0.25};
static double sample_live_bins[] = {100.5, 20};
static double sample_winner_bins[] = {110.25, 30};
static double sample_runner_up_bins[] = {400.75, 10};
static int32_t sample_winner_most[] = {7, -1};
static int32_t sample_winner_least[] = {9, -1};
static int32_t sample_runner_up_most[] = {11, -1};
static int32_t sample_runner_up_least[] = {0, -1};

static const vdna_msg_ranking_t sample_ranking = {
    .utime = 1700000000000002,
    .window_begin_utime = 1700000000000001,
    .window_frames = 42,
    .validity = VDNA_MSG_RANKING_T_VALID,
    .repeated = 1,
    .backbone = "lite0",
    .comparable = "ab12",
    .map_hash = "0123456789abcdef",
    .margin_bins = 1.75,
    .ranked_by = "transfer",
    .verdict = "poor",
    .unlike = 0.0625,
    .no_prediction = "",
    .skill = 0.5,
    .settled_frames = 12,
    .previous = "snow",
    .count = 2,
    .experience = sample_experiences,
    .distance_bins = sample_distances,
    .tied = sample_tied,
    .bound = sample_bound,
    .predicted_recall = sample_recalls,
    .predicted_low = sample_lows,
    .predicted_high = sample_highs,
    .transfer = sample_transfers,
    .neurons = 1280,
    .reasons = 2,
    .reason_tap = sample_taps,
    .reason_neuron = sample_neurons,
    .reason_bins = sample_reason_bins,
    .live_bin = sample_live_bins,
    .winner_bin = sample_winner_bins,
    .runner_up_bin = sample_runner_up_bins,
    .winner_most = sample_winner_most,
    .winner_least = sample_winner_least,
    .runner_up_most = sample_runner_up_most,
    .runner_up_least = sample_runner_up_least,
};

static const vdna_msg_localisation_t sample_localisation = {
    .utime = 1700000000000003,
    .validity = VDNA_MSG_LOCALISATION_T_VALID,
    .reason = "",
    .experience = "snow",
    .frame = 7,
    .frame_utime = -1,
    .has_place = 1,
    .place = 99,
    .has_position = 1,
    .position_frame = "local",
    .position = {1.5, -2.5, 0.25},
    .confidence = 0.75,
    .moving = 1,
    .nearest_frame = 8,
    .distance = 0.125,
    .predicted_recall = 0.5,
    .predicted_low = 0.25,
    .predicted_high = 0.75,
    .basis = VDNA_MSG_LOCALISATION_T_PARKED,
    .latency_us = 20000,
    .skipped = 3,
};

static char *sample_excluded[] = {"autumn"};

static const vdna_msg_status_t sample_status = {
    .utime = 1700000000000004,
    .state = VDNA_MSG_STATUS_T_VALID,
    .instance = -77,
    .serving_utime = 1700000000000001,
    .host = "robot",
    .boot_id = "f00d",
    .reason = "",
    .frame_age_us = 40000,
    .progress = 1,
    .experience = "snow",
    .predicted_recall = 0.5,
    .predicted_low = 0.25,
    .predicted_high = 0.75,
    .skill = 0.5,
    .settled_frames = 12,
    .switches = 6,
    .experiences = 2,
    .left_out = 1,
    .map_hash = "0123456789abcdef",
    .map_changed = 1,
    .pinned = "snow",
    .shadow = 1,
    .excluded_count = 1,
    .excluded = sample_excluded,
    .backbone = "lite0",
    .version = "0.1.0",
    .received = 100,
    .processed = 60,
    .parked = 12,
    .carried = 6,
    .refused = 2,
    .unusable = 1,
    .skipped = 10,
    .over_rate = 4,
    .oversized = 1,
    .late = 5,
    .rejected = 4,
    .lost = 7,
    .incomplete = 3,
    .dropped_datagrams = 8,
    .malformed_datagrams = 9,
    .repeated_datagrams = 10,
    .foreign_datagrams = 11,
    .unprotected_frames = 12,
    .corrupted_frames = 13,
    .repeated_frames = 14,
    .reordered_frames = 15,
    .lost_frames = 16,
    .restarts = 0,
    .queue_time = {10, 12, 90, 95},
    .decode_time = {2000, 2100, 2500, 2600},
    .resize_time = {500, 500, 600, 700},
    .inference_time = {5000, 5100, 6000, 8000},
    .select_time = {30, 31, 32, 33},
    .rank_time = {400, 400, 400, 400},
    .publish_time = {20, 21, 22, 23},
    .total_time = {8000, 8100, 9000, 9900},
    .resident_bytes = 50000000,
    .resident_bytes_max = 60000000,
    .picture_bytes_max = 70000,
    .window_frames_max = 42,
    .backlog_max = 5,
    .message = "",
};

static const vdna_msg_command_t sample_command = {
    .utime = 1700000000000005,
    .command = VDNA_MSG_COMMAND_T_RESET,
    .argument = "",
};

static const vdna_msg_command_result_t sample_command_result = {
    .utime = 1700000000000005,
    .command = VDNA_MSG_COMMAND_T_PIN,
    .accepted = 1,
    .text = "snow is pinned",
    .map_hash = "0123456789abcdef",
};

static uint8_t sample_value[] = {1, 2, 3};
static bot_core_image_metadata_t sample_metadata[] = {{"exposure", 3, sample_value}, {"", 0, NULL}};
static uint8_t sample_pixels[] = {10, 20, 30, 40, 50, 60};

/* Three pixels by two of grey, with two pieces of metadata. */
static const bot_core_image_t sample_image = {
    .utime = 1700000000000006,
    .width = 3,
    .height = 2,
    .row_stride = 3,
    .pixelformat = 1497715271, /* GREY */
    .size = 6,
    .data = sample_pixels,
    .nmetadata = 2,
    .metadata = sample_metadata,
};

static const bot_core_pose_t sample_pose = {
    .utime = 1700000000000007,
    .pos = {1.5, -2.5, 0.25},
    .vel = {1, 2, 3},
    .orientation = {1, 0, 0, 0},
    .rotation_rate = {0.1, 0.2, 0.3},
    .accel = {4, 5, 6},
};

static const bot_core_gps_data_t sample_gps_data = {
    .utime = 1700000000000008,
    .gps_lock = 3,
    .longitude = -1.25,
    .latitude = 51.75,
    .elev = 70.5,
    .horizontal_accuracy = 2,
    .vertical_accuracy = 4,
    .numSatellites = 9,
    .speed = 8.5,
    .heading = 0.75,
    .xyz_pos = {10, 20, 30},
    .gps_time = 1700000000.5,
};

#endif
