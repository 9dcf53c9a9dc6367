/* exp, log and sqrt of doubles with the same bits on every machine, which those of C libraries do
 * not have, and without a call, so that loops of them vectorise. Within 1e-15 of the exact value.
 * Private to the library. */
#ifndef VDNA_CORE_ELEMENTARY_H
#define VDNA_CORE_ELEMENTARY_H

#include <stdint.h>
#include <string.h>

/* log(2), of which the high part has room for exact products with exponents. */
#define VDNA_LN2_HIGH 0x1.62e42fefa38p-1
#define VDNA_LN2_LOW 0x1.ef35793c7673p-45

static inline uint64_t vdna_bits_of(double x)
{
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    return bits;
}

static inline double vdna_of_bits(uint64_t bits)
{
    double x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

/* @param x  clipped to -708..708, where the result is a normal number */
static inline double vdna_exp(double x)
{
    x = x < -708 ? -708 : x;
    x = x > 708 ? 708 : x;
    /* Adding 1.5 * 2^52 rounds to an integer n and leaves it in the lowest bits: x = n log(2) + r.
     */
    const double shift = 0x1.8p52, shifted = x * 0x1.71547652b82fep0 + shift;
    const double n = shifted - shift, r = (x - n * VDNA_LN2_HIGH) - n * VDNA_LN2_LOW;
    double sum = 1.0 / 6227020800;
    sum = sum * r + 1.0 / 479001600;
    sum = sum * r + 1.0 / 39916800;
    sum = sum * r + 1.0 / 3628800;
    sum = sum * r + 1.0 / 362880;
    sum = sum * r + 1.0 / 40320;
    sum = sum * r + 1.0 / 5040;
    sum = sum * r + 1.0 / 720;
    sum = sum * r + 1.0 / 120;
    sum = sum * r + 1.0 / 24;
    sum = sum * r + 1.0 / 6;
    sum = sum * r + 0.5;
    sum = sum * r + 1;
    sum = sum * r + 1;
    return vdna_of_bits(vdna_bits_of(sum) + (vdna_bits_of(shifted) << 52));
}

/* @param x  a normal number above 0 */
static inline double vdna_log(double x)
{
    /* x = m 2^exponent, m between sqrt(1/2) and sqrt(2): log(m) = 2 atanh((m - 1) / (m + 1)) */
    const uint64_t bits = vdna_bits_of(x), mantissa = bits & 0xfffffffffffff;
    const int is_upper = mantissa > 0x6a09e667f3bcc;
    const int exponent = (int)(bits >> 52) - 1023 + is_upper;
    const double m = vdna_of_bits(mantissa | (uint64_t)(1023 - is_upper) << 52);
    const double s = (m - 1) / (m + 1), square = s * s;
    double sum = 0;
    for (int odd = 23; odd > 1; odd -= 2)
        sum = (sum + 1.0 / odd) * square;
    return exponent * VDNA_LN2_HIGH + (2 * s * (1 + sum) + exponent * VDNA_LN2_LOW);
}

/* @param x  0, or a normal number above 0 */
static inline double vdna_sqrt(double x)
{
    if (x == 0)
        return 0;
    /* Half the exponent: within 4 %. Each step of Newton's squares the error. */
    double root = vdna_of_bits((vdna_bits_of(x) >> 1) + 0x1ff7a3bea91d9b1b);
    for (int step = 0; step < 5; step++)
        root = 0.5 * (root + x / root);
    return root;
}

#endif
