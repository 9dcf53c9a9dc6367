/* All that vdna.c uses of <math.h>, for a compiler without a C library: macros, no function. Put
 * this folder before the compiler's own: -isystem FOLDER. */
#ifndef MATH_H
#define MATH_H

#define INFINITY __builtin_inff()
#define NAN __builtin_nanf("")
#define isfinite(x) __builtin_isfinite(x)
#define isnan(x) __builtin_isnan(x)

#endif
