/* A recall R, 0..1, as the angle asin(sqrt(R)), and back, with the same bits on every machine.
 * Within 2e-15 of the exact value. Private to lib/trust. */
#ifndef VDNA_TRUST_RECALL_ANGLE_H
#define VDNA_TRUST_RECALL_ANGLE_H

#define VDNA_HALF_PI 0x1.921fb54442d18p0

/* @param recall  clipped to 0..1; below 1e-300 it counts as 0 */
double vdna_recall_angle(double recall);

/* @param angle  clipped to 0..pi/2 */
double vdna_angle_recall(double angle);

/* @return log, that of numbers below 1e-6 being that of 1e-6 */
double vdna_ln(double x);

#endif
