#include "span.h"

static uint32_t greatest_common_divisor(uint32_t a, uint32_t b)
{
    while (b != 0) {
        const uint32_t rest = a % b;
        a = b;
        b = rest;
    }
    return a;
}

/* see span.h */
vdna_span vdna_span_from(const uint32_t *mass_p, const uint32_t *mass_q, size_t neurons,
                         size_t first)
{
    const uint32_t here_p = mass_p[first], here_q = mass_q[first];
    size_t end = first + 1;
    while (end < neurons && mass_p[end] == here_p && mass_q[end] == here_q)
        end++;
    const uint32_t divisor = greatest_common_divisor(here_p, here_q);
    const vdna_span s = {first, end - first, here_q / divisor, here_p / divisor,
                         (uint64_t)here_p * (here_q / divisor)};
    return s;
}

/* Integers up to here convert to double without rounding. */
#define EXACT_DOUBLES ((uint64_t)1 << 53)

/* sum / mass, rounded to nearest. Long division gives 55 bits, the last of which is sticky, so that
 * only the conversion to double rounds. mass is below 2^63. */
static double long_quotient(uint64_t sum, uint64_t mass)
{
    uint64_t whole = sum / mass, rest = sum % mass;
    double unit = 1;
    for (; whole < 2 * EXACT_DOUBLES; unit /= 2) { /* NOLINT(cert-flp30-c): always exact */
        const uint64_t bit = 2 * rest >= mass;
        whole = 2 * whole + bit;
        rest = 2 * rest - bit * mass;
    }
    return (double)(whole | (rest != 0)) * unit;
}

/* see span.h */
double vdna_quotient(uint64_t sum, uint64_t mass)
{
    if (sum == 0 || (sum < EXACT_DOUBLES && mass < EXACT_DOUBLES))
        return (double)sum / (double)mass;
    return long_quotient(sum, mass);
}
