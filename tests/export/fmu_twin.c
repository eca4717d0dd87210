/* The ticks of an FMU without it: rows of readings in, rows of outputs out. See test_fmu.py. */
#include <stdio.h>

#include "estimator.h"

#define JOINTS (NG_LEGS * NG_LEG_JOINTS)

/* law, estimate, kp, kd; then rows of pitch, its rate, velocity, forces, angles, rates. */
int main(void)
{
    double about[4], row[6 + 2 * JOINTS];
    ng_encoders encoders = {0};
    ng_estimator estimator;
    ng_state state;
    uint32_t ticks = 0u;
    if (fread(about, sizeof about, 1, stdin) != 1) {
        return 1;
    }
    const ng_config config = ng_config_of(&ng_laws[(int)about[0]]);
    ng_start(&state, 0);
    ng_estimator_start(&estimator);
    while (fread(row, sizeof row, 1, stdin) == 1) {
        ng_measurement reading;
        ng_command command;
        ng_real motors[NG_LEGS][NG_LEG_JOINTS];
        ng_target targets[NG_LEGS][NG_LEG_JOINTS];
        encoders.time_us = 1000u * ticks++;
        encoders.pitch = row[0];
        encoders.dpitch = row[1];
        for (int i = 0; i < 2; ++i) {
            encoders.base_velocity[i] = row[2 + i];
            encoders.normal_force[i] = row[4 + i];
        }
        for (int i = 0; i < JOINTS; ++i) {
            encoders.joints[i / NG_LEG_JOINTS][i % NG_LEG_JOINTS] = row[6 + i];
            encoders.djoints[i / NG_LEG_JOINTS][i % NG_LEG_JOINTS] = row[6 + JOINTS + i];
        }
        ng_measure(&encoders, &reading);
        if (about[1] != 0.0) {
            ng_estimate(&estimator, &state, &reading);
        }
        ng_step(&config, &state, &reading, &command);
        ng_drive(&command, motors);
        ng_impedance(&reading, &command, about[2], about[3], targets);
        const double whole[2] = {(double)command.leg, (double)command.fault};
        if (fwrite(motors, sizeof motors, 1, stdout) != 1 ||
            fwrite(targets, sizeof targets, 1, stdout) != 1 ||
            fwrite(whole, sizeof whole, 1, stdout) != 1) {
            return 1;
        }
    }
    return 0;
}
