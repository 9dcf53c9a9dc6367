/* A recall R, 0..1, as the angle asin(sqrt(R)), and back, with the same bits on every machine.
 * Within 1e-15 of the exact value. Private to lib/trust. */
#ifndef VDNA_TRUST_RECALL_ANGLE_H
#define VDNA_TRUST_RECALL_ANGLE_H

#include "elementary.h"

#define VDNA_HALF_PI 0x1.921fb54442d18p0

/* @return the angle whose squared sine is `square`, 0..0.5 */
static inline double vdna_small_angle(double square)
{
    /* The squared sine of half the angle is at most 0.15, so that the series is short. */
    const double half = square / (2 * (1 + vdna_sqrt(1 - square)));
    double sum = 1;
    for (int n = 24; n > 0; n--)
        sum = 1 + sum * half * (2 * n - 1) * (2 * n - 1) / (2.0 * n * (2 * n + 1));
    return 2 * sum * vdna_sqrt(half);
}

/* @param recall  clipped to 0..1; below 1e-300 it counts as 0 */
static inline double vdna_recall_angle(double recall)
{
    if (!(recall > 1e-300))
        return 0;
    if (recall >= 1)
        return VDNA_HALF_PI;
    return recall <= 0.5 ? vdna_small_angle(recall) : VDNA_HALF_PI - vdna_small_angle(1 - recall);
}

/* @param angle  clipped to 0..pi/2 */
static inline double vdna_angle_recall(double angle)
{
    if (angle >= VDNA_HALF_PI)
        return 1;
    angle = angle > 0 ? angle : 0;
    double sum = 1;
    for (int k = 23; k > 1; k -= 2)
        sum = 1 - sum * angle * angle / (k * (k - 1));
    return angle * sum * (angle * sum);
}

/* @return log, that of numbers below 1e-6 being that of 1e-6 */
static inline double vdna_ln(double x)
{
    return vdna_log(x > 1e-6 ? x : 1e-6);
}

#endif
