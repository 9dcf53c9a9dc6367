/* Files of a map whose checksum is right whatever their bytes. */
#ifndef RIGHT_CHECKSUM_H
#define RIGHT_CHECKSUM_H

#include <stdlib.h>
#include <string.h>

#include "tensors.h"

/* Correct the checksum, so that the code behind it is tried as well.
 * @return whether the file has one */
static inline int set_right_checksum(unsigned char *bytes, size_t size)
{
    vdna_header header;
    if (vdna_header_read(bytes, size, NULL, &header) != VDNA_OK)
        return 0;
    const vdna_tensor *crc = vdna_header_tensor(&header, VDNA_CRC_TENSOR);
    if (!crc || crc->end - crc->begin != sizeof(uint32_t))
        return 0;
    const uint32_t checksum = vdna_tensors_checksum(bytes, size, crc);
    memcpy(bytes + crc->begin, &checksum, sizeof checksum);
    return 1;
}

/* Try an input as it is, and with the right checksum if it has one. */
static inline void try_file(const unsigned char *input, size_t size,
                            void (*read_and_use)(const unsigned char *bytes, size_t size))
{
    unsigned char *copy = malloc(size);
    if (!copy)
        return;
    memcpy(copy, input, size);
    read_and_use(copy, size);
    if (set_right_checksum(copy, size))
        read_and_use(copy, size);
    free(copy);
}

#endif
