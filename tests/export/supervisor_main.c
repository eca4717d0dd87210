/* Invariants of the supervisor at random readings and requests: see test_supervisor.py. */
#include "supervisor_readings.h"

#include <stdio.h>

static double size_of(double value) { return value < 0.0 ? -value : value; }
static void worse(double *worst, double value)
{
    if (!(size_of(value) <= *worst)) {
        *worst = size_of(value);
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
        draw_readings(&encoders, tick);
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
