/* Shared libraries that are no plug-ins: BROKEN is what is wrong. */
#include <vdna/backbone.h>

#define NO_ENTRY 0 /* exports something else */
#define NO_TABLE 1
#define SMALL_TABLE 2

#if BROKEN == NO_ENTRY
VDNA_API int vdna_backbone_plug_out(void);
int vdna_backbone_plug_out(void)
{
    return 0;
}
#else
const vdna_backbone_operations *vdna_backbone_plugin(void)
{
    static const vdna_backbone_operations small = {.struct_size = 8};
    return BROKEN == SMALL_TABLE ? &small : NULL;
}
#endif
