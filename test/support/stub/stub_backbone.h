/* A backbone without a network, behind the C ABI of lib/backbone: for tests of everything around
 * it. It fits the map of map_files.h, gives the same numbers for every picture, and takes
 * $VDNA_STUB_US microseconds (default 0) asleep for each. */
#ifndef STUB_BACKBONE_H
#define STUB_BACKBONE_H

#include <vdna/backbone.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Called at the end of each vdna_backbone_run(); NULL = not. */
extern void (*stub_backbone_ran)(void);

#ifdef __cplusplus
}
#endif

#endif
