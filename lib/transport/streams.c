#include "streams.h"

#include <string.h>

/* Move a stream, or the place of a new one, to the front. */
static struct vdna_stream *bring_forward(vdna_streams *streams, uint32_t index)
{
    const struct vdna_stream moved = streams->streams[index];
    memmove(streams->streams + 1, streams->streams, index * sizeof moved);
    streams->streams[0] = moved;
    return streams->streams;
}

static struct vdna_stream *find_stream(vdna_streams *streams, uint64_t id)
{
    for (uint32_t i = 0; i < streams->count; i++)
        if (streams->streams[i].id == id)
            return bring_forward(streams, i);
    return NULL;
}

static void begin_stream(vdna_streams *streams, const vdna_transport_stream *frame)
{
    if (streams->count < VDNA_STREAMS)
        streams->count++;
    *bring_forward(streams, streams->count - 1) =
        (struct vdna_stream){frame->id, frame->sequence, frame->sequence, 1};
}

static void go_on(struct vdna_stream *stream, uint64_t sequence, vdna_transport_counters *counters)
{
    const uint64_t ahead = sequence - stream->newest;
    counters->lost_frames += ahead - 1;
    stream->seen = (ahead < VDNA_STREAM_WINDOW ? stream->seen << ahead : 0) | 1;
    stream->newest = sequence;
}

static void look_back(struct vdna_stream *stream, uint64_t sequence,
                      vdna_transport_counters *counters)
{
    const uint64_t behind = stream->newest - sequence;
    if (behind >= VDNA_STREAM_WINDOW || (stream->seen >> behind & 1) != 0) {
        counters->repeated_frames++;
        return;
    }
    stream->seen |= (uint64_t)1 << behind;
    counters->reordered_frames++;
    /* The gap that it fills was taken for a loss. What precedes the first frame never was. */
    if (sequence > stream->first)
        counters->lost_frames--;
}

/* see streams.h */
bool vdna_streams_take(vdna_streams *streams, const vdna_transport_stream *frame,
                       vdna_transport_counters *counters)
{
    struct vdna_stream *stream = find_stream(streams, frame->id);
    if (!stream) {
        begin_stream(streams, frame);
        counters->stream_count++;
        return true;
    }
    if (frame->sequence <= stream->newest) {
        look_back(stream, frame->sequence, counters);
        return false;
    }
    go_on(stream, frame->sequence, counters);
    return true;
}
