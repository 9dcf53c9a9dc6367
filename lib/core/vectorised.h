/* VDNA_VECTORISED before a function: where a loop is worth it, compile it once more for each of the
 * wider vectors of x86-64; the loader picks those that the processor has. The results are the same
 * bits. Private to lib/. */
#ifndef VDNA_CORE_VECTORISED_H
#define VDNA_CORE_VECTORISED_H

#include <string.h> /* defines __GLIBC__ where there is one; others cannot load such functions */

/* Not where sanitizers or proofs look at the one text, nor where the user has already chosen: by
 * the processor, or by -DVDNA_VECTORISED= */
#ifndef VDNA_VECTORISED
#if defined(__x86_64__) && defined(__GLIBC__) && !defined(__clang__) && __GNUC__ >= 12 && \
    defined(__OPTIMIZE__) && !defined(__AVX__) && !defined(__SANITIZE_ADDRESS__) &&       \
    !defined(__FRAMAC__)
#define VDNA_VECTORISED \
    __attribute__((target_clones("default", "arch=x86-64-v3", "arch=x86-64-v4")))
/* The same for loops that need products of 32 bits or shuffles of bytes, which x86-64-v2 brings. */
#define VDNA_VECTORISED_FROM_V2 \
    __attribute__((target_clones("default", "arch=x86-64-v2", "arch=x86-64-v3", "arch=x86-64-v4")))
#else
#define VDNA_VECTORISED
#endif
#endif
#ifndef VDNA_VECTORISED_FROM_V2
#define VDNA_VECTORISED_FROM_V2 VDNA_VECTORISED
#endif

#endif
