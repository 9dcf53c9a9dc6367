/* The functions that a fuzz target defines. driver.c calls them; libFuzzer calls the first. */
#ifndef FUZZ_H
#define FUZZ_H

#include <stddef.h>
#include <stdint.h>

/* Bytes of the longest seed, and of the longest input that driver.c makes of one. */
#define FUZZ_SIZE 65536u

/* Try one input; none may crash. @return 0 */
int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

/* Write the valid input number `index` to mutate from.
 * @return its bytes, at most `capacity`; 0 if there are no more */
size_t vdna_fuzz_seed(unsigned index, uint8_t *out, size_t capacity);

#endif
