#include <string.h>

#include "crc32c.h"

#if defined(__GNUC__) && defined(__x86_64__)
#include <nmmintrin.h>

#define HAS_INSTRUCTION __attribute__((target("sse4.2")))

static int has_instruction(void)
{
    return __builtin_cpu_supports("sse4.2");
}

HAS_INSTRUCTION static uint32_t add_word(uint32_t x, uint64_t word)
{
    return (uint32_t)_mm_crc32_u64(x, word);
}

HAS_INSTRUCTION static uint32_t add_byte(uint32_t x, unsigned char byte)
{
    return _mm_crc32_u8(x, byte);
}

#elif defined(__GNUC__) && defined(__AARCH64EL__) && defined(__linux__)
#include <arm_acle.h>
#include <sys/auxv.h>

#define HAS_INSTRUCTION __attribute__((target("+crc")))

static int has_instruction(void)
{
    return (getauxval(AT_HWCAP) & HWCAP_CRC32) != 0;
}

HAS_INSTRUCTION static uint32_t add_word(uint32_t x, uint64_t word)
{
    return __crc32cd(x, word);
}

HAS_INSTRUCTION static uint32_t add_byte(uint32_t x, unsigned char byte)
{
    return __crc32cb(x, byte);
}
#endif

#ifdef HAS_INSTRUCTION

/* Bytes of a stream. Each instruction waits for the one before it, but a processor keeps three in
 * flight, so three streams are read side by side. */
#define STREAM ((size_t)4096)

/* A register with only bit 0, 1 ... 31 set, after STREAM zero bytes: 8 * STREAM single steps
 * x -> x >> 1 ^ (x & 1 ? 0x82f63b78 : 0). */
static const uint32_t behind_stream[32] = {
    0xc2a5b65eu, 0x80a71a4du, 0x04a2426bu, 0x094484d6u, 0x128909acu, 0x25121358u, 0x4a2426b0u,
    0x94484d60u, 0x2d7cec31u, 0x5af9d862u, 0xb5f3b0c4u, 0x6e0b1779u, 0xdc162ef2u, 0xbdc02b15u,
    0x7e6c20dbu, 0xfcd841b6u, 0xfc5cf59du, 0xfd559dcbu, 0xff474d67u, 0xfb62ec3fu, 0xf329ae8fu,
    0xe3bf2befu, 0xc292212fu, 0x80c834afu, 0x047c1fafu, 0x08f83f5eu, 0x11f07ebcu, 0x23e0fd78u,
    0x47c1faf0u, 0x8f83f5e0u, 0x1aeb9d31u, 0x35d73a62u};

/* The register after STREAM more zero bytes: a linear function of its bits. */
static uint32_t skip_stream(uint32_t x)
{
    uint32_t behind = 0;
    for (int bit = 0; bit < 32; bit++)
        behind ^= behind_stream[bit] & (0u - (x >> bit & 1u));
    return behind;
}

static uint64_t word_at(const unsigned char *bytes)
{
    uint64_t word;
    memcpy(&word, bytes, sizeof word);
    return word;
}

HAS_INSTRUCTION static uint32_t add_three_streams(uint32_t x, const unsigned char *at)
{
    uint32_t y = 0, z = 0;
    for (size_t i = 0; i < STREAM; i += 8) {
        x = add_word(x, word_at(at + i));
        y = add_word(y, word_at(at + STREAM + i));
        z = add_word(z, word_at(at + 2 * STREAM + i));
    }
    return skip_stream(skip_stream(x) ^ y) ^ z;
}

HAS_INSTRUCTION static uint32_t add_bytes(uint32_t x, const unsigned char *at, size_t size)
{
    for (; size >= 3 * STREAM; size -= 3 * STREAM, at += 3 * STREAM)
        x = add_three_streams(x, at);
    for (; size >= 8; size -= 8, at += 8)
        x = add_word(x, word_at(at));
    for (; size > 0; size--, at++)
        x = add_byte(x, *at);
    return x;
}

int vdna_crc32c_by_instruction(uint32_t *crc, const void *bytes, size_t size)
{
    if (!has_instruction())
        return 0;
    *crc = ~add_bytes(~*crc, bytes, size);
    return 1;
}

#else

int vdna_crc32c_by_instruction(uint32_t *crc, const void *bytes, size_t size)
{
    (void)crc, (void)bytes, (void)size;
    return 0;
}

#endif
