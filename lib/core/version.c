#include <vdna/version.h>

#define TEXT_OF(x) #x
#define VERSION_TEXT(major, minor, patch) TEXT_OF(major) "." TEXT_OF(minor) "." TEXT_OF(patch)

/* see vdna/version.h */
const char *vdna_version(void)
{
    return VERSION_TEXT(VDNA_VERSION_MAJOR, VDNA_VERSION_MINOR, VDNA_VERSION_PATCH);
}
