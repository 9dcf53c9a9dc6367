/* Private: CRC-32C (Castagnoli; iSCSI, RFC 3720). */
#ifndef VDNA_CRC32C_H
#define VDNA_CRC32C_H

#include <stddef.h>
#include <stdint.h>

/* Extend `crc` by `size` more bytes; the CRC of no bytes is 0. */
uint32_t vdna_crc32c(uint32_t crc, const void *bytes, size_t size);

/* The same in software, on every machine. */
uint32_t vdna_crc32c_by_tables(uint32_t crc, const void *bytes, size_t size);

/* The same by the processor's instruction, several times as fast.
 * @return 1; 0 if it has none; `*crc` is then unchanged */
int vdna_crc32c_by_instruction(uint32_t *crc, const void *bytes, size_t size);

#endif
