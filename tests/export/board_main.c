/* The map of a deployment file, on readings from stdin: see test_board_map.py. */
#include "board_map.h"

#include <stdio.h>

static int put(ng_real value)
{
    const double wide = (double)value;
    return fwrite(&wide, sizeof wide, 1, stdout) == 1;
}

static int put_targets(const ng_target *to)
{
    return put(to->q_des) && put(to->dq_des) && put(to->kp) && put(to->kd) && put(to->tau_ff);
}

/* What Python needs, then what it compares. */
static int tick(const double *in)
{
    const ng_config config = ng_config_of(&ng_laws[NG_LAW_PD]);
    ng_board_readings readings = {0};
    ng_encoders encoders;
    ng_measurement reading;
    ng_state state;
    ng_command command;
    ng_target plain[NG_LEGS][NG_LEG_JOINTS], targets[NG_BOARD_MOTORS], mapped[NG_BOARD_MOTORS];
    ng_target stiff[NG_LEGS][NG_LEG_JOINTS];
    ng_real torques[NG_BOARD_MOTORS];
    int done = 1, outside;
    for (int i = 0; i < NG_BOARD_MOTORS; ++i) {
        readings.position[i] = (ng_real)*in++;
        readings.velocity[i] = (ng_real)*in++;
    }
    readings.pitch = (ng_real)*in++;
    readings.dpitch = (ng_real)*in++;
    for (int i = 0; i < NG_BOARD_CHANNELS; ++i) {
        readings.contact[i] = (ng_real)*in++;
    }
    outside = ng_board_encoders(&readings, &encoders);
    ng_start(&state, 0);
    ng_measure(&encoders, &reading);
    ng_step(&config, &state, &reading, &command);
    ng_impedance(&reading, &command, NG(0.0), NG(0.0), plain);
    ng_board_torques(&command, torques);
    ng_board_targets(&reading, &command, targets);
    ng_impedance(&reading, &command, NG(70.0), NG(4.0), stiff);
    ng_board_map_targets((const ng_target(*)[NG_LEG_JOINTS])stiff, mapped);
    for (int leg = 0; leg < NG_LEGS; ++leg) {
        for (int i = 0; i < NG_LEG_JOINTS; ++i) {
            done &= put(plain[leg][i].q_des) && put(plain[leg][i].dq_des) &&
                    put(ng_joint_sign[leg][i] * command.torque[leg][i]);
            done &= put(encoders.joints[leg][i]) && put(encoders.djoints[leg][i]);
        }
    }
    done &= put((ng_real)command.fault) && put(encoders.pitch) && put(encoders.dpitch);
    done &= put(encoders.normal_force[0]) && put(encoders.normal_force[1]);
    done &= put((ng_real)outside);
    for (int i = 0; i < NG_BOARD_MOTORS; ++i) {
        done &= put(torques[i]) && put_targets(&targets[i]) && put_targets(&mapped[i]);
    }
    return done;
}

int main(void)
{
    double in[2 * NG_BOARD_MOTORS + 2 + NG_BOARD_CHANNELS];
    while (fread(in, sizeof in, 1, stdin) == 1) {
        if (!tick(in)) {
            return 1;
        }
    }
    return 0;
}
