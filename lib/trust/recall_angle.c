#include "recall_angle.h"

#include "elementary.h"

/* @return the angle whose squared sine is `square`, 0..0.5 */
static double small_angle(double square)
{
    /* The squared sine of half the angle is at most 0.15, so that the series is short. */
    const double half = square / (2 * (1 + vdna_sqrt(1 - square)));
    double sum = 1;
    for (int n = 24; n > 0; n--)
        sum = 1 + sum * half * (2 * n - 1) * (2 * n - 1) / (2.0 * n * (2 * n + 1));
    return 2 * sum * vdna_sqrt(half);
}

/* see recall_angle.h */
double vdna_recall_angle(double recall)
{
    if (!(recall > 1e-300))
        return 0;
    if (recall >= 1)
        return VDNA_HALF_PI;
    return recall <= 0.5 ? small_angle(recall) : VDNA_HALF_PI - small_angle(1 - recall);
}

/* see recall_angle.h */
double vdna_angle_recall(double angle)
{
    if (angle >= VDNA_HALF_PI)
        return 1;
    angle = angle > 0 ? angle : 0;
    double sum = 1;
    for (int k = 23; k > 1; k -= 2)
        sum = 1 - sum * angle * angle / (k * (k - 1));
    return angle * sum * (angle * sum);
}

/* see recall_angle.h */
double vdna_ln(double x)
{
    return vdna_log(x > 1e-6 ? x : 1e-6);
}
