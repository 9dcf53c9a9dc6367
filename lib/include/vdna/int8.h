/** @file vdna/int8.h
 *  @brief A row of numbers as 8-bit codes with one scale: a quarter of the memory.
 *
 *  Definition: the scale is the largest magnitude of the row divided by 127, rounded to float, and
 *  down where 127 times the scale would otherwise be infinite. The code of a number is the number
 *  divided by the scale, in double precision, rounded to the nearest whole number (halves away from
 *  zero) and kept within -127..127; in a row of zeros, or of numbers too small to have a scale, all
 *  are 0. A code stands for itself times the scale, rounded to float: within half a scale of the
 *  number, and the bits are the same on every machine.
 */
#ifndef VDNA_INT8_H
#define VDNA_INT8_H

#include <stddef.h>

#include <vdna/status.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Encode a row.
 *  @param values     [count]
 *  @param count      >= 1
 *  @param out_codes  [count]
 *  @param out_scale  >= 0
 *  @return VDNA_OK; VDNA_ERR_ARG; VDNA_ERR_NONFINITE for a NaN or an infinity */
VDNA_API vdna_status vdna_int8_encode(const float *values, size_t count, int8_t *out_codes,
                                      float *out_scale);

/** Decode a row.
 *  @param codes       [count]
 *  @param count       >= 1
 *  @param scale       as encoded
 *  @param out_values  [count]
 *  @return VDNA_OK; VDNA_ERR_ARG */
VDNA_API vdna_status vdna_int8_decode(const int8_t *codes, size_t count, float scale,
                                      float *out_values);

#ifdef __cplusplus
}
#endif

#endif
