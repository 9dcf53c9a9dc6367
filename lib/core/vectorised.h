/* VDNA_VECTORISED marks a function whose loop deserves wider vectors: it is compiled once more for
 * each of the wider x86-64 levels, and the loader picks the one that fits the processor. Results
 * are bit-identical. Private to lib/. */
#ifndef VDNA_CORE_VECTORISED_H
#define VDNA_CORE_VECTORISED_H

#include <string.h> /* defines __GLIBC__; other C libraries cannot load such functions */

/* Off for sanitizers and proofs, which want one version, and if the user has already chosen, by a
 * processor option or by -DVDNA_VECTORISED= */
#ifndef VDNA_VECTORISED
#if defined(__x86_64__) && defined(__GLIBC__) && !defined(__clang__) && __GNUC__ >= 12 && \
    defined(__OPTIMIZE__) && !defined(__AVX__) && !defined(__SANITIZE_ADDRESS__) &&       \
    !defined(__SANITIZE_THREAD__) && !defined(__FRAMAC__)
#define VDNA_VECTORISED \
    __attribute__((target_clones("default", "arch=x86-64-v3", "arch=x86-64-v4")))
/* The same for loops that need 32-bit products or byte shuffles, which x86-64-v2 brings. */
#define VDNA_VECTORISED_FROM_V2 \
    __attribute__((target_clones("default", "arch=x86-64-v2", "arch=x86-64-v3", "arch=x86-64-v4")))
#else
#define VDNA_VECTORISED
#endif
#endif
#ifndef VDNA_VECTORISED_FROM_V2
#define VDNA_VECTORISED_FROM_V2 VDNA_VECTORISED
#endif

/* Begin to fetch what is at an address, which must lie in an object. */
#ifdef __GNUC__
#define VDNA_FETCH(address) __builtin_prefetch(address)
#else
#define VDNA_FETCH(address) ((void)(address))
#endif

#endif
