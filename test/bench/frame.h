/* A network, and what pictures go through before it, for Python to call through ctypes (ours.py).
 */
#ifndef VDNA_BENCH_FRAME_H
#define VDNA_BENCH_FRAME_H

#include <vdna/backbone.h>
#include <vdna/health.h>
#include <vdna/picture.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Open the network of a manifest; as vdna_backbone_open(). */
VDNA_API vdna_status bench_backbone_open(const char *manifest, uint32_t threads, vdna_error *error,
                                         vdna_backbone **out_backbone);

/** Run one picture with packed rows.
 *  @param out_us  microseconds of decoding, resizing and inference */
VDNA_API vdna_status bench_backbone_run(vdna_backbone *backbone, const uint8_t *data, size_t size,
                                        uint32_t width, uint32_t height, uint32_t pixelformat,
                                        vdna_error *error, uint32_t out_us[3]);

/** Open a decoder of pictures, with VDNA_IMAGE_PIXELS_MAX. */
VDNA_API vdna_status bench_decoder_open(vdna_decoder **out_decoder);

/** Decode a JPEG. */
VDNA_API vdna_status bench_decode(vdna_decoder *decoder, const uint8_t *data, size_t size);

/** Decodes, resizes and normalises one JPEG after the other. */
typedef struct bench_preparation bench_preparation;

/** Prepare pictures for a network whose input has sides of `side` pixels, by area.
 *  @param reduced  1 = decode no larger than needed, 0 = in full
 *  @return never closed; NULL if memory is short */
VDNA_API bench_preparation *bench_preparation_open(uint32_t side, uint32_t reduced);

/** Prepare a JPEG. */
VDNA_API vdna_status bench_prepare(bench_preparation *preparation, const uint8_t *data,
                                   size_t size);

/** Measure and judge a picture of packed RGB by itself. */
VDNA_API vdna_status bench_health(const uint8_t *rgb, uint32_t width, uint32_t height);

#ifdef __cplusplus
}
#endif

#endif
