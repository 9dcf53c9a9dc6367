/* Camera time between two stamps, which may be any int64. Private to the library. */
#ifndef VDNA_CORE_ELAPSED_H
#define VDNA_CORE_ELAPSED_H

#include <stdint.h>

/* Microseconds from the earlier to the later: never negative when later >= earlier. */
static inline uint64_t vdna_elapsed_us(int64_t earlier, int64_t later)
{
    return (uint64_t)later - (uint64_t)earlier;
}

#endif
