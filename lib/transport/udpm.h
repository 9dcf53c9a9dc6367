/* Private: what a udpm:// URL says. */
#ifndef VDNA_UDPM_H
#define VDNA_UDPM_H

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A udpm:// network. */
typedef struct vdna_udpm {
    uint32_t group; /* IPv4 address, in network order */
    uint16_t port;
    long ttl;             /* 0 = datagrams stay on this machine */
    int32_t buffer_bytes; /* of a socket's receive buffer; the system grants as much as
                             net.core.rmem_max */
} vdna_udpm;

/* Read udpm://GROUP:PORT?OPTIONS, of which LCM has its say as well. Returns whether it is one. */
bool vdna_udpm_read(const char *url, vdna_udpm *out_udpm);

#ifdef __cplusplus
}
#endif

#endif
