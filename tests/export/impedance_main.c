/* Targets of drives against the torques of a tick, at many readings: see test_impedance.py. */
#include "controller.h"

#include <stdio.h>
#include <stdlib.h>

static double drawn(void) { return 2.0 * rand() / RAND_MAX - 1.0; }
static void worse(double *worst, double value)
{
    const double size = value < 0.0 ? -value : value;
    if (!(size <= *worst)) {
        *worst = size;
    }
}

/* Largest differences: torque at the reading, torque beside it, outputs, after a fault. */
int main(void)
{
    const ng_real kp = 300.0, kd = 5.0;
    double worst[4] = {0.0, 0.0, 0.0, 0.0};
    int walked = 0;
    for (int n = 0; n < 2000; ++n) {
        const ng_config config = ng_config_of(&ng_laws[n % NG_LAW_COUNT]);
        ng_encoders encoders = {0};
        ng_measurement reading;
        ng_command command;
        ng_state state;
        ng_target targets[NG_LEGS][NG_LEG_JOINTS];
        ng_real by_leg[NG_LEGS][NG_LEG_JOINTS], q[NG_COORDINATES];
        for (int leg = 0; leg < NG_LEGS; ++leg) {
            encoders.normal_force[leg] = leg == n % 2 ? 100.0 : 0.0;
            for (int i = 0; i < NG_LEG_JOINTS; ++i) {
                const ng_real middle = ng_joint_sign[leg][i] * (0.1 - ng_joint_offset[leg][i]);
                encoders.joints[leg][i] = middle + 0.1 * drawn();
                encoders.djoints[leg][i] = drawn();
            }
        }
        encoders.pitch = NG_PITCH_SIGN * (0.05 * drawn() - NG_ROOT_ANGLE);
        if (n % 10 == 9) {
            encoders.joints[0][1] = 0.0 / (n - n);
        }
        ng_start(&state, n % 2);
        ng_measure(&encoders, &reading);
        ng_step(&config, &state, &reading, &command);
        ng_impedance(&reading, &command, kp, kd, targets);
        if (command.fault != NG_NO_FAULT) {
            for (int leg = 0; leg < NG_LEGS; ++leg) {
                for (int i = 0; i < NG_LEG_JOINTS; ++i) {
                    const ng_target *to = &targets[leg][i];
                    worse(&worst[3], to->q_des + to->dq_des + to->kp + to->tau_ff + to->kd - kd);
                }
            }
            continue;
        }
        walked += 1;
        for (int leg = 0; leg < NG_LEGS; ++leg) {
            for (int i = 0; i < NG_LEG_JOINTS; ++i) {
                const ng_target *to = &targets[leg][i];
                const double torque = ng_joint_sign[leg][i] * command.torque[leg][i];
                const double moved = 0.01 * drawn(), faster = 0.1 * drawn();
                const double angle = encoders.joints[leg][i], rate = encoders.djoints[leg][i];
                worse(&worst[0], to->tau_ff + to->kp * (to->q_des - angle) +
                                     to->kd * (to->dq_des - rate) - torque);
                worse(&worst[1], to->tau_ff + to->kp * (to->q_des - angle - moved) +
                                     to->kd * (to->dq_des - rate - faster) -
                                     (torque - kp * moved - kd * faster));
                by_leg[leg][i] = ng_joint_sign[leg][i] * to->q_des + ng_joint_offset[leg][i];
            }
        }
        ng_coordinates(reading.pitch, (const ng_real(*)[NG_LEG_JOINTS])by_leg, command.leg, q);
        for (int i = 0; i < NG_ACTUATED; ++i) {
            worse(&worst[2], q[i + 1] - command.y_d[i]);
        }
    }
    printf("%d %g %g %g %g\n", walked, worst[0], worst[1], worst[2], worst[3]);
    return 0;
}
