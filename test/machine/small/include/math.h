/* All that lib/core and lib/select may use of <math.h>: macros, no function; see machine.py. */
#ifndef MATH_H
#define MATH_H

#define INFINITY __builtin_inff()
#define isfinite(x) __builtin_isfinite(x)

#endif
