/** @file vdna/picture.h
 *  @brief Pictures as cameras send them, decoded to 8-bit pixels.
 *
 *  vdna_backbone_run() decodes with the same code, in full or reduced as its manifest says, so this
 *  header gives the very pixels that a Visual DNA is made of. The same raw picture gives the same
 * pixels on every processor.
 */
#ifndef VDNA_PICTURE_H
#define VDNA_PICTURE_H

#include <vdna/image.h>
#include <vdna/pixels.h>
#include <vdna/status.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Decodes one picture after the other into the same memory. One thread at a time. */
typedef struct vdna_decoder vdna_decoder;

/** Open a decoder. It allocates its memory for pixels now and none later; that memory is not
 *  resident before a picture needs it. libjpeg allocates and frees its own for each JPEG
 *  picture.
 *  @param max_pixels  largest width x height that is decoded, 1..VDNA_IMAGE_PIXELS_MAX
 *  @param error  filled on failure; NULL = not wanted
 *  @param out_decoder  the caller's, to be closed with vdna_decoder_close()
 *  @return VDNA_OK; VDNA_ERR_ARG; VDNA_ERR_NOMEM */
VDNA_API vdna_status vdna_decoder_open(uint32_t max_pixels, vdna_error *error,
                                       vdna_decoder **out_decoder);

/** Close; everything borrowed from it ends.
 *  @param decoder  NULL is allowed */
VDNA_API void vdna_decoder_close(vdna_decoder *decoder);

/** Upper bound of the memory that decoding one picture takes, pixels included, in any format.
 *  Progressive JPEG takes the most.
 *  @param max_pixels  as for vdna_decoder_open()
 *  @return bytes; 0 if max_pixels is out of its range */
VDNA_API uint64_t vdna_decoder_bytes_max(uint32_t max_pixels);

/** Decode one picture. docs/reference/pictures.md has the contract for all ways in: orientation,
 *  depth, transparency, colour. Rules that vdna/image.h leaves open:
 *   - rows may be padded; the last row of a packed format may end at its last pixel; rows of two
 *     bytes a channel in an 8-bit format are refused;
 *   - Y10, Y12, Y14 and Y16 are scaled to 8 bits; a value of more bits than that is refused, and
 *     Y16 whose values use 14 bits at most, unless it is black;
 *   - 4:2:2 formats have an even width; 4:2:0 formats have whole rows and even width, height and
 *     row_stride, and the chroma rows of I420 have half of that stride;
 *   - YUV is BT.601 with 16..235, as cameras give it; JPEG is full range;
 *   - VDNA_PIXEL_ENCODED must hold a JPEG picture, as VDNA_PIXEL_MJPG does;
 *   - a JPEG picture is decoded completely or refused;
 *   - a JPEG picture is turned as its EXIF says, in either format; a damaged EXIF block says
 *     nothing. One in CMYK is refused.
 *  @param decoder  an open one
 *  @param image  any content; checked in full before a byte of it is used
 *  @param error  filled on failure; NULL = not wanted
 *  @param out_pixels  borrowed until the next call with this decoder, and from image->data for
 *                     formats that need no conversion
 *  @return VDNA_OK; VDNA_ERR_ARG; VDNA_ERR_FORMAT if the picture is damaged or its fields
 *          contradict one another; VDNA_ERR_UNSUPPORTED for an unknown pixel format, an encoded
 *          picture that is no JPEG or is one in CMYK, 16 bits that are not used, or one with too
 *          many pixels; VDNA_ERR_NOMEM */
VDNA_API vdna_status vdna_decoder_decode(vdna_decoder *decoder, const vdna_image *image,
                                         vdna_error *error, vdna_pixels *out_pixels);

/** Decode one picture that will be resized. A JPEG picture is decoded with its sides divided by the
 *  greatest of 8, 4, 2 and 1 that leaves both at least as long as asked, rounded up: its blocks of
 *  8x8 pixels are made from their low frequencies only, which takes less time and gives slightly
 *  other pixels than resizing all of them. All else is as with vdna_decoder_decode(), limits and
 *  memory included, and so are other formats.
 *  @param decoder  an open one
 *  @param image  as for vdna_decoder_decode()
 *  @param least_width  of the picture after its turn, pixels
 *  @param least_height  of the picture after its turn, pixels
 *  @param error  filled on failure; NULL = not wanted
 *  @param out_pixels  as from vdna_decoder_decode()
 *  @return as vdna_decoder_decode() */
VDNA_API vdna_status vdna_decoder_decode_reduced(vdna_decoder *decoder, const vdna_image *image,
                                                 uint32_t least_width, uint32_t least_height,
                                                 vdna_error *error, vdna_pixels *out_pixels);

/** Mean grey level of a whole picture (BT.601).
 *  @param pixels  as vdna_decoder_decode() fills them
 *  @return 0..255; 0 for NULL */
VDNA_API float vdna_pixels_mean_grey(const vdna_pixels *pixels);

#ifdef __cplusplus
}
#endif

#endif
