/* SHA-256 by the processor's instructions, for large files; libmd does the rest. */
#ifndef VDNA_SHA256_H
#define VDNA_SHA256_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Bytes of a block. */
#define VDNA_SHA256_BLOCK 64

/* Hash `count` blocks into `state` with the result of libmd's SHA256Transform() on each of them,
 * four times as fast. Returns 1, or 0 if the processor has no such instructions; `state` is then
 * unchanged. */
int vdna_sha256_by_instruction(uint32_t state[8], const uint8_t *blocks, size_t count);

#ifdef __cplusplus
}
#endif

#endif
