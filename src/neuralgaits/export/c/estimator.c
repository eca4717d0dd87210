/* See estimator.h. Source of the mathematics: neuralgaits.control.estimator, repeated here. */
#include "estimator.h"

void ng_estimator_start(ng_estimator *estimator)
{
    const ng_estimator fresh = {0};
    *estimator = fresh;
}

/* Momentum about the contact of the foot that stands now, one period later. */
static ng_real momentum_ahead(const ng_measurement *last, int leg, ng_real ankle, const ng_real *lean)
{
    ng_real q[NG_COORDINATES], dq[NG_COORDINATES], moment, momentum;
    ng_coordinates(last->pitch, last->angles, leg, q);
    ng_coordinates(last->dpitch, last->rates, leg, dq);
    (void)lean;
    ng_contact_momentum(dq, last->hip_velocity, NG_BELIEVED(lean) q, &moment, &momentum);
    return momentum + NG_PERIOD * (moment + ankle);
}

/* Follow the joint angles. */
static void follow_joints(ng_estimator *estimator, const ng_real gains[3],
                          const ng_measurement *reading)
{
    ng_measurement *now = &estimator->estimate;
    for (int leg = 0; leg < NG_LEGS; ++leg) {
        for (int i = 0; i < NG_LEG_JOINTS; ++i) {
            const ng_real pull = estimator->accelerations[leg][i], rate = now->rates[leg][i];
            const ng_real angle = now->angles[leg][i] +
                                  NG_PERIOD * (rate + NG(0.5) * NG_PERIOD * pull);
            const ng_real error = reading->angles[leg][i] - angle;
            now->angles[leg][i] = angle + gains[0] * error;
            now->rates[leg][i] = rate + NG_PERIOD * pull + gains[1] * error;
            estimator->accelerations[leg][i] = pull + gains[2] * error;
        }
    }
}

/* Rates of all links from the momentum, and with them the hip's velocity. */
static void stand(ng_measurement *now, int leg, ng_real momentum, ng_real extra,
                  const ng_real *lean)
{
    ng_real q[NG_COORDINATES], rates[NG_COORDINATES], dq[NG_COORDINATES];
    const ng_measurement *seen = now;
    ng_coordinates(seen->pitch, seen->angles, leg, q);
    ng_coordinates(NG(0.0), seen->rates, leg, rates);
    (void)lean;
    ng_standing_rates(rates + 1, &extra, NG_BELIEVED(lean) &momentum, q, dq, now->hip_velocity);
    now->dpitch = dq[0];
    for (int i = 1; i < NG_COORDINATES; ++i) {
        now->dpitch += ng_pitch_row[leg][i] * dq[i];
    }
}

/* Whether a number that is followed is none: following it would never end. */
static int is_no_number(const ng_measurement *reading)
{
    int finite = ng_finite(reading->pitch);
    for (int leg = 0; leg < NG_LEGS; ++leg) {
        for (int i = 0; i < NG_LEG_JOINTS; ++i) {
            finite &= ng_finite(reading->angles[leg][i]);
        }
    }
    return !finite;
}

/* The rates of the last tick beside angles that the controller refuses. */
static void keep_rates(const ng_measurement *last, ng_measurement *reading)
{
    reading->dpitch = last->dpitch;
    reading->hip_velocity[0] = last->hip_velocity[0];
    reading->hip_velocity[1] = last->hip_velocity[1];
    for (int leg = 0; leg < NG_LEGS; ++leg) {
        for (int i = 0; i < NG_LEG_JOINTS; ++i) {
            reading->rates[leg][i] = last->rates[leg][i];
        }
    }
}

void ng_estimate(ng_estimator *estimator, const ng_state *state, ng_measurement *reading)
{
    ng_measurement *now = &estimator->estimate;
    if (is_no_number(reading)) {
        keep_rates(now, reading);
        return;
    }
    if (!estimator->started) {
        estimator->started = 1;
        *now = *reading;
        return;
    }
    const int quick = state->since_touchdown < NG_QUICK;
#if NG_LEAN_COMMAND
    const ng_real *lean = &state->after[NG_LEAN_COMMAND - 1];
#else
    const ng_real *lean = 0;
#endif
    const ng_real momentum = momentum_ahead(now, state->leg, state->ankle, lean);
    const ng_real pitch = now->pitch + NG_PERIOD * now->dpitch;
    const ng_real missed = reading->pitch - pitch;
    follow_joints(estimator, ng_joint_gain[quick], reading);
    now->pitch = pitch + ng_pitch_gain[0] * missed;
    stand(now, state->leg, momentum, ng_pitch_gain[1] * missed, lean);
    now->time_us = reading->time_us;
    for (int leg = 0; leg < NG_LEGS; ++leg) {
        now->normal_force[leg] = reading->normal_force[leg];
    }
    *reading = *now;
}
