/** @file vdna/image.h
 *  @brief A picture as a camera sends it: plain struct and pixel formats, no code.
 */
#ifndef VDNA_IMAGE_H
#define VDNA_IMAGE_H

#include <stddef.h>
#include <stdint.h>

/** Little-endian FOURCC, as in V4L2 and in the camera message. */
#define VDNA_FOURCC(a, b, c, d) \
    ((uint32_t)(a) | (uint32_t)(b) << 8 | (uint32_t)(c) << 16 | (uint32_t)(d) << 24)

#define VDNA_PIXEL_ENCODED 0u /**< a file; its contents give kind and size */
#define VDNA_PIXEL_MJPG VDNA_FOURCC('M', 'J', 'P', 'G') /**< one JPEG picture */
#define VDNA_PIXEL_GREY VDNA_FOURCC('G', 'R', 'E', 'Y') /**< 8-bit grey */
#define VDNA_PIXEL_Y10 VDNA_FOURCC('Y', '1', '0', ' ')  /**< 10-bit grey, low byte first */
#define VDNA_PIXEL_Y12 VDNA_FOURCC('Y', '1', '2', ' ')  /**< 12-bit grey, as Y10 */
#define VDNA_PIXEL_Y14 VDNA_FOURCC('Y', '1', '4', ' ')  /**< 14-bit grey, as Y10 */
#define VDNA_PIXEL_Y16 VDNA_FOURCC('Y', '1', '6', ' ')  /**< 16-bit grey, as Y10 */
#define VDNA_PIXEL_LG16 VDNA_FOURCC('L', 'G', '1', '6') /**< another name for Y16, of bot_core */
#define VDNA_PIXEL_RGB3 VDNA_FOURCC('R', 'G', 'B', '3') /**< 24-bit R, G, B */
#define VDNA_PIXEL_BGR3 VDNA_FOURCC('B', 'G', 'R', '3') /**< 24-bit B, G, R */
#define VDNA_PIXEL_RGB4 VDNA_FOURCC('R', 'G', 'B', '4') /**< 32-bit R, G, B, unused */
#define VDNA_PIXEL_BGR4 VDNA_FOURCC('B', 'G', 'R', '4') /**< 32-bit B, G, R, unused */
#define VDNA_PIXEL_YUYV VDNA_FOURCC('Y', 'U', 'Y', 'V') /**< packed 4:2:2 */
#define VDNA_PIXEL_UYVY VDNA_FOURCC('U', 'Y', 'V', 'Y') /**< packed 4:2:2, chroma first */
#define VDNA_PIXEL_I420 VDNA_FOURCC('I', '4', '2', '0') /**< planar 4:2:0: Y, U, V */
#define VDNA_PIXEL_YU12 VDNA_FOURCC('Y', 'U', '1', '2') /**< another name for I420 */
#define VDNA_PIXEL_NV12 VDNA_FOURCC('N', 'V', '1', '2') /**< Y plane, then interleaved U, V */

/** Largest width and height that is decoded, in pixels. */
#define VDNA_IMAGE_SIDE_MAX 16384u
/** Largest width x height that is decoded, in pixels: a few bytes can claim to be a huge picture.
 */
#define VDNA_IMAGE_PIXELS_MAX 67108864u

/** One picture. Nothing in it is trusted: the decoder checks every field. */
typedef struct vdna_image {
    const uint8_t *data;  /**< borrowed */
    size_t size;          /**< bytes of data */
    uint32_t width;       /**< pixels; 0 for VDNA_PIXEL_ENCODED; for MJPG not used */
    uint32_t height;      /**< pixels; as width */
    uint32_t row_stride;  /**< bytes from row to row of the first plane; 0 = rows are packed */
    uint32_t pixelformat; /**< VDNA_PIXEL_... */
} vdna_image;

#endif
