/* Private to lib/map: CRC-32C (Castagnoli; iSCSI, RFC 3720), in software on every machine. */
#ifndef VDNA_CRC32C_H
#define VDNA_CRC32C_H

#include <stddef.h>
#include <stdint.h>

/* The CRC of `size` more bytes after those that gave `crc`; the CRC of nothing is 0. */
uint32_t vdna_crc32c(uint32_t crc, const void *bytes, size_t size);

#endif
