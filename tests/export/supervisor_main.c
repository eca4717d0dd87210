/* Invariants of the supervisor at random readings and requests: see test_supervisor.py. */
#include "supervisor.h"

#include <stdio.h>
#include <stdlib.h>

static double drawn(void) { return 2.0 * rand() / RAND_MAX - 1.0; }
static double size_of(double value) { return value < 0.0 ? -value : value; }
static void worse(double *worst, double value)
{
    if (!(size_of(value) <= *worst)) {
        *worst = size_of(value);
    }
}

/*
 * Every 4000 ticks a robot that stands, leans forward, jumps from foot to foot, and stands; in some
 * it does so wildly. Twice in 20000 ticks a sensor is broken.
 */
static void draw(ng_encoders *encoders, int tick)
{
    static const ng_encoders nothing;
    const int at = tick % 4000, jumping = at >= 2000 && at < 3200;
    const double wild = tick / 4000 % 5 == 3 ? 0.2 : 0.002;
    const int front = jumping ? at / 150 % 2 : at >= 3200;
    int knot = at < 1500 ? 0 : (at - 1500) / 40;
    knot = jumping || knot >= NG_STAND_KNOTS ? NG_STAND_KNOTS - 1 : knot;
    knot = at >= 3300 ? 0 : knot;
    ng_real by_leg[NG_LEGS][NG_LEG_JOINTS];
    const uint32_t last = encoders->time_us;
    *encoders = nothing;
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
        encoders->joints[0][0] = (ng_real)(0.0 / (tick - tick));
    } else if (tick % 20000 == 18999) {
        encoders->djoints[1][0] = NG(1.0e6);
    }
}

/* Whether a mode may follow another one; one that tips over at once stays where it was. */
static int allowed(const ng_supervision *now)
{
    if (now->mode == NG_DAMP && now->reason == NG_TIPPED_OVER) {
        return 1;
    }
    static const int ways[4][4] = {{1, 1, 1, 0}, {1, 1, 1, 1}, {1, 1, 1, 1}, {1, 1, 0, 1}};
    return ways[now->before][now->mode] &&
           (now->before != now->mode) == (now->reason != NG_NO_CHANGE);
}

/*
 * Counts: ticks of each mode, faults, changes that are none. Largest: torque over its limit, change
 * over its rate [shares], targets at the reading against the torque, damping against -kd rate [N m].
 */
int main(void)
{
    const ng_supervisor_config config = ng_supervisor_config_of(&ng_laws[0]);
    int modes[4] = {0, 0, 0, 0}, faults = 0, wrong = 0, latched = 0;
    double over[4] = {0.0, 0.0, 0.0, 0.0};
    ng_supervisor own;
    ng_encoders encoders = {0};
    ng_real before[NG_LEGS][NG_LEG_JOINTS] = {{0}};
    ng_real limits[NG_LEGS][NG_LEG_JOINTS];
    const ng_real change = config.walk.torque_rate * NG_PERIOD;
    ng_by_legs(config.walk.torque_limit, NG(0.0), 0, limits);
    ng_supervisor_start(&own);
    for (int tick = 0; tick < 200000; ++tick) {
        ng_measurement reading;
        ng_supervision now;
        draw(&encoders, tick);
        ng_measure(&encoders, &reading);
        const int at = tick % 4000, walk = at >= 1200 && at < 2800;
        const int request = at == 3999 || at == 600 * (tick / 4000 % 9) ? 0 : 1 + walk;
        ng_supervise(&config, &own, &reading, (ng_request)request, &now);
        modes[now.mode] += 1;
        faults += now.fault_is_new;
        wrong += !allowed(&now) || (latched && (now.mode != NG_DAMP || now.fault_is_new));
        latched = now.fault != NG_NO_FAULT;
        for (int leg = 0; leg < NG_LEGS; ++leg) {
            for (int i = NG_ANKLES; i < NG_LEG_JOINTS; ++i) {
                const ng_target *to = &own.targets[leg][i];
                const double torque = now.command.torque[leg][i];
                const double given = to->tau_ff + to->kp * (to->q_des - encoders.joints[leg][i]) +
                                     to->kd * (to->dq_des - encoders.djoints[leg][i]);
                const double damping = -to->kd * reading.rates[leg][i];
                worse(&over[0], size_of(torque) / size_of(limits[leg][i]));
                worse(&over[1], (torque - before[leg][i]) / change);
                if (now.mode != NG_DAMP) {
                    worse(&over[2], given - ng_joint_sign[leg][i] * torque);
                } else if (now.before == NG_DAMP && size_of(damping) < 1.0 &&
                           size_of(before[leg][i]) < 1.0) {
                    worse(&over[3], torque - damping);
                }
                before[leg][i] = now.command.torque[leg][i];
            }
        }
        if (tick % 10000 == 0) {
            ng_supervisor_start(&own);
            latched = 0;
            for (int i = 0; i < NG_LEGS * NG_LEG_JOINTS; ++i) {
                before[i / NG_LEG_JOINTS][i % NG_LEG_JOINTS] = NG(0.0);
            }
        }
    }
    printf("%d %d %d %d %d %d %.17g %.17g %g %g\n", modes[0], modes[1], modes[2], modes[3], faults,
           wrong, over[0], over[1], over[2], over[3]);
    return 0;
}
