/* SHA-256 of much data: libmd's, by the processor's instructions where it has them. */
#ifndef VDNA_SHA256_H
#define VDNA_SHA256_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Bytes that are hashed at a time. */
#define VDNA_SHA256_BLOCK 64

/* Hash whole blocks into `state`, as libmd's SHA256Transform() does one after the other, several
 * times as fast. Returns 1; 0 if the processor has no instructions for it, and then `state` is as
 * it was. */
int vdna_sha256_by_instruction(uint32_t state[8], const uint8_t *blocks, size_t count);

#ifdef __cplusplus
}
#endif

#endif
