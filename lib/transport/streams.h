/* Private: which numbers of which streams of protected camera frames have come. */
#ifndef VDNA_STREAMS_H
#define VDNA_STREAMS_H

#include <stdbool.h>

#include <vdna/transport.h>

/* Streams that are followed at a time; a new one takes the place of the one silent for longest. */
#define VDNA_STREAMS 4u
/* Numbers before a stream's newest of which it is known whether they came. */
#define VDNA_STREAM_WINDOW 64u

/* All zeros: no stream yet. */
typedef struct vdna_streams {
    struct vdna_stream {
        uint64_t id;
        uint64_t first, newest; /* numbers; first: the one that the stream began with here */
        uint64_t seen;          /* bit k: newest - k came */
    } streams[VDNA_STREAMS];    /* the one that was last heard first */
    uint32_t count;
} vdna_streams;

/* Take the number of an intact frame, and count what it tells: stream_count, lost_frames,
 * repeated_frames, reordered_frames. Returns whether the frame is newer than all of its stream. */
bool vdna_streams_take(vdna_streams *streams, const vdna_transport_stream *frame,
                       vdna_transport_counters *counters);

#endif
