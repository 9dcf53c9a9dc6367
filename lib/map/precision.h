/* Private to lib/map: what a network computes in, where that is not the usual. */
#ifndef VDNA_PRECISION_H
#define VDNA_PRECISION_H

#include <string.h>

/* What it is where nothing is said: files of fp32 networks do not say it. */
#define VDNA_PRECISION_DEFAULT "fp32"

static inline int vdna_precision_is_default(const char *precision)
{
    return precision[0] == '\0' || strcmp(precision, VDNA_PRECISION_DEFAULT) == 0;
}

#endif
