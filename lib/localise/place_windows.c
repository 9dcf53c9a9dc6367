#include "elapsed.h"
#include "place_filter.h"

static int is_after(const int64_t *places, uint32_t a, uint32_t b)
{
    return places[a] != places[b] ? places[a] > places[b] : a > b;
}

/* Let a frame of a heap, whose parents come after their children, sink to where it belongs. */
static void sink_place(const int64_t *places, vdna_place_window *heap, uint32_t count, uint32_t at)
{
    const uint32_t frame = heap[at].frame;
    while (at < count / 2) {
        uint32_t child = 2 * at + 1;
        if (child + 1 < count && is_after(places, heap[child + 1].frame, heap[child].frame))
            child++;
        if (!is_after(places, heap[child].frame, frame))
            break;
        heap[at].frame = heap[child].frame;
        at = child;
    }
    heap[at].frame = frame;
}

/* A heap sort: it needs no room and does not recurse. */
static void sort_frames(const int64_t *places, vdna_place_window *windows, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++)
        windows[i].frame = i;
    for (uint32_t at = count / 2; at-- > 0;)
        sink_place(places, windows, count, at);
    for (uint32_t last = count; last-- > 1;) {
        const uint32_t frame = windows[0].frame;
        windows[0].frame = windows[last].frame;
        windows[last].frame = frame;
        sink_place(places, windows, last, 0);
    }
}

/* see place_filter.h */
void vdna_place_windows(const int64_t *places, uint32_t count, uint32_t tolerance,
                        vdna_place_window *windows)
{
    sort_frames(places, windows, count);
    uint32_t i = 0;
    for (; i < count && places[windows[i].frame] == INT64_MIN; i++) {
        windows[i].first = i;
        windows[i].past = i + 1;
    }
    for (uint32_t first = i, past = i; i < count; i++) {
        const int64_t place = places[windows[i].frame];
        while (vdna_elapsed_us(places[windows[first].frame], place) > tolerance)
            first++;
        while (past < count && vdna_elapsed_us(place, places[windows[past].frame]) <= tolerance)
            past++;
        windows[i].first = first;
        windows[i].past = past;
    }
}
