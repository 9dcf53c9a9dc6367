/** @file vdna/status.h
 *  @brief Results of calls, their texts, and the export mark.
 */
#ifndef VDNA_STATUS_H
#define VDNA_STATUS_H

#include <stdint.h>

/** Marks what a library exports; everything else stays hidden. */
#if defined(__GNUC__)
#define VDNA_API __attribute__((visibility("default")))
#else
#define VDNA_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

/** Result of a call: VDNA_OK or one of the VDNA_ERR_ codes. New codes are only ever appended. */
typedef int32_t vdna_status;

enum {
    VDNA_OK = 0,               /**< done */
    VDNA_ERR_ARG = 1,          /**< an argument breaks its stated rule */
    VDNA_ERR_NOMEM = 2,        /**< the block is too small, or the system has no memory left */
    VDNA_ERR_NONFINITE = 3,    /**< a NaN or an infinity in place of a finite number */
    VDNA_ERR_FULL = 4,         /**< a count would pass UINT32_MAX */
    VDNA_ERR_EMPTY = 5,        /**< a histogram without samples has no distance */
    VDNA_ERR_MISMATCH = 6,     /**< two things that do not compare: shape, range, backbone */
    VDNA_ERR_OVERFLOW = 7,     /**< the masses are too large for an exact 64-bit distance */
    VDNA_ERR_UNDERFLOW = 8,    /**< subtracting what was never added */
    VDNA_ERR_IO = 9,           /**< the operating system refused a file or a socket */
    VDNA_ERR_FORMAT = 10,      /**< bytes that break their specification */
    VDNA_ERR_CHECKSUM = 11,    /**< bytes differ from those written or pinned */
    VDNA_ERR_UNSUPPORTED = 12, /**< valid, but beyond what this version can do */
    VDNA_ERR_RUNTIME = 13,     /**< the network's runtime failed */
    VDNA_ERR_LATE = 14         /**< a frame older than one that was taken before */
};

/** Number of status codes, VDNA_OK included. */
#define VDNA_STATUS_COUNT 15

/** English text of a status, without a trailing period.
 *  @param status  any value
 *  @return a constant string, never NULL; "unknown status" for a value that is no code */
VDNA_API const char *vdna_status_text(vdna_status status);

/** One sentence for people: where, what was found, what was expected, what to do. */
typedef struct vdna_error {
    char text[512]; /**< NUL-terminated UTF-8, cut if longer; set only when a call fails */
} vdna_error;

#ifdef __cplusplus
}
#endif

#endif
