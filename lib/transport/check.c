#include "cursor.h"
#include <vdna/transport.h>
#include <vdna_msg_command_t.h>
#include <vdna_msg_localisation_t.h>
#include <vdna_msg_ranking_t.h>
#include <vdna_msg_status_t.h>

/* Each function walks the members in the order of the .lcm file. */

static vdna_status verdict(const cursor *c)
{
    return cursor_complete(c) ? VDNA_OK : VDNA_ERR_FORMAT;
}

/* see vdna/transport.h */
vdna_status vdna_transport_check_ranking(const void *data, size_t size)
{
    cursor c = cursor_begin(data, size, __vdna_msg_ranking_t_get_hash());
    cursor_take(&c, 2, sizeof(int64_t)); /* utime, window_begin_utime */
    cursor_take(&c, 2, sizeof(int32_t)); /* window_frames, validity */
    cursor_strings(&c, 2);               /* backbone, comparable */
    cursor_take(&c, 1, sizeof(double));  /* margin_bins */
    const uint32_t count = cursor_count(&c);
    cursor_strings(&c, count);              /* experience */
    cursor_take(&c, count, sizeof(double)); /* distance_bins */
    cursor_take(&c, count, sizeof(int8_t)); /* tied */
    cursor_take(&c, count, sizeof(double)); /* predicted_recall */
    return verdict(&c);
}

/* see vdna/transport.h */
vdna_status vdna_transport_check_localisation(const void *data, size_t size)
{
    cursor c = cursor_begin(data, size, __vdna_msg_localisation_t_get_hash());
    cursor_take(&c, 1, sizeof(int64_t)); /* utime */
    cursor_take(&c, 1, sizeof(int32_t)); /* validity */
    cursor_strings(&c, 1);               /* experience */
    cursor_take(&c, 1, sizeof(int32_t)); /* frame */
    cursor_take(&c, 1, sizeof(int64_t)); /* frame_utime */
    cursor_take(&c, 1, sizeof(int8_t));  /* has_place */
    cursor_take(&c, 1, sizeof(int64_t)); /* place */
    cursor_take(&c, 1, sizeof(int8_t));  /* has_position */
    cursor_take(&c, 5, sizeof(double));  /* position[3], distance, predicted_recall */
    cursor_take(&c, 2, sizeof(int64_t)); /* latency_us, skipped */
    return verdict(&c);
}

/* queue, decode, resize, inference, select, rank, publish, total: four numbers each */
#define STAGES 8
#define DURATION_MEMBERS 4

/* see vdna/transport.h */
vdna_status vdna_transport_check_status(const void *data, size_t size)
{
    cursor c = cursor_begin(data, size, __vdna_msg_status_t_get_hash());
    cursor_take(&c, 1, sizeof(int64_t)); /* utime */
    cursor_take(&c, 1, sizeof(int32_t)); /* state */
    cursor_take(&c, 1, sizeof(double));  /* progress */
    cursor_strings(&c, 1);               /* experience */
    cursor_take(&c, 1, sizeof(int32_t)); /* experiences */
    cursor_strings(&c, 2);               /* backbone, version */
    cursor_take(&c, 7, sizeof(int64_t)); /* received ... restarts */
    cursor_take(&c, STAGES * DURATION_MEMBERS, sizeof(int64_t));
    cursor_take(&c, 3, sizeof(int64_t)); /* resident_bytes, resident and picture_bytes_max */
    cursor_take(&c, 2, sizeof(int32_t)); /* window_frames_max, backlog_max */
    cursor_strings(&c, 1);               /* message */
    return verdict(&c);
}

/* see vdna/transport.h */
vdna_status vdna_transport_check_command(const void *data, size_t size)
{
    cursor c = cursor_begin(data, size, __vdna_msg_command_t_get_hash());
    cursor_take(&c, 1, sizeof(int64_t)); /* utime */
    cursor_take(&c, 1, sizeof(int32_t)); /* command */
    cursor_strings(&c, 1);               /* argument */
    return verdict(&c);
}
