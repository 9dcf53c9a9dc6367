/* The additions of a machine without a C library to link the core: an entry and three functions. */
#include <string.h>

void *memcpy(void *restrict to, const void *restrict from, size_t size)
{
    unsigned char *at = to;
    const unsigned char *next = from;
    while (size-- > 0)
        *at++ = *next++;
    return to;
}

void *memset(void *to, int byte, size_t size)
{
    unsigned char *at = to;
    while (size-- > 0)
        *at++ = (unsigned char)byte;
    return to;
}

int memcmp(const void *a, const void *b, size_t size)
{
    const unsigned char *x = a, *y = b;
    for (; size > 0; size--, x++, y++)
        if (*x != *y)
            return *x < *y ? -1 : 1;
    return 0;
}

void _start(void)
{
    for (;;)
        ;
}
