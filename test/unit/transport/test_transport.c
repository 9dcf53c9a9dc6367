// The transport on LCM's in-process network (memq://) and on log files.
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/time.h>
#include <time.h>
#include <unistd.h>
#include <vdna_messages.h>

#include <vdna/transport.h>

#include "cmocka_all.h"
#include "connection.h"
#include "lcm_samples.h"

#define MAX_IMAGE_BYTES 100

static vdna_transport_config memq_config(void)
{
    vdna_transport_config config;
    vdna_transport_config_init(&config);
    config.url = "memq://";
    config.max_image_bytes = MAX_IMAGE_BYTES;
    config.camera_channel = "CAMERA";
    config.command_channel = "VDNA_COMMAND";
    return config;
}

static vdna_transport *open_with(const vdna_transport_config *config)
{
    vdna_transport *transport = NULL;
    vdna_error error = {""};
    if (vdna_transport_open(config, &error, &transport) != VDNA_OK)
        fail_msg("%s", error.text);
    return transport;
}

static int open_on_memq(void **state)
{
    const vdna_transport_config config = memq_config();
    *state = open_with(&config);
    return 0;
}

static int close_transport(void **state)
{
    vdna_transport_close(*state);
    return 0;
}

// Bytes as any program on the network could send them.
static void send_raw(vdna_transport *transport, const char *channel, const void *data, size_t size)
{
    assert_int_equal(lcm_publish(transport->network.lcm, channel, data, (unsigned)size), 0);
}

static vdna_status publish_ranking(vdna_transport *transport, const vdna_msg_ranking_t *message)
{
    return vdna_transport_publish(transport, "VDNA_RANKING", &vdna_message_ranking, message);
}

static vdna_status publish_localisation(vdna_transport *transport,
                                        const vdna_msg_localisation_t *message)
{
    return vdna_transport_publish(transport, "VDNA_LOCALISATION", &vdna_message_localisation,
                                  message);
}

static vdna_status publish_status(vdna_transport *transport, const vdna_msg_status_t *message)
{
    return vdna_transport_publish(transport, "VDNA_STATUS", &vdna_message_status, message);
}

static vdna_status publish_command(vdna_transport *transport, const vdna_msg_command_t *message)
{
    return vdna_transport_publish(transport, "VDNA_COMMAND", &vdna_message_command, message);
}

static void send_picture(vdna_transport *transport, int64_t utime, size_t size)
{
    uint8_t pixels[MAX_IMAGE_BYTES + 1];
    memset(pixels, (int)utime, sizeof pixels);
    const vdna_image image = {pixels, size, (uint32_t)size, 1, 0, VDNA_PIXEL_GREY};
    assert_int_equal(vdna_transport_publish_image(transport, transport->camera, utime, &image),
                     VDNA_OK);
}

static vdna_transport_frame poll_frame(vdna_transport *transport)
{
    vdna_transport_frame frame = {.utime = -1};
    uint32_t events = 0;
    assert_int_equal(vdna_transport_poll(transport, 0, &events, &frame), VDNA_OK);
    assert_int_equal(events, VDNA_TRANSPORT_FRAME);
    return frame;
}

static uint32_t poll_events(vdna_transport *transport, int32_t timeout_ms)
{
    vdna_transport_frame frame;
    uint32_t events = UINT32_MAX;
    assert_int_equal(vdna_transport_poll(transport, timeout_ms, &events, &frame), VDNA_OK);
    return events;
}

static int64_t monotonic_us(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (int64_t)now.tv_sec * 1000000 + now.tv_nsec / 1000;
}

// --- in ---

static void a_frame_comes_with_all_its_fields(void **state)
{
    const uint8_t pixels[] = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16};
    const vdna_image sent = {pixels, sizeof pixels, 2, 2, 8, VDNA_PIXEL_BGR3};
    const int64_t before_us = monotonic_us();
    assert_int_equal(vdna_transport_publish_image(*state, "CAMERA", 123, &sent), VDNA_OK);

    const vdna_transport_frame frame = poll_frame(*state);
    assert_int_equal(frame.utime, 123);
    /* LCM's stamp is from another clock, in whole microseconds. */
    assert_in_range(frame.received_us, before_us - 1, monotonic_us());
    assert_int_equal(frame.image.width, 2);
    assert_int_equal(frame.image.height, 2);
    assert_int_equal(frame.image.row_stride, 8);
    assert_int_equal(frame.image.pixelformat, VDNA_PIXEL_BGR3);
    assert_int_equal(frame.image.size, sizeof pixels);
    assert_memory_equal(frame.image.data, pixels, sizeof pixels);
}

static void a_frame_of_another_camera_driver_comes_without_its_metadata(void **state)
{
    uint8_t bytes[256];
    const int size = bot_core_image_t_encode(bytes, 0, sizeof bytes, &sample_image);
    send_raw(*state, "CAMERA", bytes, (size_t)size);

    const vdna_transport_frame frame = poll_frame(*state);
    assert_int_equal(frame.image.size, sizeof sample_pixels);
    assert_memory_equal(frame.image.data, sample_pixels, sizeof sample_pixels);
}

static void of_several_frames_the_newest_is_kept_and_the_others_are_skipped(void **state)
{
    for (int64_t utime = 1; utime <= 3; utime++)
        send_picture(*state, utime, 10);

    const vdna_transport_frame frame = poll_frame(*state);
    assert_int_equal(frame.utime, 3);
    assert_int_equal(frame.image.data[0], 3);
    assert_int_equal(frame.skipped, 2);
    assert_int_equal(vdna_transport_count(*state)->received, 3);
    assert_int_equal(vdna_transport_count(*state)->skipped, 2);
    assert_int_equal(vdna_transport_count(*state)->backlog_max, 3);

    send_picture(*state, 4, 10);
    assert_int_equal(poll_frame(*state).skipped, 0);
    assert_int_equal(vdna_transport_count(*state)->backlog_max, 3);
}

static void the_time_in_the_queue_of_lcm_is_part_of_a_frames_age(void **state)
{
    const int64_t before_us = monotonic_us();
    send_picture(*state, 1, 10);
    const int64_t sent_us = monotonic_us();
    nanosleep(&(struct timespec){.tv_nsec = 20000000}, NULL);
    assert_in_range(poll_frame(*state).received_us, before_us - 1, sent_us);
}

static void a_frame_is_handed_out_once_and_then_is_not_skipped(void **state)
{
    send_picture(*state, 1, 10);
    assert_int_equal(poll_frame(*state).utime, 1);
    assert_int_equal(poll_events(*state, 0), 0);
    send_picture(*state, 2, 10);
    assert_int_equal(poll_frame(*state).utime, 2);
    assert_int_equal(vdna_transport_count(*state)->received, 2);
    assert_int_equal(vdna_transport_count(*state)->skipped, 0);
}

static void a_malformed_frame_is_rejected_and_the_frame_before_it_kept(void **state)
{
    send_picture(*state, 1, 10);
    send_raw(*state, "CAMERA", "not an image", 12);
    send_raw(*state, "CAMERA", "", 0);
    assert_int_equal(poll_frame(*state).utime, 1);
    assert_int_equal(vdna_transport_count(*state)->received, 1);
    assert_int_equal(vdna_transport_count(*state)->skipped, 0);
    assert_int_equal(vdna_transport_count(*state)->rejected, 2);
}

static void of_rejected_camera_messages_the_newest_fingerprint_is_known(void **state)
{
    const vdna_transport_counters *counters = vdna_transport_count(*state);
    send_raw(*state, "CAMERA", "\1\2\3\4\5\6\7\10 and more", 17);
    assert_int_equal(poll_events(*state, 0), 0);
    assert_int_equal(counters->camera_rejected, 1);
    assert_true(counters->camera_fingerprint == 0x0102030405060708);

    send_raw(*state, "VDNA_COMMAND", "reset it", 8);
    assert_int_equal(poll_events(*state, 0), 0);
    assert_int_equal(counters->rejected, 2);
    assert_int_equal(counters->camera_rejected, 1);

    send_raw(*state, "CAMERA", "\1\2\3", 3);
    assert_int_equal(poll_events(*state, 0), 0);
    assert_true(counters->camera_fingerprint == 0);
}

static void a_picture_of_the_largest_size_is_taken_and_one_byte_more_is_oversized(void **state)
{
    send_picture(*state, 1, MAX_IMAGE_BYTES);
    send_picture(*state, 2, MAX_IMAGE_BYTES + 1);
    const vdna_transport_frame frame = poll_frame(*state);
    assert_int_equal(frame.utime, 1);
    assert_int_equal(frame.image.size, MAX_IMAGE_BYTES);
    assert_int_equal(frame.skipped, 1);
    assert_int_equal(vdna_transport_count(*state)->received, 2);
    assert_int_equal(vdna_transport_count(*state)->oversized, 1);
    assert_int_equal(vdna_transport_count(*state)->rejected, 0);
    assert_int_equal(vdna_transport_count(*state)->picture_bytes_max, MAX_IMAGE_BYTES + 1);
    assert_int_equal(vdna_transport_count(*state)->oversized_bytes, MAX_IMAGE_BYTES + 1);
}

static void oversized_frames_are_reported_with_the_next_frame(void **state)
{
    send_picture(*state, 1, MAX_IMAGE_BYTES + 1);
    assert_int_equal(poll_events(*state, 0), 0);
    send_picture(*state, 2, 10);
    assert_int_equal(poll_frame(*state).skipped, 1);
}

static void a_command_is_an_event_of_its_own(void **state)
{
    assert_int_equal(publish_command(*state, &sample_command), VDNA_OK);
    assert_int_equal(poll_events(*state, 0), VDNA_TRANSPORT_COMMAND);

    assert_int_equal(publish_command(*state, &sample_command), VDNA_OK);
    send_picture(*state, 1, 10);
    assert_int_equal(poll_events(*state, 0), VDNA_TRANSPORT_COMMAND | VDNA_TRANSPORT_FRAME);
    assert_int_equal(vdna_transport_count(*state)->commands, 2);
}

static void commands_are_handed_out_as_they_came_whatever_they_say(void **state)
{
    uint32_t count = 7;
    assert_null(vdna_transport_commands(NULL, &count));
    assert_int_equal(count, 7);
    char longest[VDNA_TRANSPORT_ARGUMENT_SIZE + 2];
    memset(longest, 'x', sizeof longest);
    char *const arguments[] = {"", "winter", longest, longest + 1, longest + 2};
    longest[sizeof longest - 1] = '\0';
    for (int i = 0; i < 5; i++) {
        vdna_msg_command_t command = {100 + i, 77 - i, arguments[i]};
        assert_int_equal(publish_command(*state, &command), VDNA_OK);
    }
    assert_int_equal(poll_events(*state, 0), VDNA_TRANSPORT_COMMAND);
    const vdna_transport_command *commands = vdna_transport_commands(*state, &count);
    assert_int_equal(count, 5);
    for (int i = 0; i < 5; i++) {
        assert_int_equal(commands[i].utime, 100 + i);
        assert_int_equal(commands[i].command, 77 - i);
        assert_int_equal(commands[i].argument_bytes, strlen(arguments[i]));
        assert_int_equal(
            strncmp(commands[i].argument, arguments[i], VDNA_TRANSPORT_ARGUMENT_SIZE - 1), 0);
    }
    assert_int_equal(strlen(commands[2].argument), VDNA_TRANSPORT_ARGUMENT_SIZE - 1);
    assert_int_equal(poll_events(*state, 0), 0);
    assert_non_null(vdna_transport_commands(*state, NULL));
    vdna_transport_commands(*state, &count);
    assert_int_equal(count, 0);
}

static void of_a_flood_of_commands_the_first_are_handed_out(void **state)
{
    const uint32_t most = VDNA_TRANSPORT_COMMANDS_MAX;
    uint32_t count = 0;
    for (uint32_t i = 0; i < most + 2; i++)
        assert_int_equal(publish_command(*state, &sample_command), VDNA_OK);
    assert_int_equal(poll_events(*state, 0), VDNA_TRANSPORT_COMMAND);
    vdna_transport_commands(*state, &count);
    assert_int_equal(count, most);
    assert_int_equal(vdna_transport_count(*state)->commands, most + 2);
    assert_int_equal(vdna_transport_count(*state)->commands_dropped, 2);
}

static void an_unknown_command_is_counted_and_handed_out(void **state)
{
    vdna_msg_command_t command = sample_command;
    command.command = 77;
    assert_int_equal(publish_command(*state, &command), VDNA_OK);
    assert_int_equal(poll_events(*state, 0), VDNA_TRANSPORT_COMMAND);
    assert_int_equal(vdna_transport_count(*state)->commands, 1);
}

static void a_malformed_command_is_rejected(void **state)
{
    send_raw(*state, "VDNA_COMMAND", "reset", 5);
    assert_int_equal(poll_events(*state, 0), 0);
    assert_int_equal(vdna_transport_count(*state)->commands, 0);
    assert_int_equal(vdna_transport_count(*state)->rejected, 1);
}

static void a_flood_is_taken_in_portions(void **state)
{
    for (int64_t utime = 1; utime <= 300; utime++)
        send_picture(*state, utime, 1);
    assert_int_equal(poll_frame(*state).utime, 256);
    assert_int_equal(poll_frame(*state).utime, 300);
    assert_int_equal(poll_events(*state, 0), 0);
    assert_int_equal(vdna_transport_count(*state)->skipped, 298);
}

static void an_idle_poll_waits_for_its_timeout(void **state)
{
    const int64_t begin_us = monotonic_us();
    assert_int_equal(poll_events(*state, 50), 0);
    assert_true(monotonic_us() - begin_us >= 50000);
}

static void on_alarm(int signal)
{
    (void)signal;
}

static void a_signal_ends_a_poll_without_an_error(void **state)
{
    struct sigaction action = {.sa_handler = on_alarm}, before;
    assert_int_equal(sigaction(SIGALRM, &action, &before), 0);
    // Repeated, in case one arrives before the poll.
    const struct itimerval every_20_ms = {{0, 20000}, {0, 20000}}, never = {{0, 0}, {0, 0}};
    assert_int_equal(setitimer(ITIMER_REAL, &every_20_ms, NULL), 0);
    const int64_t begin_us = monotonic_us();
    const uint32_t events = poll_events(*state, 1000);
    const int64_t waited_us = monotonic_us() - begin_us;
    setitimer(ITIMER_REAL, &never, NULL);
    sigaction(SIGALRM, &before, NULL);

    assert_int_equal(events, 0);
    assert_true(waited_us < 900000);
}

static void a_poll_refuses_bad_arguments(void **state)
{
    vdna_transport_frame frame;
    uint32_t events;
    assert_int_equal(vdna_transport_poll(NULL, 0, &events, &frame), VDNA_ERR_ARG);
    assert_int_equal(vdna_transport_poll(*state, -1, &events, &frame), VDNA_ERR_ARG);
    assert_int_equal(vdna_transport_poll(*state, 1001, &events, &frame), VDNA_ERR_ARG);
    assert_int_equal(vdna_transport_poll(*state, 0, NULL, &frame), VDNA_ERR_ARG);
    assert_int_equal(vdna_transport_poll(*state, 0, &events, NULL), VDNA_ERR_ARG);
}

// --- channels ---

static void a_channel_name_is_not_a_regular_expression(void **state)
{
    (void)state;
    vdna_transport_config config = memq_config();
    config.camera_channel = "CAM.front+1";
    vdna_transport *transport = open_with(&config);
    uint8_t bytes[256];
    const size_t size = (size_t)bot_core_image_t_encode(bytes, 0, sizeof bytes, &sample_image);

    send_raw(transport, "CAM.front+1", bytes, size);
    assert_int_equal(poll_frame(transport).utime, sample_image.utime);
    const char *others[] = {"CAM.front1", "CAMxfront1", "CAM.front+12", "xCAM.front+1", "CAMERA"};
    for (size_t i = 0; i < sizeof others / sizeof *others; i++)
        send_raw(transport, others[i], bytes, size);
    assert_int_equal(poll_events(transport, 0), 0);
    assert_int_equal(vdna_transport_count(transport)->received, 1);
    vdna_transport_close(transport);
}

static void every_character_may_be_in_a_channel_name(void **state)
{
    (void)state;
    vdna_transport_config config = memq_config();
    config.camera_channel = "^\\d.[a-z]{1,2}|(b)*?+$ #/&=~-_\xc3\xa9";
    vdna_transport *transport = open_with(&config);
    send_picture(transport, 5, 10);
    assert_int_equal(poll_frame(transport).utime, 5);
    vdna_transport_close(transport);
}

static void channel_names_have_1_to_63_bytes(void **state)
{
    (void)state;
    char name[65];
    memset(name, 'x', sizeof name);
    name[64] = 0;
    vdna_transport_config config = memq_config();
    vdna_transport *transport = NULL;
    vdna_error error = {""};

    config.command_channel = name;
    assert_int_equal(vdna_transport_open(&config, &error, &transport), VDNA_ERR_ARG);
    assert_non_null(strstr(error.text, "64 bytes"));
    config.command_channel = "";
    assert_int_equal(vdna_transport_open(&config, &error, &transport), VDNA_ERR_ARG);
    assert_null(transport);

    config.camera_channel = config.command_channel = name + 1;
    transport = open_with(&config);
    send_picture(transport, 5, 10);
    assert_int_equal(poll_frame(transport).utime, 5);
    vdna_transport_close(transport);
}

static void a_channel_that_is_null_is_neither_heard_nor_published_on(void **state)
{
    (void)state;
    vdna_transport_config config;
    vdna_transport_config_init(&config);
    config.url = "memq://";
    vdna_transport *t = open_with(&config);
    const vdna_image image = {sample_pixels, 6, 3, 2, 3, VDNA_PIXEL_GREY};
    assert_int_equal(vdna_transport_publish(t, NULL, &vdna_message_ranking, &sample_ranking),
                     VDNA_ERR_ARG);
    assert_int_equal(
        vdna_transport_publish(t, NULL, &vdna_message_localisation, &sample_localisation),
        VDNA_ERR_ARG);
    assert_int_equal(vdna_transport_publish(t, NULL, &vdna_message_status, &sample_status),
                     VDNA_ERR_ARG);
    assert_int_equal(vdna_transport_publish(t, NULL, &vdna_message_command, &sample_command),
                     VDNA_ERR_ARG);
    assert_int_equal(vdna_transport_publish_image(t, NULL, 1, &image), VDNA_ERR_ARG);
    send_raw(t, "CAMERA", "", 0);
    assert_int_equal(poll_events(t, 0), 0);
    assert_int_equal(vdna_transport_count(t)->rejected, 0);
    vdna_transport_close(t);
}

// --- other channels ---

static uint32_t overheard_count(const vdna_transport *transport)
{
    uint32_t count = UINT32_MAX;
    assert_non_null(vdna_transport_overheard_channels(transport, &count));
    return count;
}

static vdna_transport_overheard overheard(const vdna_transport *transport, const char *channel)
{
    uint32_t count = 0;
    const vdna_transport_overheard *all = vdna_transport_overheard_channels(transport, &count);
    for (uint32_t i = 0; i < count; i++)
        if (strcmp(all[i].channel, channel) == 0)
            return all[i];
    return (vdna_transport_overheard){.messages = 0};
}

static void send_sample_image(vdna_transport *transport, const char *channel)
{
    uint8_t bytes[256];
    const int size = bot_core_image_t_encode(bytes, 0, sizeof bytes, &sample_image);
    send_raw(transport, channel, bytes, (size_t)size);
}

static void other_channels_are_overheard_on_demand_only(void **state)
{
    send_raw(*state, "POSE", "12345678", 8);
    assert_int_equal(poll_events(*state, 0), 0);
    assert_int_equal(overheard_count(*state), 0);

    assert_int_equal(vdna_transport_overhear(*state, 1), VDNA_OK);
    assert_int_equal(vdna_transport_overhear(*state, 1), VDNA_OK); // changes nothing
    const int64_t before_us = monotonic_us();
    send_raw(*state, "POSE", "12345678", 8);
    send_raw(*state, "POSE", "87654321", 8);
    send_raw(*state, "SHORT", "1234567", 7);
    assert_int_equal(poll_events(*state, 0), 0);
    assert_int_equal(overheard_count(*state), 2);
    const vdna_transport_overheard pose = overheard(*state, "POSE");
    assert_int_equal(pose.messages, 2);
    assert_true(pose.fingerprint == 0x3837363534333231);
    assert_in_range(pose.first_us, before_us - 1, pose.last_us);
    assert_in_range(pose.last_us, pose.first_us, monotonic_us());
    assert_true(overheard(*state, "SHORT").fingerprint == 0);

    assert_int_equal(vdna_transport_overhear(*state, 0), VDNA_OK);
    assert_int_equal(vdna_transport_overhear(*state, 0), VDNA_OK);
    send_raw(*state, "POSE", "12345678", 8);
    assert_int_equal(poll_events(*state, 0), 0);
    assert_int_equal(overheard(*state, "POSE").messages, 2);

    assert_int_equal(vdna_transport_overhear(*state, 1), VDNA_OK);
    assert_int_equal(overheard_count(*state), 0);
}

static void our_own_channels_are_received_as_ever_and_not_overheard(void **state)
{
    assert_int_equal(vdna_transport_overhear(*state, 1), VDNA_OK);
    send_picture(*state, 1, 10);
    assert_int_equal(publish_command(*state, &sample_command), VDNA_OK);
    for (int i = 0; i < 3; i++) // as many as LCM queues for us
        send_raw(*state, "POSE", "12345678", 8);
    assert_int_equal(poll_events(*state, 0), VDNA_TRANSPORT_FRAME | VDNA_TRANSPORT_COMMAND);
    assert_int_equal(vdna_transport_count(*state)->received, 1);
    assert_int_equal(vdna_transport_count(*state)->backlog_max, 2);
    assert_int_equal(overheard_count(*state), 1);
}

static void of_many_channels_those_with_pictures_are_kept(void **state)
{
    assert_int_equal(vdna_transport_overhear(*state, 1), VDNA_OK);
    char name[] = "CHANNEL_x";
    for (char letter = 'A'; letter <= 'Z'; letter++) {
        name[sizeof name - 2] = letter;
        send_raw(*state, name, "\xff\0\n", 3);
        assert_int_equal(poll_events(*state, 0), 0);
    }
    assert_int_equal(overheard_count(*state), VDNA_TRANSPORT_OVERHEARD_MAX);
    assert_int_equal(overheard(*state, "CHANNEL_Z").messages, 0);

    for (char letter = 'a'; letter <= 'z'; letter++) {
        name[sizeof name - 2] = letter;
        send_sample_image(*state, name);
        assert_int_equal(poll_events(*state, 0), 0);
    }
    assert_int_equal(overheard_count(*state), VDNA_TRANSPORT_OVERHEARD_MAX);
    const vdna_transport_overheard picture = overheard(*state, "CHANNEL_a");
    assert_int_equal(picture.messages, 1);
    assert_true(picture.fingerprint == vdna_message_image.fingerprint);
    assert_int_equal(overheard(*state, "CHANNEL_A").messages, 0);
    assert_int_equal(overheard(*state, "CHANNEL_z").messages, 0);
}

// --- other daemons ---

static void send_status(vdna_transport *transport, int64_t instance, int64_t serving_utime,
                        char *host)
{
    vdna_msg_status_t status = sample_status;
    status.instance = instance;
    status.serving_utime = serving_utime;
    status.host = host;
    uint8_t bytes[1024];
    const int size = vdna_msg_status_t_encode(bytes, 0, sizeof bytes, &status);
    send_raw(transport, "PEERS", bytes, (size_t)size);
    assert_int_equal(poll_events(transport, 0), 0);
}

static vdna_transport *open_for_peers(void)
{
    vdna_transport_config config = memq_config();
    config.peer_channel = "PEERS";
    return open_with(&config);
}

static void other_daemons_are_known_by_their_newest_status(void **state)
{
    (void)state;
    vdna_transport *transport = open_for_peers();
    uint32_t count = 7;
    assert_non_null(vdna_transport_peers(transport, &count));
    assert_int_equal(count, 0);
    send_status(transport, 5, 100, "robot");
    send_status(transport, -6, 200, "tab\there");
    send_status(transport, 5, 0, "robot");
    const vdna_transport_peer *peers = vdna_transport_peers(transport, &count);
    assert_int_equal(count, 2);
    assert_int_equal(peers[0].instance, 5);
    assert_int_equal(peers[0].serving_utime, 0);
    assert_true(peers[0].received_us >= peers[1].received_us && peers[1].received_us > 0);
    assert_int_equal(peers[1].instance, -6);
    assert_int_equal(peers[1].serving_utime, 200);
    assert_string_equal(peers[1].host, "tab?here");
    assert_int_equal(vdna_transport_count(transport)->backlog_max, 0);
    vdna_transport_close(transport);
}

static void a_long_name_of_a_machine_is_cut_and_a_broken_status_rejected(void **state)
{
    (void)state;
    vdna_transport *transport = open_for_peers();
    char host[200] = "";
    memset(host, 'h', sizeof host - 1);
    send_status(transport, 5, 100, host);
    uint32_t count = 0;
    const vdna_transport_peer *peers = vdna_transport_peers(transport, &count);
    assert_int_equal(strlen(peers[0].host), VDNA_TRANSPORT_HOST_SIZE - 1);
    send_raw(transport, "PEERS", "12345678", 8);
    assert_int_equal(poll_events(transport, 0), 0);
    assert_int_equal(vdna_transport_count(transport)->rejected, 1);
    assert_non_null(vdna_transport_peers(transport, &count));
    assert_int_equal(count, 1);
    vdna_transport_close(transport);
}

static void of_too_many_daemons_the_one_silent_for_longest_goes(void **state)
{
    (void)state;
    vdna_transport *transport = open_for_peers();
    const struct timespec moment = {0, 1000000};
    for (int instance = 0; instance <= (int)VDNA_TRANSPORT_PEERS_MAX; instance++) {
        send_status(transport, instance, 1, "robot");
        nanosleep(&moment, NULL);
    }
    uint32_t count = 0;
    const vdna_transport_peer *peers = vdna_transport_peers(transport, &count);
    assert_int_equal(count, VDNA_TRANSPORT_PEERS_MAX);
    assert_int_equal(peers[0].instance, VDNA_TRANSPORT_PEERS_MAX);
    assert_int_equal(peers[1].instance, 1);
    assert_null(vdna_transport_peers(NULL, &count));
    assert_null(vdna_transport_peers(transport, NULL));
    vdna_transport_close(transport);
}

static void overhearing_refuses_bad_arguments(void **state)
{
    uint32_t count = 7;
    vdna_transport_config deaf = memq_config();
    deaf.camera_channel = deaf.command_channel = NULL;
    vdna_transport *transport = open_with(&deaf);
    assert_int_equal(vdna_transport_overhear(transport, 1), VDNA_ERR_ARG);
    vdna_transport_close(transport);
    assert_int_equal(vdna_transport_overhear(NULL, 1), VDNA_ERR_ARG);
    assert_int_equal(vdna_transport_overhear(*state, 2), VDNA_ERR_ARG);
    assert_null(vdna_transport_overheard_channels(NULL, &count));
    assert_null(vdna_transport_overheard_channels(*state, NULL));
    assert_int_equal(count, 7);
}

// --- out ---

// Bytes received on a channel, to inspect published messages.
typedef struct received {
    uint8_t bytes[1024];
    uint32_t size;
} received;

static void keep_bytes(const lcm_recv_buf_t *message, const char *channel, void *context)
{
    (void)channel;
    received *kept = context;
    assert_in_range(message->data_size, 1, sizeof kept->bytes);
    memcpy(kept->bytes, message->data, message->data_size);
    kept->size = message->data_size;
}

// The bytes of a message on its channel; they pass the check of its type.
static received published(vdna_transport *transport, const char *channel,
                          const vdna_message_type *type, const void *message)
{
    received kept = {.size = 0};
    lcm_subscription_t *const subscription =
        lcm_subscribe(transport->network.lcm, channel, keep_bytes, &kept);
    assert_int_equal(vdna_transport_publish(transport, channel, type, message), VDNA_OK);
    assert_int_equal(poll_events(transport, 0), 0);
    assert_int_equal(lcm_unsubscribe(transport->network.lcm, subscription), 0);
    assert_int_equal(vdna_transport_check(type, kept.bytes, kept.size), VDNA_OK);
    return kept;
}

static void a_published_ranking_passes_the_check_and_decodes_to_itself(void **state)
{
    const received kept = published(*state, "VDNA_RANKING", &vdna_message_ranking, &sample_ranking);

    vdna_msg_ranking_t ranking;
    assert_int_equal(vdna_msg_ranking_t_decode(kept.bytes, 0, (int)kept.size, &ranking), kept.size);
    assert_int_equal(ranking.utime, sample_ranking.utime);
    assert_int_equal(ranking.window_begin_utime, sample_ranking.window_begin_utime);
    assert_int_equal(ranking.window_frames, 42);
    assert_int_equal(ranking.validity, VDNA_MSG_RANKING_T_VALID);
    assert_string_equal(ranking.backbone, "lite0");
    assert_string_equal(ranking.comparable, "ab12");
    assert_true(ranking.margin_bins == 1.75);
    assert_int_equal(ranking.count, 2);
    assert_string_equal(ranking.experience[0], "autumn");
    assert_string_equal(ranking.experience[1], "snow");
    assert_memory_equal(ranking.distance_bins, sample_distances, sizeof sample_distances);
    assert_memory_equal(ranking.tied, sample_tied, sizeof sample_tied);
    assert_memory_equal(ranking.bound, sample_bound, sizeof sample_bound);
    assert_memory_equal(ranking.predicted_recall, sample_recalls, sizeof sample_recalls);
    assert_string_equal(ranking.ranked_by, "transfer");
    assert_string_equal(ranking.verdict, "poor");
    assert_true(ranking.unlike == 0.0625 && ranking.skill == 0.5);
    assert_int_equal(ranking.settled_frames, 12);
    assert_string_equal(ranking.previous, "snow");
    assert_memory_equal(ranking.predicted_low, sample_lows, sizeof sample_lows);
    assert_memory_equal(ranking.predicted_high, sample_highs, sizeof sample_highs);
    assert_memory_equal(ranking.transfer, sample_transfers, sizeof sample_transfers);
    vdna_msg_ranking_t_decode_cleanup(&ranking);
}

static void a_published_localisation_passes_the_check_and_decodes_to_itself(void **state)
{
    const received kept =
        published(*state, "VDNA_LOCALISATION", &vdna_message_localisation, &sample_localisation);

    vdna_msg_localisation_t answer;
    assert_int_equal(vdna_msg_localisation_t_decode(kept.bytes, 0, (int)kept.size, &answer),
                     kept.size);
    assert_int_equal(answer.utime, sample_localisation.utime);
    assert_int_equal(answer.validity, VDNA_MSG_LOCALISATION_T_VALID);
    assert_string_equal(answer.experience, "snow");
    assert_int_equal(answer.frame, 7);
    assert_int_equal(answer.frame_utime, -1);
    assert_int_equal(answer.has_place, 1);
    assert_int_equal(answer.place, 99);
    assert_int_equal(answer.has_position, 1);
    assert_string_equal(answer.position_frame, "local");
    assert_memory_equal(answer.position, sample_localisation.position, sizeof answer.position);
    assert_true(answer.distance == 0.125);
    assert_true(answer.predicted_recall == 0.5);
    assert_true(answer.predicted_low == 0.25 && answer.predicted_high == 0.75);
    assert_int_equal(answer.basis, VDNA_MSG_LOCALISATION_T_PARKED);
    assert_int_equal(answer.latency_us, 20000);
    assert_int_equal(answer.skipped, 3);
    vdna_msg_localisation_t_decode_cleanup(&answer);
}

static void a_published_status_passes_the_check_and_decodes_to_itself(void **state)
{
    const received kept = published(*state, "VDNA_STATUS", &vdna_message_status, &sample_status);

    vdna_msg_status_t status;
    assert_int_equal(vdna_msg_status_t_decode(kept.bytes, 0, (int)kept.size, &status), kept.size);
    assert_int_equal(status.utime, sample_status.utime);
    assert_int_equal(status.state, VDNA_MSG_STATUS_T_VALID);
    assert_int_equal(status.instance, -77);
    assert_int_equal(status.serving_utime, 1700000000000001);
    assert_string_equal(status.host, "robot");
    assert_int_equal(status.left_out, 1);
    assert_int_equal(status.map_changed, 1);
    assert_int_equal(status.switches, 6);
    assert_true(status.progress == 1);
    assert_string_equal(status.experience, "snow");
    assert_int_equal(status.experiences, 2);
    assert_string_equal(status.backbone, "lite0");
    assert_string_equal(status.version, "0.1.0");
    assert_int_equal(status.received, 100);
    assert_int_equal(status.parked, 12);
    assert_int_equal(status.carried, 6);
    assert_int_equal(status.over_rate, 4);
    assert_int_equal(status.oversized, 1);
    assert_int_equal(status.late, 5);
    assert_memory_equal(&status.inference_time, &sample_status.inference_time,
                        sizeof status.inference_time);
    assert_memory_equal(&status.total_time, &sample_status.total_time, sizeof status.total_time);
    assert_int_equal(status.resident_bytes, 50000000);
    assert_int_equal(status.backlog_max, 5);
    assert_string_equal(status.message, "");
    vdna_msg_status_t_decode_cleanup(&status);
}

static void messages_with_missing_parts_are_not_published(void **state)
{
    vdna_msg_ranking_t ranking = sample_ranking;
    ranking.count = -1;
    assert_int_equal(publish_ranking(*state, &ranking), VDNA_ERR_ARG);
    ranking.count = 2;
    ranking.tied = NULL;
    assert_int_equal(publish_ranking(*state, &ranking), VDNA_ERR_ARG);
    ranking.tied = sample_tied;
    char *nameless[] = {"autumn", NULL};
    ranking.experience = nameless;
    assert_int_equal(publish_ranking(*state, &ranking), VDNA_ERR_ARG);

    vdna_msg_localisation_t localisation = sample_localisation;
    localisation.experience = NULL;
    assert_int_equal(publish_localisation(*state, &localisation), VDNA_ERR_ARG);
    vdna_msg_status_t status = sample_status;
    status.message = NULL;
    assert_int_equal(publish_status(*state, &status), VDNA_ERR_ARG);
    vdna_msg_command_t command = sample_command;
    command.argument = NULL;
    assert_int_equal(publish_command(*state, &command), VDNA_ERR_ARG);
}

static void pictures_that_do_not_fit_the_message_are_not_published(void **state)
{
    const vdna_image good = {sample_pixels, 6, 3, 2, 3, VDNA_PIXEL_GREY};
    vdna_image image = good;
    image.pixelformat = VDNA_PIXEL_ENCODED;
    assert_int_equal(vdna_transport_publish_image(*state, "CAMERA", 1, &image), VDNA_ERR_ARG);
    image = good;
    image.width = 1u << 31;
    assert_int_equal(vdna_transport_publish_image(*state, "CAMERA", 1, &image), VDNA_ERR_ARG);
    image = good;
    image.size = LCM_MAX_MESSAGE_SIZE;
    assert_int_equal(vdna_transport_publish_image(*state, "CAMERA", 1, &image), VDNA_ERR_ARG);
    image = good;
    image.data = NULL;
    assert_int_equal(vdna_transport_publish_image(*state, "CAMERA", 1, &image), VDNA_ERR_ARG);
}

// --- opening ---

static void the_defaults_are_lcm_s_own_network_and_8_mib(void **state)
{
    (void)state;
    vdna_transport_config config;
    memset(&config, 0xff, sizeof config);
    vdna_transport_config_init(&config);
    assert_int_equal(config.struct_size, sizeof config);
    assert_int_equal(config.max_image_bytes, 8 * 1024 * 1024);
    assert_null(config.url);
    assert_null(config.camera_channel);
    assert_null(config.command_channel);
}

static void without_a_url_the_environment_decides(void **state)
{
    (void)state;
    vdna_transport_config config = memq_config();
    config.url = NULL;
    setenv("LCM_DEFAULT_URL", "memq://", 1);
    vdna_transport *transport = open_with(&config);
    unsetenv("LCM_DEFAULT_URL");
    send_picture(transport, 1, 10);
    assert_int_equal(poll_frame(transport).utime, 1);
    vdna_transport_close(transport);
}

static void a_bad_url_is_named_with_an_example_of_a_good_one(void **state)
{
    (void)state;
    const char *bad[] = {"carrier-pigeon://loft", "/var/log/my.log", "file:///no/such/folder/a.log",
                         "udpm://300.300.300.300:7667"};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        vdna_transport_config config = memq_config();
        config.url = bad[i];
        vdna_transport *transport = NULL;
        vdna_error error = {""};
        assert_int_equal(vdna_transport_open(&config, &error, &transport), VDNA_ERR_IO);
        assert_null(transport);
        assert_non_null(strstr(error.text, bad[i]));
        assert_non_null(strstr(error.text, "udpm://239.255.76.67:7667?ttl=0"));
    }
}

static void a_bad_configuration_is_refused(void **state)
{
    (void)state;
    vdna_transport *transport = NULL;
    assert_int_equal(vdna_transport_open(NULL, NULL, &transport), VDNA_ERR_ARG);
    vdna_transport_config config = memq_config();
    assert_int_equal(vdna_transport_open(&config, NULL, NULL), VDNA_ERR_ARG);
    config.max_image_bytes = 0;
    assert_int_equal(vdna_transport_open(&config, NULL, &transport), VDNA_ERR_ARG);
    config.max_image_bytes = LCM_MAX_MESSAGE_SIZE + 1;
    assert_int_equal(vdna_transport_open(&config, NULL, &transport), VDNA_ERR_ARG);
    config = memq_config();
    config.max_message_bytes = LCM_MAX_MESSAGE_SIZE + 1;
    assert_int_equal(vdna_transport_open(&config, NULL, &transport), VDNA_ERR_ARG);
    config = memq_config();
    config.struct_size++;
    assert_int_equal(vdna_transport_open(&config, NULL, &transport), VDNA_ERR_ARG);
    config = memq_config();
    config.struct_size = offsetof(vdna_transport_config, sources) - 1;
    assert_int_equal(vdna_transport_open(&config, NULL, &transport), VDNA_ERR_ARG);
    assert_null(transport);

    vdna_transport_memory memory;
    assert_int_equal(vdna_transport_memory_of(&config, &memory), VDNA_ERR_ARG);
}

static void the_memory_that_is_stated_follows_the_configuration(void **state)
{
    (void)state;
    vdna_transport_config config = memq_config();
    vdna_transport_memory small, large;
    assert_int_equal(vdna_transport_memory_of(&config, &small), VDNA_OK);
    assert_int_equal(small.own_bytes, sizeof(vdna_transport) + MAX_IMAGE_BYTES);

    config.max_image_bytes = 1000000;
    assert_int_equal(vdna_transport_memory_of(&config, &small), VDNA_OK);
    config.max_image_bytes += 1000;
    config.max_message_bytes = 500;
    assert_int_equal(vdna_transport_memory_of(&config, &large), VDNA_OK);
    assert_int_equal(large.own_bytes, small.own_bytes + 1000 + 500);
    assert_int_equal(large.lcm_bytes, small.lcm_bytes + (VDNA_REASSEMBLY_SLOTS - 1) * 1000);

    config.camera_channel = NULL;
    assert_int_equal(vdna_transport_memory_of(&config, &large), VDNA_OK);
    assert_int_equal(large.own_bytes, sizeof(vdna_transport) + 500);
    assert_true(large.lcm_bytes < small.lcm_bytes);
}

static void with_pictures_of_2_mib_lcm_takes_less_than_8_mib(void **state)
{
    (void)state;
    vdna_transport_config config = memq_config();
    config.max_image_bytes = 2 << 20; // the daemon's default
    vdna_transport_memory memory;
    assert_int_equal(vdna_transport_memory_of(&config, &memory), VDNA_OK);
    print_message("%llu bytes\n", (unsigned long long)memory.lcm_bytes);
    assert_true(memory.lcm_bytes <= 8 << 20);
}

static void sources_are_addresses_and_not_too_many(void **state)
{
    (void)state;
    const char *bad[] = {"robot", "10.0.0", "10.0.0.2:7667", "::1", "", "10.0.0.256", NULL};
    vdna_transport_config config = memq_config();
    vdna_transport *transport = NULL;
    vdna_error error;
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        const char *sources[] = {"10.0.0.1", bad[i]};
        config.sources = sources;
        config.source_count = 2;
        assert_int_equal(vdna_transport_open(&config, &error, &transport), VDNA_ERR_ARG);
        assert_non_null(strstr(error.text, bad[i] ? bad[i] : "NULL"));
        assert_non_null(strstr(error.text, "10.0.0.2"));
    }
    config.sources = NULL;
    config.source_count = 1;
    assert_int_equal(vdna_transport_open(&config, &error, &transport), VDNA_ERR_ARG);
    config.sources = bad;
    config.source_count = VDNA_TRANSPORT_SOURCES_MAX + 1;
    assert_int_equal(vdna_transport_open(&config, &error, &transport), VDNA_ERR_ARG);
    assert_non_null(strstr(error.text, "17"));
    assert_null(transport);
}

static void an_old_caller_gets_the_defaults_of_what_he_lacks(void **state)
{
    (void)state;
    vdna_transport_config config;
    memset(&config, 0xff, sizeof config);
    (vdna_transport_config_init)(&config);
    assert_int_equal(config.struct_size, offsetof(vdna_transport_config, sources));
    assert_true(config.source_count == UINT64_MAX); // not written
    config.url = "memq://";
    config.camera_channel = "CAMERA";
    vdna_transport_close(open_with(&config));
}

static void the_room_for_messages_is_there_from_the_start(void **state)
{
    (void)state;
    vdna_transport_config config = memq_config();
    config.max_message_bytes = 1000;
    vdna_transport *transport = open_with(&config);
    const uint8_t *message = transport->message;
    assert_int_equal(transport->message_size, 1000);
    assert_int_equal(publish_ranking(transport, &sample_ranking), VDNA_OK);
    assert_ptr_equal(transport->message, message);
    vdna_transport_close(transport);
}

// --- logs ---

static void a_channel_has_1_to_63_bytes(void **state)
{
    (void)state;
    char name[VDNA_CHANNEL_BYTES_MAX + 2];
    vdna_error error = {""};
    memset(name, 'C', sizeof name);
    name[VDNA_CHANNEL_BYTES_MAX + 1] = '\0';
    assert_int_equal(vdna_transport_check_channel(name, &error), VDNA_ERR_ARG);
    assert_true(strstr(error.text, name) != NULL);
    assert_int_equal(vdna_transport_check_channel(name + 1, NULL), VDNA_OK);
    assert_int_equal(vdna_transport_check_channel("C", NULL), VDNA_OK);
    assert_int_equal(vdna_transport_check_channel("", NULL), VDNA_ERR_ARG);
    assert_int_equal(vdna_transport_check_channel(NULL, NULL), VDNA_ERR_ARG);
}

static void a_url_names_a_log_if_it_is_to_be_read(void **state)
{
    (void)state;
    const char *logs[] = {"file:///a.log", "file://a.log?speed=0", "file://a?mode=r&speed=2",
                          "file:///mode=w/a.log"};
    for (size_t i = 0; i < sizeof logs / sizeof *logs; i++)
        assert_int_equal(vdna_transport_is_log(logs[i]), 1);
    const char *others[] = {"udpm://239.255.76.67:7667?ttl=0", "memq://", "/a.log",
                            "file://a.log?mode=w", "file://a.log?speed=1&mode=a"};
    for (size_t i = 0; i < sizeof others / sizeof *others; i++)
        assert_int_equal(vdna_transport_is_log(others[i]), 0);
    setenv("LCM_DEFAULT_URL", "file://a.log", 1);
    assert_int_equal(vdna_transport_is_log(NULL), 1);
    assert_int_equal(vdna_transport_is_log(""), 1);
    unsetenv("LCM_DEFAULT_URL");
    assert_int_equal(vdna_transport_is_log(NULL), 0);
}

static void a_log_hands_out_every_frame_and_then_ends(void **state)
{
    (void)state;
    char path[] = "/tmp/vdna_test_transport_XXXXXX";
    const int descriptor = mkstemp(path);
    assert_true(descriptor >= 0);
    close(descriptor);
    char url[64];

    vdna_transport_config config = memq_config();
    config.url = url;
    snprintf(url, sizeof url, "file://%s?mode=w", path);
    vdna_transport *writer = open_with(&config);
    send_raw(writer, "POSE", "not for us", 10);
    send_picture(writer, 1, 10);
    send_picture(writer, 2, 10);
    assert_int_equal(publish_command(writer, &sample_command), VDNA_OK);
    send_picture(writer, 3, 10);
    vdna_transport_close(writer);

    snprintf(url, sizeof url, "file://%s?speed=0", path);
    vdna_transport *reader = open_with(&config);
    assert_int_equal(poll_frame(reader).utime, 1);
    assert_int_equal(poll_frame(reader).utime, 2);
    assert_int_equal(poll_events(reader, 0), VDNA_TRANSPORT_COMMAND);
    assert_int_equal(poll_frame(reader).utime, 3);
    assert_int_equal(vdna_transport_count(reader)->skipped, 0);
    assert_int_equal(publish_ranking(reader, &sample_ranking), VDNA_ERR_IO);
    for (int again = 0; again < 2; again++) {
        vdna_transport_frame frame;
        uint32_t events;
        assert_int_equal(vdna_transport_poll(reader, 100, &events, &frame), VDNA_ERR_IO);
    }
    vdna_transport_close(reader);
    unlink(path);
}

#define ON_MEMQ(test) cmocka_unit_test_setup_teardown(test, open_on_memq, close_transport)

int main(void)
{
    const struct CMUnitTest tests[] = {
        ON_MEMQ(a_frame_comes_with_all_its_fields),
        ON_MEMQ(a_frame_of_another_camera_driver_comes_without_its_metadata),
        ON_MEMQ(of_several_frames_the_newest_is_kept_and_the_others_are_skipped),
        ON_MEMQ(a_frame_is_handed_out_once_and_then_is_not_skipped),
        ON_MEMQ(a_malformed_frame_is_rejected_and_the_frame_before_it_kept),
        ON_MEMQ(of_rejected_camera_messages_the_newest_fingerprint_is_known),
        ON_MEMQ(a_picture_of_the_largest_size_is_taken_and_one_byte_more_is_oversized),
        ON_MEMQ(oversized_frames_are_reported_with_the_next_frame),
        ON_MEMQ(the_time_in_the_queue_of_lcm_is_part_of_a_frames_age),
        ON_MEMQ(a_command_is_an_event_of_its_own),
        ON_MEMQ(commands_are_handed_out_as_they_came_whatever_they_say),
        ON_MEMQ(of_a_flood_of_commands_the_first_are_handed_out),
        ON_MEMQ(an_unknown_command_is_counted_and_handed_out),
        ON_MEMQ(a_malformed_command_is_rejected),
        ON_MEMQ(a_flood_is_taken_in_portions),
        ON_MEMQ(an_idle_poll_waits_for_its_timeout),
        ON_MEMQ(a_signal_ends_a_poll_without_an_error),
        ON_MEMQ(a_poll_refuses_bad_arguments),
        cmocka_unit_test(a_channel_name_is_not_a_regular_expression),
        cmocka_unit_test(every_character_may_be_in_a_channel_name),
        cmocka_unit_test(channel_names_have_1_to_63_bytes),
        cmocka_unit_test(a_channel_that_is_null_is_neither_heard_nor_published_on),
        ON_MEMQ(other_channels_are_overheard_on_demand_only),
        ON_MEMQ(our_own_channels_are_received_as_ever_and_not_overheard),
        ON_MEMQ(of_many_channels_those_with_pictures_are_kept),
        ON_MEMQ(overhearing_refuses_bad_arguments),
        cmocka_unit_test(other_daemons_are_known_by_their_newest_status),
        cmocka_unit_test(a_long_name_of_a_machine_is_cut_and_a_broken_status_rejected),
        cmocka_unit_test(of_too_many_daemons_the_one_silent_for_longest_goes),
        ON_MEMQ(a_published_ranking_passes_the_check_and_decodes_to_itself),
        ON_MEMQ(a_published_localisation_passes_the_check_and_decodes_to_itself),
        ON_MEMQ(a_published_status_passes_the_check_and_decodes_to_itself),
        ON_MEMQ(messages_with_missing_parts_are_not_published),
        ON_MEMQ(pictures_that_do_not_fit_the_message_are_not_published),
        cmocka_unit_test(the_defaults_are_lcm_s_own_network_and_8_mib),
        cmocka_unit_test(without_a_url_the_environment_decides),
        cmocka_unit_test(a_bad_url_is_named_with_an_example_of_a_good_one),
        cmocka_unit_test(a_bad_configuration_is_refused),
        cmocka_unit_test(the_memory_that_is_stated_follows_the_configuration),
        cmocka_unit_test(with_pictures_of_2_mib_lcm_takes_less_than_8_mib),
        cmocka_unit_test(sources_are_addresses_and_not_too_many),
        cmocka_unit_test(an_old_caller_gets_the_defaults_of_what_he_lacks),
        cmocka_unit_test(the_room_for_messages_is_there_from_the_start),
        cmocka_unit_test(a_channel_has_1_to_63_bytes),
        cmocka_unit_test(a_url_names_a_log_if_it_is_to_be_read),
        cmocka_unit_test(a_log_hands_out_every_frame_and_then_ends),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
