/* The functions that a fuzz target defines. driver.c calls them; libFuzzer calls the first. */
#ifndef FUZZ_H
#define FUZZ_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#ifdef __cplusplus
extern "C" {
#endif

/* What holds for every input: ends the process with its place and text if it does not. */
#define MUST(hold) ((hold) ? (void)0 : vdna_fuzz_broken(__FILE__, __LINE__, #hold))

static inline void vdna_fuzz_broken(const char *file, int line, const char *expected)
{
    fprintf(stderr, "%s:%d: expected %s\n", file, line, expected);
    abort();
}

/* Bytes of the longest seed, and of the longest input that driver.c makes of one. */
#define FUZZ_SIZE 65536u

/* Try one input; none may crash. @return 0 */
int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

/* Write the valid input number `index` to mutate from.
 * @return its bytes, at most `capacity`; 0 if there are no more */
size_t vdna_fuzz_seed(unsigned index, uint8_t *out, size_t capacity);

#ifdef __cplusplus
}
#endif

#endif
