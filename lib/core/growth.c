#include "growth.h"

#include <string.h>

/* see growth.h */
void vdna_config_write(void *out_config, size_t struct_size, const void *defaults, size_t size)
{
    const uint32_t stated = (uint32_t)struct_size;
    if (!out_config || struct_size < sizeof stated)
        return;
    memset(out_config, 0, struct_size);
    memcpy(out_config, defaults, struct_size < size ? struct_size : size);
    memcpy(out_config, &stated, sizeof stated);
}

/* see growth.h */
int vdna_config_read(const void *given, size_t oldest, void *config, size_t size)
{
    uint32_t stated;
    if (!given)
        return 0;
    memcpy(&stated, given, sizeof stated);
    if (stated < oldest || stated > size)
        return 0;
    memcpy(config, given, stated);
    return 1;
}
