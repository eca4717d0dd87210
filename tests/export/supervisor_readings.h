/* Readings of a robot that stands, leans and walks, at random: for tests of the supervisor. */
#ifndef SUPERVISOR_READINGS_H
#define SUPERVISOR_READINGS_H

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "supervisor.h"

static inline double drawn(void) { return 2.0 * rand() / RAND_MAX - 1.0; }

/*
 * Every 4000 ticks a robot that stands, leans forward, jumps from foot to foot, and stands; in some
 * it does so wildly. Twice in 20000 ticks a sensor is broken.
 */
static inline void draw_readings(ng_encoders *encoders, int tick)
{
    const int at = tick % 4000, jumping = at >= 2000 && at < 3200;
    const double wild = tick / 4000 % 5 == 3 ? 0.2 : 0.002;
    const int front = jumping ? at / 150 % 2 : at >= 3200;
    int knot = at < 1500 ? 0 : (at - 1500) / 40;
    knot = jumping || knot >= NG_STAND_KNOTS ? NG_STAND_KNOTS - 1 : knot;
    knot = at >= 3300 ? 0 : knot;
    ng_real by_leg[NG_LEGS][NG_LEG_JOINTS];
    const uint32_t last = encoders->time_us;
    memset(encoders, 0, sizeof *encoders);
    encoders->time_us = last + 1000u;
    ng_by_legs(ng_stand_path[knot] + 1, ng_stand_path[knot][0], front, by_leg);
    encoders->pitch = NG_PITCH_SIGN * (wild * drawn() - NG_ROOT_ANGLE);
    encoders->base_velocity[0] = (ng_real)(at >= 1500 && at < 3200 ? 0.5 : 0.0);
    for (int leg = 0; leg < NG_LEGS; ++leg) {
        encoders->normal_force[leg] = (ng_real)(jumping && leg != front ? 0.0 : 100.0);
        for (int i = 0; i < NG_LEG_JOINTS; ++i) {
            encoders->joints[leg][i] = ng_joint_sign[leg][i] *
                                       (by_leg[leg][i] - ng_joint_offset[leg][i] + wild * drawn());
            encoders->djoints[leg][i] = (ng_real)(wild * drawn());
        }
    }
    if (tick % 20000 == 9999) {
        encoders->joints[0][0] = (ng_real)NAN;
    } else if (tick % 20000 == 18999) {
        encoders->djoints[1][0] = NG(1.0e6);
    }
}

#endif
