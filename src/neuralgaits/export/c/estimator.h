/*
 * What is not measured: joint rates, the pitch's rate and the hip's velocity, from joint angles,
 * pitch and contact. Call ng_estimator_start after ng_start, then ng_estimate between ng_measure
 * and ng_step. A robot whose rates and base velocity are measured well needs none of this.
 */
#ifndef NG_ESTIMATOR_H
#define NG_ESTIMATOR_H

#include "controller.h"

/* What is remembered from tick to tick. */
typedef struct {
    int started;                                   /* 0 before the first reading */
    ng_measurement estimate;                       /* after the last one */
    ng_real accelerations[NG_LEGS][NG_LEG_JOINTS]; /* [rad/s^2] */
} ng_estimator;

void ng_estimator_start(ng_estimator *estimator);

/*
 * Put estimates in the place of the rates and the hip's velocity of a reading, and smooth its
 * angles. The first reading is taken as it is: zero rates for a robot at rest. `state` is that of
 * the controller before its tick.
 */
void ng_estimate(ng_estimator *estimator, const ng_state *state, ng_measurement *reading);

#endif
