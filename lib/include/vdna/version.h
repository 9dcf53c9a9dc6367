/** @file vdna/version.h
 *  @brief Version of the library; the experience file and the messages have their own.
 */
#ifndef VDNA_VERSION_H
#define VDNA_VERSION_H

#include <vdna/status.h>

#ifdef __cplusplus
extern "C" {
#endif

#define VDNA_VERSION_MAJOR 0 /**< incompatible changes of the API */
#define VDNA_VERSION_MINOR 1 /**< additions; before 1.0 also incompatible changes */
#define VDNA_VERSION_PATCH 0 /**< repairs */

/** "MAJOR.MINOR.PATCH" of the linked library, to be compared with the macros of its header.
 *  @return a constant string */
VDNA_API const char *vdna_version(void);

#ifdef __cplusplus
}
#endif

#endif
