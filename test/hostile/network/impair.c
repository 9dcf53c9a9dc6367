// impair FROM TO SEED LOSS DUPLICATE REORDER CORRUPT PID: a bad network between two interfaces.
// Passes the UDP packets of one on to the other until its standard input ends, with these
// percentages lost, sent twice, held back for one to three packets, or with one bit flipped, each
// decided by the seed. Waits while a socket in the network of process PID has not been read, so
// that it loses nothing itself. Prints how many of LCM's messages went through whole, in good
// fragments.
//
// The kernel's netem does the same, but it is not in every kernel, and it does not know which
// messages came whole.
#include <arpa/inet.h>
#include <linux/if_ether.h>
#include <linux/if_packet.h>
#include <net/if.h>
#include <poll.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>

#include "unread.h"

#define PACKET_MAX 65600u
#define HELD_MAX 64u
#define ETHERNET 14u
#define RECENT 4096u
#define UNREAD_MAX (150u << 10)

typedef struct packet {
    uint8_t bytes[PACKET_MAX];
    size_t size;
    unsigned wait; // packets to let pass
} packet;

// A message of LCM's, and which of its fragments were sent unharmed.
typedef struct progress {
    bool is_known;
    uint32_t sequence, fragments;
    uint64_t good;
} progress;

static int from, to;
static uint64_t state;
static double loss, duplicate, reorder, corrupt;
static const char *unread_path;
static packet held[HELD_MAX];
static size_t held_count;
static progress recent[RECENT];
static unsigned long messages, whole, packets, lost, duplicated, reordered, corrupted;

static uint32_t random_below(uint32_t limit)
{
    state ^= state >> 12;
    state ^= state << 25;
    state ^= state >> 27;
    return (uint32_t)((state * 2685821657736338717u) >> 33) % limit;
}

static bool happens(double percent)
{
    return random_below(1000000) < percent * 10000;
}

// Protocol 0: only to send.
static int open_interface(const char *name, uint16_t protocol)
{
    const struct sockaddr_ll place = {.sll_family = AF_PACKET,
                                      .sll_protocol = htons(protocol),
                                      .sll_ifindex = (int)if_nametoindex(name)};
    const int opened = socket(AF_PACKET, SOCK_RAW, htons(protocol));
    const int room = 4 << 20;
    setsockopt(opened, SOL_SOCKET, SO_RCVBUF, &room, sizeof room);
    if (opened < 0 || bind(opened, (const struct sockaddr *)&place, sizeof place) != 0) {
        perror(name);
        exit(1);
    }
    return opened;
}

static uint32_t number_at(const uint8_t *bytes, int size)
{
    uint32_t value = 0;
    for (int i = 0; i < size; i++)
        value = value << 8 | bytes[i];
    return value;
}

static size_t udp_at(const packet *p)
{
    return ETHERNET + 4u * (p->bytes[ETHERNET] & 15);
}

static bool is_udp(const packet *p)
{
    return p->size > ETHERNET + 20 && p->bytes[ETHERNET + 9] == 17 && udp_at(p) + 8 < p->size;
}

// A virtual interface leaves the checksum to a network card; there is none.
static void complete_checksum(packet *p)
{
    uint8_t *udp = p->bytes + udp_at(p);
    const size_t size = number_at(udp + 4, 2);
    uint64_t sum = 17 + size;
    udp[6] = udp[7] = 0;
    for (size_t i = 0; i < 8; i += 2)
        sum += number_at(p->bytes + ETHERNET + 12 + i, 2);
    for (size_t i = 0; i + 1 < size; i += 2)
        sum += (uint64_t)udp[i] << 8 | udp[i + 1];
    if (size % 2)
        sum += (uint64_t)udp[size - 1] << 8;
    while (sum >> 16)
        sum = (sum & 0xffff) + (sum >> 16);
    const uint16_t folded = sum == 0xffff ? 0xffff : (uint16_t)~sum;
    udp[6] = (uint8_t)(folded >> 8);
    udp[7] = (uint8_t)folded;
}

static progress *progress_of(const packet *p)
{
    const uint8_t *lcm = p->bytes + udp_at(p) + 8;
    progress *m = &recent[number_at(lcm + 4, 4) % RECENT];
    if (!m->is_known || m->sequence != number_at(lcm + 4, 4)) {
        *m = (progress){true, number_at(lcm + 4, 4), lcm[3] == '3' ? number_at(lcm + 18, 2) : 1, 0};
        messages++;
    }
    return m;
}

static void count_good(const packet *p)
{
    const uint8_t *lcm = p->bytes + udp_at(p) + 8;
    progress *m = progress_of(p);
    const uint64_t all = (UINT64_C(1) << m->fragments) - 1, before = m->good;
    m->good |= UINT64_C(1) << (lcm[3] == '3' ? number_at(lcm + 16, 2) : 0);
    whole += m->good == all && before != all;
}

static void send_packet(packet *p)
{
    wait_until_read(unread_path, UNREAD_MAX);
    if (happens(corrupt)) {
        p->bytes[ETHERNET + random_below((uint32_t)(p->size - ETHERNET))] ^=
            (uint8_t)(1u << random_below(8));
        corrupted++;
    } else {
        count_good(p);
    }
    if (send(to, p->bytes, p->size, 0) < 0)
        perror("send");
}

static void release_held(bool all)
{
    for (size_t i = 0; i < held_count;) {
        if (!all && --held[i].wait > 0) {
            i++;
            continue;
        }
        static packet due;
        due = held[i];
        memmove(held + i, held + i + 1, (--held_count - i) * sizeof *held);
        send_packet(&due);
    }
}

static void pass_on(const packet *p)
{
    static packet copy;
    if (happens(reorder) && held_count < HELD_MAX) {
        release_held(false);
        held[held_count] = *p;
        held[held_count++].wait = 1 + random_below(3);
        reordered++;
        return;
    }
    copy = *p;
    send_packet(&copy);
    release_held(false);
}

static void take(packet *p)
{
    struct sockaddr_ll sender;
    socklen_t sender_size = sizeof sender;
    const ssize_t size =
        recvfrom(from, p->bytes, sizeof p->bytes, 0, (struct sockaddr *)&sender, &sender_size);
    p->size = size > 0 ? (size_t)size : 0;
    if (sender.sll_pkttype == PACKET_OUTGOING || !is_udp(p) ||
        memcmp(p->bytes + udp_at(p) + 8, "LC0", 3) != 0)
        return;
    complete_checksum(p);
    progress_of(p);
    packets++;
    int copies = 1;
    if (happens(duplicate)) {
        copies++;
        duplicated++;
    }
    if (happens(loss)) {
        copies--;
        lost++;
    }
    while (copies-- > 0)
        pass_on(p);
}

int main(int argc, char **argv)
{
    if (argc != 9)
        return fprintf(stderr, "usage: impair FROM TO SEED LOSS DUPLICATE REORDER CORRUPT PID\n"),
               2;
    char path[64];
    snprintf(path, sizeof path, "/proc/%s/net/udp", argv[8]);
    unread_path = path;
    from = open_interface(argv[1], ETH_P_IP);
    to = open_interface(argv[2], 0);
    state = strtoull(argv[3], NULL, 10) * 2 + 1;
    loss = atof(argv[4]);
    duplicate = atof(argv[5]);
    reorder = atof(argv[6]);
    corrupt = atof(argv[7]);
    puts("READY");
    fflush(stdout);
    struct pollfd ready[] = {{.fd = from, .events = POLLIN}, {.fd = 0, .events = POLLIN}};
    for (;;) {
        const int count = poll(ready, 2, 20);
        if (count == 0)
            release_held(true);
        if (ready[0].revents) {
            static packet p;
            take(&p);
        } else if (ready[1].revents) {
            break;
        }
    }
    release_held(true);
    printf(
        "{\"messages\": %lu, \"whole\": %lu, \"packets\": %lu, \"lost\": %lu, \"duplicated\": %lu, "
        "\"reordered\": %lu, \"corrupted\": %lu}\n",
        messages, whole, packets, lost, duplicated, reordered, corrupted);
    return 0;
}
