/* Prints where the C compiler lays each field of the public structs: NAME.FIELD OFFSET SIZE. The
 * Python package writes them down a second time, and its tests compare. */
#include <stddef.h>
#include <stdio.h>

#include <vdna/backbone.h>
#include <vdna/map.h>
#include <vdna/map_trust.h>
#include <vdna/vdna.h>

#define STRUCT(type) printf(#type ". 0 %zu\n", sizeof(type))
#define FIELD(type, name) \
    printf(#type "." #name " %zu %zu\n", offsetof(type, name), sizeof(((type *)0)->name))

static void print_core(void)
{
    STRUCT(vdna_error);
    FIELD(vdna_error, text);

    STRUCT(vdna_activations);
    FIELD(vdna_activations, values);
    FIELD(vdna_activations, neurons);
    FIELD(vdna_activations, samples);
    FIELD(vdna_activations, layout);

    STRUCT(vdna_hist_config);
    FIELD(vdna_hist_config, struct_size);
    FIELD(vdna_hist_config, neurons);
    FIELD(vdna_hist_config, bins);
    FIELD(vdna_hist_config, range);

    STRUCT(vdna_hist);
    FIELD(vdna_hist, range);
    FIELD(vdna_hist, counts);
    FIELD(vdna_hist, mass);
    FIELD(vdna_hist, saturated);
    FIELD(vdna_hist, neurons);
    FIELD(vdna_hist, bins);
    FIELD(vdna_hist, frames);

    STRUCT(vdna_hist_view);
    FIELD(vdna_hist_view, range);
    FIELD(vdna_hist_view, counts);
    FIELD(vdna_hist_view, mass);
    FIELD(vdna_hist_view, neurons);
    FIELD(vdna_hist_view, bins);

    STRUCT(vdna_rank_entry);
    FIELD(vdna_rank_entry, distance_bins);
    FIELD(vdna_rank_entry, candidate);
    FIELD(vdna_rank_entry, tied);

    STRUCT(vdna_knn_match);
    FIELD(vdna_knn_match, distance_sq);
    FIELD(vdna_knn_match, index);
    FIELD(vdna_knn_match, reserved);
}

static void print_localise(void)
{
    STRUCT(vdna_localise_map_config);
    FIELD(vdna_localise_map_config, struct_size);
    FIELD(vdna_localise_map_config, frames);
    FIELD(vdna_localise_map_config, dim);
    FIELD(vdna_localise_map_config, centred);
    FIELD(vdna_localise_map_config, embeddings);

    STRUCT(vdna_gear);
    FIELD(vdna_gear, first);
    FIELD(vdna_gear, reserved);
    FIELD(vdna_gear, share);

    STRUCT(vdna_localise_config);
    FIELD(vdna_localise_config, struct_size);
    FIELD(vdna_localise_config, tolerance);
    FIELD(vdna_localise_config, map);
    FIELD(vdna_localise_config, place);
    FIELD(vdna_localise_config, gears);
    FIELD(vdna_localise_config, gear_count);
    FIELD(vdna_localise_config, mean_frames);
    FIELD(vdna_localise_config, mean_frames_max);
    FIELD(vdna_localise_config, reserved);
    FIELD(vdna_localise_config, gate);
    FIELD(vdna_localise_config, sharpness);
    FIELD(vdna_localise_config, clutter);
    FIELD(vdna_localise_config, jump);
    FIELD(vdna_localise_config, gear_change);
    FIELD(vdna_localise_config, evidence_share);
    FIELD(vdna_localise_config, confidence);

    STRUCT(vdna_localise_answer);
    FIELD(vdna_localise_answer, frame);
    FIELD(vdna_localise_answer, nearest);
    FIELD(vdna_localise_answer, moving);
    FIELD(vdna_localise_answer, reserved);
    FIELD(vdna_localise_answer, confidence);
    FIELD(vdna_localise_answer, mass);
    FIELD(vdna_localise_answer, nearest_distance);
}

static void print_trust(void)
{
    STRUCT(vdna_trust_run);
    FIELD(vdna_trust_run, embeddings);
    FIELD(vdna_trust_run, last_layer);
    FIELD(vdna_trust_run, last_layer_scale);
    FIELD(vdna_trust_run, place);
    FIELD(vdna_trust_run, position);
    FIELD(vdna_trust_run, codes);
    FIELD(vdna_trust_run, frames);
    FIELD(vdna_trust_run, dim);
    FIELD(vdna_trust_run, last_layer_dim);
    FIELD(vdna_trust_run, reserved);

    STRUCT(vdna_trust_cell);
    FIELD(vdna_trust_cell, nearest);
    FIELD(vdna_trust_cell, likeness);
    FIELD(vdna_trust_cell, recall);
    FIELD(vdna_trust_cell, distance);

    STRUCT(vdna_trust_tables);
    FIELD(vdna_trust_tables, frames);
    FIELD(vdna_trust_tables, own_scale);
    FIELD(vdna_trust_tables, correlation);
    FIELD(vdna_trust_tables, cells);

    STRUCT(vdna_trust_config);
    FIELD(vdna_trust_config, struct_size);
    FIELD(vdna_trust_config, runs);
    FIELD(vdna_trust_config, tables);
    FIELD(vdna_trust_config, localiser);
    FIELD(vdna_trust_config, reserved);
    FIELD(vdna_trust_config, min_recall);
    FIELD(vdna_trust_config, switch_cost);

    STRUCT(vdna_trust_prediction);
    FIELD(vdna_trust_prediction, recall);
    FIELD(vdna_trust_prediction, low);
    FIELD(vdna_trust_prediction, high);
    FIELD(vdna_trust_prediction, transfer);
    FIELD(vdna_trust_prediction, nearest);
    FIELD(vdna_trust_prediction, score);
    FIELD(vdna_trust_prediction, reason);
    FIELD(vdna_trust_prediction, reserved);

    STRUCT(vdna_trust_answer);
    FIELD(vdna_trust_answer, verdict);
    FIELD(vdna_trust_answer, frames);
    FIELD(vdna_trust_answer, choice);
    FIELD(vdna_trust_answer, settled_frames);
    FIELD(vdna_trust_answer, unlike);

    STRUCT(vdna_trust_fit);
    FIELD(vdna_trust_fit, labelled);
    FIELD(vdna_trust_fit, by_likeness);
    FIELD(vdna_trust_fit, skill);
    FIELD(vdna_trust_fit, slope);
    FIELD(vdna_trust_fit, sd);
    FIELD(vdna_trust_fit, sd_best);
    FIELD(vdna_trust_fit, quantile);
    FIELD(vdna_trust_fit, far);
    FIELD(vdna_trust_fit, correlation);
}

static void print_select(void)
{
    STRUCT(vdna_select_candidate);
    FIELD(vdna_select_candidate, dna);
    FIELD(vdna_select_candidate, embeddings);
    FIELD(vdna_select_candidate, frames);
    FIELD(vdna_select_candidate, reserved);

    STRUCT(vdna_select_config);
    FIELD(vdna_select_config, struct_size);
    FIELD(vdna_select_config, candidate_count);
    FIELD(vdna_select_config, candidates);
    FIELD(vdna_select_config, dim);
    FIELD(vdna_select_config, warmup_frames);
    FIELD(vdna_select_config, warmup_us);
    FIELD(vdna_select_config, late_us);
    FIELD(vdna_select_config, warmup_frames_min);
    FIELD(vdna_select_config, time_unit);
    FIELD(vdna_select_config, localisers);
    FIELD(vdna_select_config, top);
    FIELD(vdna_select_config, rank);
    FIELD(vdna_select_config, trust);
    FIELD(vdna_select_config, runs);
    FIELD(vdna_select_config, stop_early);
    FIELD(vdna_select_config, reselect);
    FIELD(vdna_select_config, exact);
    FIELD(vdna_select_config, reserved);

    STRUCT(vdna_select_position);
    FIELD(vdna_select_position, candidate);
    FIELD(vdna_select_position, reserved);
    FIELD(vdna_select_position, answer);

    STRUCT(vdna_select_frame);
    FIELD(vdna_select_frame, utime);
    FIELD(vdna_select_frame, taps);
    FIELD(vdna_select_frame, tap_count);
    FIELD(vdna_select_frame, embedding);

    STRUCT(vdna_select_answer);
    FIELD(vdna_select_answer, state);
    FIELD(vdna_select_answer, newly_ranked);
    FIELD(vdna_select_answer, restarted);
    FIELD(vdna_select_answer, localised);
    FIELD(vdna_select_answer, match);
}

static void print_map(void)
{
    STRUCT(vdna_identity);
    FIELD(vdna_identity, backbone);
    FIELD(vdna_identity, model_sha256);
    FIELD(vdna_identity, preprocessing);
    FIELD(vdna_identity, precision);
    FIELD(vdna_identity, taps);
    FIELD(vdna_identity, neurons);
    FIELD(vdna_identity, dim);
    FIELD(vdna_identity, bins);
    FIELD(vdna_identity, range);
    FIELD(vdna_identity, embedding);
    FIELD(vdna_identity, projection);
    FIELD(vdna_identity, raw_dim);
    FIELD(vdna_identity, reserved);

    STRUCT(vdna_tap);
    FIELD(vdna_tap, name);
    FIELD(vdna_tap, name_length);
    FIELD(vdna_tap, neurons);
    FIELD(vdna_tap, samples);

    STRUCT(vdna_map_trust);
    FIELD(vdna_map_trust, tables);
    FIELD(vdna_map_trust, tolerance);
    FIELD(vdna_map_trust, runs);
    FIELD(vdna_map_trust, localiser);
    FIELD(vdna_map_trust, memory);

    STRUCT(vdna_experience);
    FIELD(vdna_experience, name);
    FIELD(vdna_experience, identity);
    FIELD(vdna_experience, comparable);
    FIELD(vdna_experience, frames);
    FIELD(vdna_experience, counts);
    FIELD(vdna_experience, mass);
    FIELD(vdna_experience, embeddings);
    FIELD(vdna_experience, frame_utime);
    FIELD(vdna_experience, frame_place);
    FIELD(vdna_experience, frame_position);
    FIELD(vdna_experience, frame_grey);
    FIELD(vdna_experience, file_bytes);
    FIELD(vdna_experience, file_size);
    FIELD(vdna_experience, position_frame);
    FIELD(vdna_experience, order);
    FIELD(vdna_experience, last_layer);
    FIELD(vdna_experience, last_layer_scale);
    FIELD(vdna_experience, last_layer_dim);
    FIELD(vdna_experience, checksum);
    FIELD(vdna_experience, embedding_codes);
    FIELD(vdna_experience, embedding_scale);
    FIELD(vdna_experience, thumbnails);
    FIELD(vdna_experience, thumbnail_end);
    FIELD(vdna_experience, thumbnail_bytes);
    FIELD(vdna_experience, source);
}

static void print_backbone(void)
{
    STRUCT(vdna_image);
    FIELD(vdna_image, data);
    FIELD(vdna_image, size);
    FIELD(vdna_image, width);
    FIELD(vdna_image, height);
    FIELD(vdna_image, row_stride);
    FIELD(vdna_image, pixelformat);

    STRUCT(vdna_backbone_config);
    FIELD(vdna_backbone_config, struct_size);
    FIELD(vdna_backbone_config, threads);
    FIELD(vdna_backbone_config, max_pixels);
    FIELD(vdna_backbone_config, reserved);
    FIELD(vdna_backbone_config, manifest);
    FIELD(vdna_backbone_config, runtime);

    STRUCT(vdna_backbone_info);
    FIELD(vdna_backbone_info, identity);
    FIELD(vdna_backbone_info, quantised_from);
    FIELD(vdna_backbone_info, runtime);
    FIELD(vdna_backbone_info, tap_count);
    FIELD(vdna_backbone_info, input_width);
    FIELD(vdna_backbone_info, input_height);
    FIELD(vdna_backbone_info, decode_bytes);
    FIELD(vdna_backbone_info, last_layer_dim);
    FIELD(vdna_backbone_info, embedding_int8);
    FIELD(vdna_backbone_info, embedding_dims);
    FIELD(vdna_backbone_info, reserved);

    STRUCT(vdna_backbone_frame);
    FIELD(vdna_backbone_frame, taps);
    FIELD(vdna_backbone_frame, embedding);
    FIELD(vdna_backbone_frame, input);
    FIELD(vdna_backbone_frame, tap_count);
    FIELD(vdna_backbone_frame, dim);
    FIELD(vdna_backbone_frame, grey);
    FIELD(vdna_backbone_frame, decode_us);
    FIELD(vdna_backbone_frame, resize_us);
    FIELD(vdna_backbone_frame, inference_us);
    FIELD(vdna_backbone_frame, last_layer_dim);
    FIELD(vdna_backbone_frame, last_layer);
    FIELD(vdna_backbone_frame, health);
}

int main(void)
{
    print_core();
    print_localise();
    print_trust();
    print_select();
    print_map();
    print_backbone();
    return 0;
}
