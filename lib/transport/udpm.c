#include "udpm.h"

#include <arpa/inet.h>
#include <stdlib.h>
#include <string.h>

#include "url.h"

#define SCHEME "udpm://"
#define DEFAULT_GROUP "239.255.76.67"
#define DEFAULT_PORT 7667
#define DEFAULT_BUFFER_BYTES (4 << 20)

static long number_of(const char *url, const char *name, long without)
{
    const char *value = url_option(url, name);
    return value ? strtol(value, NULL, 10) : without;
}

/* see udpm.h */
bool vdna_udpm_read(const char *url, vdna_udpm *out_udpm)
{
    char host[64] = DEFAULT_GROUP;
    if (!url_has_scheme(url, SCHEME))
        return false;
    const char *place = url + strlen(SCHEME);
    const size_t length = strcspn(place, ":?");
    if (length >= sizeof host)
        return false;
    if (length > 0) {
        memcpy(host, place, length);
        host[length] = 0;
    }
    const long port = place[length] == ':' ? strtol(place + length + 1, NULL, 10) : DEFAULT_PORT;
    const long buffer = number_of(url, "recv_buf_size", DEFAULT_BUFFER_BYTES);
    struct in_addr group;
    if (port <= 0 || port > UINT16_MAX || inet_aton(host, &group) == 0)
        return false;
    *out_udpm = (vdna_udpm){
        .group = group.s_addr,
        .port = (uint16_t)port,
        .ttl = number_of(url, "ttl", 0),
        .buffer_bytes = buffer > 0 && buffer <= INT32_MAX ? (int32_t)buffer : DEFAULT_BUFFER_BYTES,
    };
    return true;
}
