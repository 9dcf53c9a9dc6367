#include "reassembly.h"

#include <stdbool.h>
#include <string.h>

#include <vdna/transport.h>

#include "cursor.h"

#define MAGIC_SHORT 0x4C433032u    /* "LC02" */
#define MAGIC_FRAGMENT 0x4C433033u /* "LC03" */

#define FRAGMENTS_MAX UINT16_MAX /* of a message; the format's limit */
#define UNKNOWN UINT32_MAX       /* a place between fragments, or a channel */
/* First bytes of a short message that tell it from another one with its number. */
#define HEAD_BYTES 128u
/* A sender that is farther from its last number than this has begun anew. */
#define SEQUENCE_JUMP 65536

typedef enum slot_state { SLOT_FREE, SLOT_HALF, SLOT_WHOLE, SLOT_HELD } slot_state;

/* A message. Fragment i takes the bytes bounds[i]..bounds[i + 1]; each bound is UNKNOWN until one
 * of its two fragments has come, and the other must agree. */
typedef struct slot {
    slot_state state;
    uint64_t source, opened; /* opened: in order of opening */
    int64_t time_us;         /* of its newest fragment */
    uint32_t sequence, size, fragments, arrived, wanted;
    uint32_t *bounds; /* [FRAGMENTS_MAX + 1] */
    uint8_t *bitmap;  /* of the fragments that have come */
    uint8_t *data;    /* [message_max] */
} slot;

/* A message that is done with. */
typedef struct settled_message {
    uint64_t source, head; /* head: hash of a short message; 0 for fragments */
    int64_t time_us;
    uint32_t sequence, size;
} settled_message;

/* A sender on the first channel. */
typedef struct stream {
    uint64_t source, used; /* used: in order of use; 0 = free */
    uint32_t first, newest;
    uint64_t settled; /* messages since `first` */
} stream;

struct vdna_reassembly {
    vdna_wanted_channel *channels; /* [channel_count], behind this struct */
    uint32_t channel_count, message_max;
    vdna_reassembly_counters counters;
    slot slots[VDNA_REASSEMBLY_SLOTS];
    settled_message settled[VDNA_REASSEMBLY_SETTLED]; /* a ring */
    uint64_t settled_count;                           /* all so far */
    stream streams[VDNA_REASSEMBLY_STREAMS];
    uint64_t lost_before, ticks;
};

/* The fixed part of a fragment. */
typedef struct fragment {
    uint32_t sequence, size, offset, number, count;
    const char *channel; /* fragment 0: its channel; otherwise NULL */
    const uint8_t *data;
    uint32_t data_size;
} fragment;

/* --- memory --- */

#define BITMAP_BYTES (FRAGMENTS_MAX / 8 + 1)
#define BOUNDS_BYTES ((FRAGMENTS_MAX + 1) * sizeof(uint32_t))

static size_t round_up(size_t size)
{
    return (size + sizeof(uint64_t) - 1) / sizeof(uint64_t) * sizeof(uint64_t);
}

/* The largest message of all channels; 0 = invalid. */
static uint32_t largest_of(const vdna_wanted_channel *channels, uint32_t count)
{
    uint32_t largest = 0;
    if (!channels || count > VDNA_REASSEMBLY_CHANNELS)
        return 0;
    for (uint32_t i = 0; i < count; i++) {
        if (!channels[i].name || channels[i].size_max > VDNA_MESSAGE_BYTES_MAX)
            return 0;
        if (channels[i].size_max > largest)
            largest = channels[i].size_max;
    }
    return largest;
}

/* Bytes before the slots. */
static size_t head_bytes(uint32_t count)
{
    return round_up(sizeof(vdna_reassembly)) + round_up(count * sizeof(vdna_wanted_channel));
}

/* see reassembly.h */
size_t vdna_reassembly_mem_size(const vdna_wanted_channel *channels, uint32_t count)
{
    const uint32_t largest = largest_of(channels, count);
    if (largest == 0)
        return 0;
    const size_t slot_bytes = BOUNDS_BYTES + round_up(BITMAP_BYTES) + round_up(largest);
    return head_bytes(count) + VDNA_REASSEMBLY_SLOTS * slot_bytes;
}

/* see reassembly.h */
vdna_reassembly *vdna_reassembly_init(const vdna_wanted_channel *channels, uint32_t count,
                                      void *mem, size_t mem_size)
{
    const size_t needed = vdna_reassembly_mem_size(channels, count);
    if (needed == 0 || mem_size < needed || (uintptr_t)mem % sizeof(uint64_t) != 0)
        return NULL;

    vdna_reassembly *r = mem;
    memset(r, 0, sizeof *r);
    r->channels = (vdna_wanted_channel *)(void *)((uint8_t *)mem + round_up(sizeof *r));
    memcpy(r->channels, channels, count * sizeof *channels);
    r->channel_count = count;
    r->message_max = largest_of(channels, count);
    uint8_t *at = (uint8_t *)mem + head_bytes(count);
    for (slot *s = r->slots; s < r->slots + VDNA_REASSEMBLY_SLOTS; s++) {
        s->bounds = (uint32_t *)(void *)at;
        s->bitmap = at + BOUNDS_BYTES;
        s->data = s->bitmap + round_up(BITMAP_BYTES);
        at = s->data + round_up(r->message_max);
    }
    return r;
}

/* --- messages that are settled --- */

static bool is_over(int64_t then_us, int64_t now_us)
{
    return now_us > then_us && (uint64_t)now_us - (uint64_t)then_us > VDNA_REASSEMBLY_PATIENCE_US;
}

static bool is_settled(const vdna_reassembly *r, const settled_message *m)
{
    for (uint64_t i = 0; i < VDNA_REASSEMBLY_SETTLED && i < r->settled_count; i++) {
        const settled_message *s = &r->settled[i];
        if (s->source == m->source && s->sequence == m->sequence && s->size == m->size &&
            s->head == m->head && !is_over(s->time_us, m->time_us))
            return true;
    }
    return false;
}

static void settle(vdna_reassembly *r, settled_message m)
{
    r->settled[r->settled_count++ % VDNA_REASSEMBLY_SETTLED] = m;
}

/* FNV-1a over the channel and the first data. */
static uint64_t hash_of(const uint8_t *bytes, size_t size)
{
    uint64_t hash = 14695981039346656037u;
    for (size_t i = 0; i < size && i < HEAD_BYTES; i++)
        hash = (hash ^ bytes[i]) * 1099511628211u;
    return hash | 1; /* 0 stands for fragments */
}

/* --- sequence numbers of the senders on the first channel --- */

/* How far a number is ahead of another, which may have wrapped. */
static int32_t ahead(uint32_t sequence, uint32_t of)
{
    const uint32_t distance = sequence - of;
    return distance <= INT32_MAX ? (int32_t)distance : -(int32_t)(UINT32_MAX - distance) - 1;
}

static uint64_t lost_in(const vdna_reassembly *r, const stream *sender)
{
    if (sender->used == 0)
        return 0;
    uint64_t known = sender->settled;
    for (const slot *s = r->slots; s < r->slots + VDNA_REASSEMBLY_SLOTS; s++)
        if (s->state == SLOT_HALF && s->source == sender->source &&
            ahead(s->sequence, sender->first) >= 0 && ahead(s->sequence, sender->newest) < 0)
            known++;
    const uint64_t numbered = (uint64_t)(sender->newest - sender->first) + 1;
    return numbered > known ? numbered - known : 0;
}

/* The stream of a sender, which a message on the first channel begins; NULL = none. */
static stream *stream_of(vdna_reassembly *r, uint64_t source, uint32_t sequence, bool on_first)
{
    stream *oldest = r->streams;
    for (stream *s = r->streams; s < r->streams + VDNA_REASSEMBLY_STREAMS; s++) {
        if (s->used > 0 && s->source == source)
            return s;
        if (s->used < oldest->used)
            oldest = s;
    }
    if (!on_first)
        return NULL;
    r->lost_before += lost_in(r, oldest);
    *oldest = (stream){source, 0, sequence, sequence, 0};
    return oldest;
}

/* A message came, whatever it was: its number is not lost. */
static void follow(vdna_reassembly *r, uint64_t source, uint32_t sequence, bool on_first)
{
    stream *sender = stream_of(r, source, sequence, on_first);
    if (!sender)
        return;
    sender->used = ++r->ticks;
    const int32_t step = ahead(sequence, sender->newest);
    if (step > SEQUENCE_JUMP || step < -SEQUENCE_JUMP) {
        r->lost_before += lost_in(r, sender);
        sender->first = sender->newest = sequence;
        sender->settled = 0;
    }
    if (step > 0)
        sender->newest = sequence;
    if (ahead(sequence, sender->first) >= 0)
        sender->settled++;
}

/* see reassembly.h */
uint64_t vdna_reassembly_lost(const vdna_reassembly *r)
{
    uint64_t lost = r->lost_before;
    for (const stream *s = r->streams; s < r->streams + VDNA_REASSEMBLY_STREAMS; s++)
        lost += lost_in(r, s);
    return lost;
}

/* --- slots --- */

static void settle_slot(vdna_reassembly *r, const slot *s)
{
    settle(r, (settled_message){s->source, 0, s->time_us, s->sequence, s->size});
}

static void give_up(vdna_reassembly *r, slot *s)
{
    settle_slot(r, s);
    s->state = SLOT_FREE;
    r->counters.incomplete++;
}

/* What came before has no claim any more: the message handed out last, unless it is held, and
 * messages whose rest does not come. */
static void tidy(vdna_reassembly *r, int64_t now_us)
{
    for (slot *s = r->slots; s < r->slots + VDNA_REASSEMBLY_SLOTS; s++) {
        if (s->state == SLOT_WHOLE)
            s->state = SLOT_FREE;
        if (s->state == SLOT_HALF && is_over(s->time_us, now_us))
            give_up(r, s);
    }
}

/* A free slot; of half received messages, the oldest goes if there is none. */
static slot *free_slot(vdna_reassembly *r)
{
    slot *oldest = NULL;
    for (slot *s = r->slots; s < r->slots + VDNA_REASSEMBLY_SLOTS; s++) {
        if (s->state == SLOT_FREE)
            return s;
        if (s->state == SLOT_HALF && (!oldest || s->opened < oldest->opened))
            oldest = s;
    }
    if (oldest)
        give_up(r, oldest);
    return oldest;
}

/* No sender has more than its share. */
static void limit(vdna_reassembly *r, uint64_t source)
{
    uint32_t count = 0;
    slot *oldest = NULL;
    for (slot *s = r->slots; s < r->slots + VDNA_REASSEMBLY_SLOTS; s++)
        if (s->state == SLOT_HALF && s->source == source) {
            count++;
            if (!oldest || s->opened < oldest->opened)
                oldest = s;
        }
    if (count >= VDNA_REASSEMBLY_SLOTS_PER_SOURCE)
        give_up(r, oldest);
}

static slot *find_slot(vdna_reassembly *r, uint64_t source, uint32_t sequence)
{
    for (slot *s = r->slots; s < r->slots + VDNA_REASSEMBLY_SLOTS; s++)
        if (s->state == SLOT_HALF && s->source == source && s->sequence == sequence)
            return s;
    return NULL;
}

static slot *open_slot(vdna_reassembly *r, const fragment *f, const vdna_datagram *datagram)
{
    limit(r, datagram->source);
    slot *s = free_slot(r);
    if (!s)
        return NULL; /* the caller holds more than it may */
    s->state = SLOT_HALF;
    s->source = datagram->source;
    s->opened = ++r->ticks;
    s->sequence = f->sequence;
    s->size = f->size;
    s->fragments = f->count;
    s->arrived = 0;
    s->wanted = UNKNOWN;
    for (uint32_t i = 0; i <= f->count; i++)
        s->bounds[i] = UNKNOWN;
    memset(s->bitmap, 0, f->count / 8 + 1);
    return s;
}

static bool has_come(const slot *s, uint32_t number)
{
    return s->bitmap[number / 8] >> number % 8 & 1;
}

static bool agrees(uint32_t bound, uint32_t place)
{
    return bound == UNKNOWN || bound == place;
}

/* Copy a fragment to its place, unless its neighbours contradict it. */
static bool place(slot *s, const fragment *f)
{
    const uint32_t end = f->offset + f->data_size;
    if (!agrees(s->bounds[f->number], f->offset) || !agrees(s->bounds[f->number + 1], end))
        return false;
    s->bounds[f->number] = f->offset;
    s->bounds[f->number + 1] = end;
    if (f->data_size > 0)
        memcpy(s->data + f->offset, f->data, f->data_size);
    s->bitmap[f->number / 8] |= (uint8_t)(1u << f->number % 8);
    s->arrived++;
    return true;
}

/* see reassembly.h */
uint32_t vdna_reassembly_hold(vdna_reassembly *r, const vdna_arrival *message)
{
    uint32_t at = message->slot;
    if (at == VDNA_REASSEMBLY_SLOTS) {
        at = (uint32_t)(free_slot(r) - r->slots);
        memcpy(r->slots[at].data, message->data, message->size);
    }
    r->slots[at].state = SLOT_HELD;
    return at;
}

/* see reassembly.h */
const uint8_t *vdna_reassembly_held(const vdna_reassembly *r, uint32_t held)
{
    return r->slots[held].data;
}

/* see reassembly.h */
void vdna_reassembly_release(vdna_reassembly *r, uint32_t held)
{
    r->slots[held].state = SLOT_FREE;
}

/* see reassembly.h */
const vdna_reassembly_counters *vdna_reassembly_count(const vdna_reassembly *r)
{
    return &r->counters;
}

/* --- datagrams --- */

static const vdna_arrival nothing = {.kind = VDNA_ARRIVAL_NOTHING, .slot = VDNA_REASSEMBLY_SLOTS};

static vdna_arrival malformed(vdna_reassembly *r)
{
    r->counters.malformed++;
    return nothing;
}

static vdna_arrival repeated(vdna_reassembly *r)
{
    r->counters.repeated++;
    return nothing;
}

/* The name that begins here, of 1..VDNA_CHANNEL_BYTES_MAX bytes and a NUL; NULL = none. */
static const char *take_channel(cursor *c)
{
    const size_t most = c->left <= VDNA_CHANNEL_BYTES_MAX ? c->left : VDNA_CHANNEL_BYTES_MAX + 1;
    const uint8_t *name = c->at;
    const uint8_t *end = !c->broken && most > 0 ? memchr(name, 0, most) : NULL;
    if (!end || end == name)
        return NULL;
    cursor_take(c, (size_t)(end - name) + 1, 1);
    return (const char *)name;
}

static uint32_t wanted_index(const vdna_reassembly *r, const char *channel)
{
    for (uint32_t i = 0; i < r->channel_count; i++)
        if (strcmp(r->channels[i].name, channel) == 0)
            return i;
    return UNKNOWN;
}

/* What begins a message, or is all of it. */
static vdna_arrival beginning(const vdna_reassembly *r, const vdna_datagram *datagram,
                              uint32_t sequence, const char *channel, uint64_t total_size)
{
    vdna_arrival arrival = {.kind = VDNA_ARRIVAL_OTHER,
                            .wanted = wanted_index(r, channel),
                            .slot = VDNA_REASSEMBLY_SLOTS,
                            .sequence = sequence,
                            .source = datagram->source,
                            .channel = channel,
                            .data = (const uint8_t *)channel + strlen(channel) + 1,
                            .total_size = total_size};
    arrival.size = (size_t)(datagram->data + datagram->size - arrival.data);
    if (arrival.wanted != UNKNOWN)
        arrival.kind = total_size > r->channels[arrival.wanted].size_max ? VDNA_ARRIVAL_TOO_LARGE
                                                                         : VDNA_ARRIVAL_MESSAGE;
    return arrival;
}

static vdna_arrival accept_short(vdna_reassembly *r, const vdna_datagram *datagram, cursor c)
{
    const uint32_t sequence = (uint32_t)cursor_unsigned(&c, sizeof(uint32_t));
    const cursor content = c;
    const char *channel = take_channel(&c);
    if (!channel || c.left > VDNA_MESSAGE_BYTES_MAX)
        return malformed(r);

    const settled_message whole = {datagram->source, hash_of(content.at, content.left),
                                   datagram->time_us, sequence, (uint32_t)c.left};
    if (is_settled(r, &whole))
        return repeated(r);
    settle(r, whole);
    const vdna_arrival arrival = beginning(r, datagram, sequence, channel, c.left);
    follow(r, datagram->source, sequence, arrival.wanted == 0);
    return arrival;
}

/* Whether a fragment lies within its message: the first at its beginning, the last at its end. */
static bool lies_within(const fragment *f)
{
    if (f->offset > f->size || f->data_size > f->size - f->offset)
        return false;
    if (f->number == 0 ? f->offset > 0 : f->data_size == 0)
        return false;
    return f->number < f->count - 1 || f->offset + f->data_size == f->size;
}

static bool read_fragment(cursor *c, fragment *f)
{
    f->sequence = (uint32_t)cursor_unsigned(c, sizeof(uint32_t));
    f->size = (uint32_t)cursor_unsigned(c, sizeof(uint32_t));
    f->offset = (uint32_t)cursor_unsigned(c, sizeof(uint32_t));
    f->number = (uint32_t)cursor_unsigned(c, sizeof(uint16_t));
    f->count = (uint32_t)cursor_unsigned(c, sizeof(uint16_t));
    if (c->broken || f->size > VDNA_MESSAGE_BYTES_MAX || f->number >= f->count ||
        f->count - 1 > f->size)
        return false;
    f->channel = f->number == 0 ? take_channel(c) : NULL;
    if (f->number == 0 && !f->channel)
        return false;
    f->data = c->at;
    f->data_size = c->left <= VDNA_MESSAGE_BYTES_MAX ? (uint32_t)c->left : UINT32_MAX;
    return lies_within(f);
}

/* A message whose first fragment says that it is not to be kept. */
static vdna_arrival turn_away(vdna_reassembly *r, const vdna_datagram *datagram, slot *s,
                              const vdna_arrival *arrival)
{
    if (s)
        s->state = SLOT_FREE;
    settle(r, (settled_message){datagram->source, 0, datagram->time_us, arrival->sequence,
                                (uint32_t)arrival->total_size});
    follow(r, datagram->source, arrival->sequence, arrival->wanted == 0);
    return *arrival;
}

static vdna_arrival complete(vdna_reassembly *r, slot *s)
{
    s->state = SLOT_WHOLE;
    settle_slot(r, s);
    follow(r, s->source, s->sequence, s->wanted == 0);
    return (vdna_arrival){.kind = VDNA_ARRIVAL_MESSAGE,
                          .wanted = s->wanted,
                          .slot = (uint32_t)(s - r->slots),
                          .sequence = s->sequence,
                          .source = s->source,
                          .channel = r->channels[s->wanted].name,
                          .data = s->data,
                          .size = s->size,
                          .total_size = s->size};
}

static vdna_arrival accept_fragment(vdna_reassembly *r, const vdna_datagram *datagram, cursor c)
{
    fragment f;
    if (!read_fragment(&c, &f))
        return malformed(r);
    const settled_message whole = {datagram->source, 0, datagram->time_us, f.sequence, f.size};
    if (is_settled(r, &whole))
        return repeated(r);

    slot *s = find_slot(r, datagram->source, f.sequence);
    if (s && (s->size != f.size || s->fragments != f.count))
        return malformed(r);
    if (s && has_come(s, f.number))
        return repeated(r);
    if (f.channel) {
        const vdna_arrival begun = beginning(r, datagram, f.sequence, f.channel, f.size);
        if (begun.kind != VDNA_ARRIVAL_MESSAGE)
            return turn_away(r, datagram, s, &begun);
    }
    if (f.size > r->message_max)
        return nothing; /* its first fragment tells whether anybody wants it */

    if (!s)
        s = open_slot(r, &f, datagram);
    if (!s || !place(s, &f))
        return malformed(r);
    s->time_us = datagram->time_us;
    if (f.channel)
        s->wanted = wanted_index(r, f.channel);
    return s->arrived == s->fragments ? complete(r, s) : nothing;
}

/* see reassembly.h */
vdna_arrival vdna_reassembly_accept(vdna_reassembly *r, const vdna_datagram *datagram)
{
    tidy(r, datagram->time_us);
    cursor c = {datagram->data, datagram->size, !datagram->data};
    switch ((uint32_t)cursor_unsigned(&c, sizeof(uint32_t))) {
    case MAGIC_SHORT:
        return accept_short(r, datagram, c);
    case MAGIC_FRAGMENT:
        return accept_fragment(r, datagram, c);
    default:
        return malformed(r);
    }
}
