#include "multicast.h"

#include <arpa/inet.h>
#include <errno.h>
#include <fail.h>
#include <linux/sock_diag.h>
#include <net/if.h>
#include <netinet/in.h>
#include <poll.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include "network.h"
#include "udpm.h"

/* How often a sender that is not known makes us read our own addresses anew. */
#define OWN_PERIOD_US 1000000

/* --- who may send --- */

/* see multicast.h */
bool vdna_multicast_is_source(const char *text)
{
    struct in_addr address;
    return text && inet_pton(AF_INET, text, &address) == 1;
}

static void read_sources(vdna_multicast *m, const char *const *sources, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++)
        inet_pton(AF_INET, sources[i], &m->allowed[i]);
    m->allowed_count = count;
}

static bool is_among(const uint32_t *addresses, uint32_t count, uint32_t address)
{
    for (uint32_t i = 0; i < count; i++)
        if (addresses[i] == address)
            return true;
    return false;
}

static void read_own_addresses(vdna_multicast *m)
{
    struct ifreq interfaces[VDNA_MULTICAST_OWN_MAX];
    struct ifconf list = {.ifc_len = sizeof interfaces, .ifc_req = interfaces};
    m->own_count = 0;
    if (ioctl(m->socket, SIOCGIFCONF, &list) != 0)
        return;
    for (size_t i = 0; i < (size_t)list.ifc_len / sizeof *interfaces; i++) {
        struct sockaddr_in address;
        memcpy(&address, &interfaces[i].ifr_addr, sizeof address);
        m->own[m->own_count++] = address.sin_addr.s_addr;
    }
}

/* The senders of datagrams that never leave the loopback interface. On a machine without a network
 * they have no address. */
static bool is_loopback(uint32_t address)
{
    return address == INADDR_ANY || ntohl(address) >> IN_CLASSA_NSHIFT == IN_LOOPBACKNET;
}

/* Whether a datagram comes from this machine. Linux accepts no packet from outside whose sender has
 * one of our addresses or one of the above. Addresses may be assigned at any time. */
static bool is_own(vdna_multicast *m, uint32_t address, int64_t now_us)
{
    if (is_loopback(address) || is_among(m->own, m->own_count, address))
        return true;
    if (now_us - m->own_read_us < OWN_PERIOD_US)
        return false;
    m->own_read_us = now_us;
    read_own_addresses(m);
    return is_among(m->own, m->own_count, address);
}

static bool may_send(vdna_multicast *m, uint32_t address, int64_t now_us)
{
    return m->from_anywhere || is_among(m->allowed, m->allowed_count, address) ||
           is_own(m, address, now_us);
}

/* --- the socket --- */

static bool enable(int socket, int level, int option, int value)
{
    return setsockopt(socket, level, option, &value, sizeof value) == 0;
}

/* Bound to the group, the socket gets nothing that was sent to this machine alone. It also gets
 * what comes by interfaces that only others have joined, which a sender of this machine may use
 * once the route has changed; but not if any machine may send. */
static bool join(vdna_multicast *m, const vdna_udpm *network)
{
    const struct sockaddr_in address = {
        .sin_family = AF_INET, .sin_port = htons(network->port), .sin_addr = {network->group}};
    const struct ip_mreq group = {.imr_multiaddr = address.sin_addr};
    m->socket = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    return m->socket >= 0 && enable(m->socket, SOL_SOCKET, SO_REUSEADDR, 1) &&
           enable(m->socket, SOL_SOCKET, SO_TIMESTAMPNS, 1) &&
           enable(m->socket, SOL_SOCKET, SO_RCVBUF, network->buffer_bytes) &&
           enable(m->socket, IPPROTO_IP, IP_MULTICAST_ALL, !m->from_anywhere) &&
           bind(m->socket, (const struct sockaddr *)&address, sizeof address) == 0 &&
           setsockopt(m->socket, IPPROTO_IP, IP_ADD_MEMBERSHIP, &group, sizeof group) == 0;
}

static size_t struct_bytes(void)
{
    return (sizeof(vdna_multicast) + sizeof(uint64_t) - 1) / sizeof(uint64_t) * sizeof(uint64_t);
}

/* see multicast.h */
size_t vdna_multicast_mem_size(const vdna_wanted_channel *channels, uint32_t count)
{
    return struct_bytes() + vdna_reassembly_mem_size(channels, count);
}

static vdna_status begin(vdna_multicast *m, const char *url, const char *const *sources,
                         uint32_t source_count, vdna_error *error)
{
    vdna_udpm network;
    if (!vdna_udpm_read(url, &network))
        return vdna_fail(
            error, VDNA_ERR_IO,
            "%.200s: this is no multicast network; expected a URL such as " VDNA_LCM_URL, url);
    read_sources(m, sources, source_count);
    m->from_anywhere = network.ttl > 0 && source_count == 0;
    if (!join(m, &network))
        return vdna_fail(error, VDNA_ERR_IO,
                         "%.200s: cannot receive from this network: %s; " VDNA_LCM_REMEDY, url,
                         strerror(errno));
    read_own_addresses(m);
    return VDNA_OK;
}

/* see multicast.h */
vdna_status vdna_multicast_open(const char *url, const char *const *sources, uint32_t source_count,
                                const vdna_wanted_channel *channels, uint32_t count,
                                vdna_error *error, vdna_multicast **out_receiver)
{
    const size_t size = vdna_multicast_mem_size(channels, count);
    uint8_t *block = calloc(1, size);
    if (!block)
        return vdna_fail(error, VDNA_ERR_NOMEM,
                         "transport: no %zu bytes of memory for messages; lower max_image_bytes",
                         size);
    vdna_multicast *m = (vdna_multicast *)(void *)block;
    m->socket = -1;
    m->messages =
        vdna_reassembly_init(channels, count, block + struct_bytes(), size - struct_bytes());
    const vdna_status status = begin(m, url, sources, source_count, error);
    if (status != VDNA_OK) {
        vdna_multicast_close(m);
        return status;
    }
    *out_receiver = m;
    return VDNA_OK;
}

/* see multicast.h */
void vdna_multicast_close(vdna_multicast *m)
{
    if (m && m->socket >= 0)
        close(m->socket);
    free(m);
}

/* see multicast.h */
int vdna_multicast_wait(const vdna_multicast *m, int timeout_ms)
{
    struct pollfd incoming = {.fd = m->socket, .events = POLLIN};
    const int ready = poll(&incoming, 1, timeout_ms);
    if (ready < 0)
        return errno == EINTR ? 0 : -1;
    return ready;
}

/* see multicast.h
 * The option's counter has 32 bits. */
uint32_t vdna_multicast_count_dropped(vdna_multicast *m)
{
    uint32_t numbers[SK_MEMINFO_VARS] = {0};
    socklen_t size = sizeof numbers;
    if (getsockopt(m->socket, SOL_SOCKET, SO_MEMINFO, numbers, &size) != 0)
        return 0;
    const uint32_t since = numbers[SK_MEMINFO_DROPS] - m->dropped_mark;
    m->dropped_mark = numbers[SK_MEMINFO_DROPS];
    m->dropped += since;
    return since;
}

/* When the system got the datagram; 0 = it does not say. */
static int64_t stamp_of(struct msghdr *header)
{
    for (struct cmsghdr *c = CMSG_FIRSTHDR(header); c; c = CMSG_NXTHDR(header, c))
        if (c->cmsg_level == SOL_SOCKET && c->cmsg_type == SCM_TIMESTAMPNS) {
            struct timespec stamp;
            memcpy(&stamp, CMSG_DATA(c), sizeof stamp);
            return (int64_t)stamp.tv_sec * 1000000 + stamp.tv_nsec / 1000;
        }
    return 0;
}

/* see multicast.h */
int vdna_multicast_take(vdna_multicast *m, vdna_arrival *out_arrival, int64_t *out_received_us)
{
    union {
        char bytes[CMSG_SPACE(sizeof(struct timespec))];
        struct cmsghdr align;
    } control;
    struct sockaddr_in sender;
    struct iovec room = {m->datagram, sizeof m->datagram};
    struct msghdr header = {.msg_name = &sender,
                            .msg_namelen = sizeof sender,
                            .msg_iov = &room,
                            .msg_iovlen = 1,
                            .msg_control = &control,
                            .msg_controllen = sizeof control};
    const ssize_t size = recvmsg(m->socket, &header, 0);
    if (size < 0)
        return errno == EAGAIN || errno == EINTR ? 0 : -1;

    *out_received_us = vdna_network_monotonic_us(stamp_of(&header));
    *out_arrival = (vdna_arrival){.kind = VDNA_ARRIVAL_NOTHING};
    if (!may_send(m, sender.sin_addr.s_addr, *out_received_us)) {
        m->foreign++;
        return 1;
    }
    const vdna_datagram datagram = {
        .data = m->datagram,
        .size = (size_t)size,
        .source = (uint64_t)ntohl(sender.sin_addr.s_addr) << 16 | ntohs(sender.sin_port),
        .time_us = *out_received_us,
    };
    *out_arrival = vdna_reassembly_accept(m->messages, &datagram);
    return 1;
}
