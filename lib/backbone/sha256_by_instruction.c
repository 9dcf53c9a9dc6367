#include <string.h>

#include "sha256.h"

/* The round constants. Both kinds of processors take four words of the message at a time. */
#define GROUPS 16
static const uint32_t constants[4 * GROUPS] = {
    0x428a2f98, 0x71374491, 0xb5c0fbcf, 0xe9b5dba5, 0x3956c25b, 0x59f111f1, 0x923f82a4, 0xab1c5ed5,
    0xd807aa98, 0x12835b01, 0x243185be, 0x550c7dc3, 0x72be5d74, 0x80deb1fe, 0x9bdc06a7, 0xc19bf174,
    0xe49b69c1, 0xefbe4786, 0x0fc19dc6, 0x240ca1cc, 0x2de92c6f, 0x4a7484aa, 0x5cb0a9dc, 0x76f988da,
    0x983e5152, 0xa831c66d, 0xb00327c8, 0xbf597fc7, 0xc6e00bf3, 0xd5a79147, 0x06ca6351, 0x14292967,
    0x27b70a85, 0x2e1b2138, 0x4d2c6dfc, 0x53380d13, 0x650a7354, 0x766a0abb, 0x81c2c92e, 0x92722c85,
    0xa2bfe8a1, 0xa81a664b, 0xc24b8b70, 0xc76c51a3, 0xd192e819, 0xd6990624, 0xf40e3585, 0x106aa070,
    0x19a4c116, 0x1e376c08, 0x2748774c, 0x34b0bcb5, 0x391c0cb3, 0x4ed8aa4a, 0x5b9cca4f, 0x682e6ff3,
    0x748f82ee, 0x78a5636f, 0x84c87814, 0x8cc70208, 0x90befffa, 0xa4506ceb, 0xbef9a3f7, 0xc67178f2};

#if defined(__GNUC__) && defined(__x86_64__)
#include <cpuid.h>
#include <immintrin.h>

#define HAS_INSTRUCTION __attribute__((target("sha,sse4.1")))

static int has_instruction(void)
{
    unsigned eax, ebx = 0, ecx, edx;
    return __builtin_cpu_supports("sse4.1") && __get_cpuid_count(7, 0, &eax, &ebx, &ecx, &edx) &&
           (ebx & bit_SHA) != 0;
}

/* The next four words of the message, from the sixteen before them. */
HAS_INSTRUCTION static __m128i extend(const __m128i w[4], size_t g)
{
    const __m128i oldest = w[g % 4], newest = w[(g + 3) % 4];
    const __m128i part = _mm_add_epi32(_mm_sha256msg1_epu32(oldest, w[(g + 1) % 4]),
                                       _mm_alignr_epi8(newest, w[(g + 2) % 4], 4));
    return _mm_sha256msg2_epu32(part, newest);
}

HAS_INSTRUCTION static void add_blocks(uint32_t state[8], const uint8_t *blocks, size_t count)
{
    const __m128i big_endian = _mm_set_epi8(12, 13, 14, 15, 8, 9, 10, 11, 4, 5, 6, 7, 0, 1, 2, 3);
    __m128i abef = _mm_set_epi32((int)state[0], (int)state[1], (int)state[4], (int)state[5]);
    __m128i cdgh = _mm_set_epi32((int)state[2], (int)state[3], (int)state[6], (int)state[7]);
    for (; count > 0; count--, blocks += VDNA_SHA256_BLOCK) {
        const __m128i abef_before = abef, cdgh_before = cdgh;
        __m128i w[4];
        for (size_t g = 0; g < GROUPS; g++) {
            w[g % 4] = g < 4
                           ? _mm_shuffle_epi8(
                                 _mm_loadu_si128((const __m128i *)(const void *)(blocks + 16 * g)),
                                 big_endian)
                           : extend(w, g);
            /* Two rounds for the lower half of the words, two for the upper. */
            const __m128i sum = _mm_add_epi32(
                w[g % 4], _mm_loadu_si128((const __m128i *)(const void *)(constants + 4 * g)));
            cdgh = _mm_sha256rnds2_epu32(cdgh, abef, sum);
            abef = _mm_sha256rnds2_epu32(abef, cdgh, _mm_shuffle_epi32(sum, 0x0E));
        }
        abef = _mm_add_epi32(abef, abef_before);
        cdgh = _mm_add_epi32(cdgh, cdgh_before);
    }
    uint32_t low[4], high[4];
    memcpy(low, &abef, sizeof low);
    memcpy(high, &cdgh, sizeof high);
    const uint32_t after[8] = {low[3], low[2], high[3], high[2], low[1], low[0], high[1], high[0]};
    memcpy(state, after, sizeof after);
}

#elif defined(__GNUC__) && defined(__AARCH64EL__) && defined(__linux__)
#include <arm_neon.h>
#include <sys/auxv.h>

#define HAS_INSTRUCTION __attribute__((target("+crypto")))

static int has_instruction(void)
{
    return (getauxval(AT_HWCAP) & HWCAP_SHA2) != 0;
}

HAS_INSTRUCTION static void add_blocks(uint32_t state[8], const uint8_t *blocks, size_t count)
{
    uint32x4_t abcd = vld1q_u32(state), efgh = vld1q_u32(state + 4);
    for (; count > 0; count--, blocks += VDNA_SHA256_BLOCK) {
        const uint32x4_t abcd_before = abcd, efgh_before = efgh;
        uint32x4_t w[4];
        for (size_t g = 0; g < GROUPS; g++) {
            w[g % 4] = g < 4 ? vreinterpretq_u32_u8(vrev32q_u8(vld1q_u8(blocks + 16 * g)))
                             : vsha256su1q_u32(vsha256su0q_u32(w[g % 4], w[(g + 1) % 4]),
                                               w[(g + 2) % 4], w[(g + 3) % 4]);
            const uint32x4_t sum = vaddq_u32(w[g % 4], vld1q_u32(constants + 4 * g));
            const uint32x4_t abcd_now = abcd;
            abcd = vsha256hq_u32(abcd, efgh, sum);
            efgh = vsha256h2q_u32(efgh, abcd_now, sum);
        }
        abcd = vaddq_u32(abcd, abcd_before);
        efgh = vaddq_u32(efgh, efgh_before);
    }
    vst1q_u32(state, abcd);
    vst1q_u32(state + 4, efgh);
}
#endif

#ifdef HAS_INSTRUCTION

/* see sha256.h */
int vdna_sha256_by_instruction(uint32_t state[8], const uint8_t *blocks, size_t count)
{
    if (!has_instruction())
        return 0;
    add_blocks(state, blocks, count);
    return 1;
}

#else

/* see sha256.h */
int vdna_sha256_by_instruction(uint32_t state[8], const uint8_t *blocks, size_t count)
{
    (void)state, (void)blocks, (void)count, (void)constants;
    return 0;
}

#endif
