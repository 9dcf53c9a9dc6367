// Any sequence of datagrams from several senders. A message that is delivered must consist of the
// bytes of its fragments, one after the other and without a hole; messages that are held must not
// change.
//
// Input: for each datagram its sender, the time since the one before in units of 50 ms, its size
// (two bytes) and its bytes.
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fuzz.h"
#include "reassembly.h"

#define DATAGRAMS_MAX 64u
#define MESSAGE_MAX 400u
#define HEADER_SHORT 8u
#define HEADER_FRAGMENT 20u
#define HELD_MAX (VDNA_REASSEMBLY_SLOTS - 2)

static const vdna_wanted_channel channels[] = {{"CAMERA", MESSAGE_MAX}, {"COMMAND", 60}};

static void require(bool condition, const char *promise)
{
    if (condition)
        return;
    fprintf(stderr, "%s\n", promise);
    abort();
}

/* --- what came, read by a parser of its own --- */

typedef struct piece {
    uint64_t source;
    uint32_t sequence, size, offset, number, count;
    const uint8_t *data;
    size_t data_size;
} piece;

static piece pieces[DATAGRAMS_MAX];
static size_t piece_count;

static uint32_t number_at(const uint8_t *bytes, int size)
{
    uint32_t value = 0;
    for (int i = 0; i < size; i++)
        value = value << 8 | bytes[i];
    return value;
}

static void remember(const vdna_datagram *d)
{
    if (d->size < HEADER_FRAGMENT || memcmp(d->data, "LC03", 4) != 0)
        return;
    piece p = {.source = d->source,
               .sequence = number_at(d->data + 4, 4),
               .size = number_at(d->data + 8, 4),
               .offset = number_at(d->data + 12, 4),
               .number = number_at(d->data + 16, 2),
               .count = number_at(d->data + 18, 2),
               .data = d->data + HEADER_FRAGMENT,
               .data_size = d->size - HEADER_FRAGMENT};
    if (p.number == 0) {
        const uint8_t *nul = memchr(p.data, 0, p.data_size);
        if (!nul)
            return;
        p.data_size -= (size_t)(nul + 1 - p.data);
        p.data = nul + 1;
    }
    pieces[piece_count++] = p;
}

/* Whether fragments `number`, `number` + 1 ... of the message make up its bytes from `at` on. */
static bool is_made_of_pieces(const vdna_arrival *a, uint32_t count, uint32_t number, size_t at)
{
    if (number == count)
        return at == a->size;
    for (size_t i = 0; i < piece_count; i++) {
        const piece *p = &pieces[i];
        if (p->source == a->source && p->sequence == a->sequence && p->size == a->size &&
            p->count == count && p->number == number && p->offset == at &&
            p->data_size <= a->size - at && memcmp(p->data, a->data + at, p->data_size) == 0 &&
            is_made_of_pieces(a, count, number + 1, at + p->data_size))
            return true;
    }
    return false;
}

static void check_message(const vdna_arrival *a, const vdna_datagram *d)
{
    require(a->wanted < 2 && strcmp(a->channel, channels[a->wanted].name) == 0,
            "a message came on a channel that is not wanted");
    require(a->size == a->total_size && a->size <= channels[a->wanted].size_max,
            "a message is larger than its channel allows");
    require(a->source == d->source, "a message has another sender than its last datagram");
    if (a->slot == VDNA_REASSEMBLY_SLOTS && memcmp(d->data, "LC02", 4) == 0)
        require(a->data + a->size == d->data + d->size, "a short message is not its datagram");
    else
        require(is_made_of_pieces(a, number_at(d->data + 18, 2), 0, 0),
                "a message has other bytes than its fragments, or a hole");
}

static void check_beginning(const vdna_arrival *a, const vdna_datagram *d)
{
    require(a->data + a->size == d->data + d->size, "a beginning is not the end of its datagram");
    require(strlen(a->channel) > 0 && strlen(a->channel) < 64, "a channel has no 1..63 bytes");
    require((a->kind == VDNA_ARRIVAL_TOO_LARGE) == (a->wanted < 2), "a channel is of another kind");
}

/* --- messages that are held --- */

typedef struct held_message {
    uint32_t slot;
    uint8_t copy[MESSAGE_MAX];
    size_t size;
} held_message;

static held_message held[HELD_MAX];
static size_t held_count;

static void release_oldest(vdna_reassembly *r)
{
    const uint8_t *now = vdna_reassembly_held(r, held[0].slot);
    require(memcmp(now, held[0].copy, held[0].size) == 0, "a message changed while it was held");
    vdna_reassembly_release(r, held[0].slot);
    memmove(held, held + 1, --held_count * sizeof *held);
}

static void hold(vdna_reassembly *r, const vdna_arrival *message)
{
    if (held_count == HELD_MAX)
        release_oldest(r);
    held_message *h = &held[held_count++];
    memcpy(h->copy, message->data, message->size);
    h->size = message->size;
    h->slot = vdna_reassembly_hold(r, message);
}

static void check_counters(const vdna_reassembly *r, uint64_t datagrams)
{
    const vdna_reassembly_counters *c = vdna_reassembly_count(r);
    require(c->malformed + c->repeated <= datagrams && c->incomplete <= datagrams,
            "more datagrams are counted than came");
    vdna_reassembly_lost(r);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    static void *memory;
    const size_t needed = vdna_reassembly_mem_size(channels, 2);
    if (!memory && !(memory = malloc(needed)))
        abort();
    vdna_reassembly *r = vdna_reassembly_init(channels, 2, memory, needed);
    require(r != NULL, "the memory is too small");

    uint8_t *copies[DATAGRAMS_MAX];
    uint32_t count = 0;
    int64_t time_us = 0;
    piece_count = held_count = 0;
    while (size >= 4 && count < DATAGRAMS_MAX) {
        const size_t wanted = number_at(bytes + 2, 2), left = size - 4;
        const size_t length = wanted < left ? wanted : left;
        time_us += bytes[1] * 50000;
        /* Of its exact size, so that sanitizers see the first byte beyond it. */
        uint8_t *copy = copies[count++] = malloc(length ? length : 1);
        if (!copy)
            abort();
        memcpy(copy, bytes + 4, length);
        const vdna_datagram d = {copy, length, bytes[0], time_us};
        remember(&d);
        const vdna_arrival a = vdna_reassembly_accept(r, &d);
        if (a.kind == VDNA_ARRIVAL_MESSAGE) {
            check_message(&a, &d);
            if (bytes[0] & 1)
                hold(r, &a);
        } else if (a.kind != VDNA_ARRIVAL_NOTHING) {
            check_beginning(&a, &d);
        }
        bytes += 4 + length;
        size -= 4 + length;
    }
    while (held_count > 0)
        release_oldest(r);
    check_counters(r, count);
    while (count > 0)
        free(copies[--count]);
    return 0;
}

/* --- seeds --- */

typedef struct sequence {
    uint8_t *at;
    size_t left;
} sequence;

static void put(sequence *s, uint32_t value, int size)
{
    for (int shift = 8 * (size - 1); shift >= 0 && s->left > 0; shift -= 8, s->left--)
        *s->at++ = (uint8_t)(value >> shift);
}

static void put_datagram(sequence *s, uint32_t source, uint32_t wait, uint32_t length)
{
    put(s, source, 1);
    put(s, wait, 1);
    put(s, length, 2);
}

static void put_text(sequence *s, const char *text, size_t size)
{
    for (size_t i = 0; i < size; i++)
        put(s, (uint8_t)text[i], 1);
}

static void put_short(sequence *s, uint32_t source, uint32_t number, const char *channel)
{
    const size_t name = strlen(channel) + 1;
    put_datagram(s, source, 0, (uint32_t)(HEADER_SHORT + name + 12));
    put_text(s, "LC02", 4);
    put(s, number, 4);
    put_text(s, channel, name);
    put_text(s, "twelve bytes", 12);
}

/* Fragment `number` of `count`, of ten bytes each. */
static void put_fragment(sequence *s, uint32_t source, uint32_t message, uint32_t number,
                         uint32_t count, const char *channel)
{
    const size_t name = number == 0 ? strlen(channel) + 1 : 0;
    put_datagram(s, source, message % 3, (uint32_t)(HEADER_FRAGMENT + name + 10));
    put_text(s, "LC03", 4);
    put(s, message, 4);
    put(s, 10 * count, 4);
    put(s, 10 * number, 4);
    put(s, number, 2);
    put(s, count, 2);
    put_text(s, channel, name);
    for (uint32_t i = 0; i < 10; i++)
        put(s, message * 50 + number * 10 + i, 1);
}

/* The fragments of two messages of three, by an order of six digits, 0..2 and 3..5. */
static void put_order(sequence *s, const char *order, uint32_t second_source)
{
    for (; *order; order++) {
        const uint32_t i = (uint32_t)(*order - '0');
        put_fragment(s, i < 3 ? 1 : second_source, 7 + i / 3, i % 3, 3, "CAMERA");
    }
}

size_t vdna_fuzz_seed(unsigned index, uint8_t *out, size_t capacity)
{
    static const char *orders[] = {"012",   "210345", "031425", "011022", "0122334455",
                                   "02130", "543210", "0011",   "331001"};
    const unsigned count = sizeof orders / sizeof *orders;
    sequence s = {out, capacity};
    if (index < 2 * count) {
        put_order(&s, orders[index % count], 1 + index / count);
    } else if (index == 2 * count) {
        for (uint32_t i = 0; i < 8; i++)
            put_short(&s, i % 3, i / 2, i % 4 == 3 ? "COMMAND" : "CAMERA");
    } else if (index == 2 * count + 1) {
        for (uint32_t i = 0; i < 40; i++)
            put_fragment(&s, 1, 5, (7 * i) % 40, 40, "CAMERA");
    } else if (index == 2 * count + 2) {
        for (uint32_t i = 0; i < 8; i++)
            put_fragment(&s, i, i, i % 2, 9, i % 4 == 2 ? "LIDAR" : "COMMAND");
    }
    return (size_t)(s.at - out);
}
