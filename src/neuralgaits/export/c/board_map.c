#include "board_map.h"

int ng_board_encoders(const ng_board_readings *readings, ng_encoders *encoders)
{
    int outside = 0;
    encoders->time_us = readings->time_us;
    encoders->pitch = NG_BOARD_PITCH_SIGN * (readings->pitch - NG_BOARD_PITCH_ZERO);
    encoders->dpitch = NG_BOARD_PITCH_SIGN * readings->dpitch;
    encoders->base_velocity[0] = readings->base_velocity[0];
    encoders->base_velocity[1] = readings->base_velocity[1];
    for (int leg = 0; leg < NG_LEGS; ++leg) {
        const ng_real contact = readings->contact[ng_board_channel[leg]];
        encoders->normal_force[leg] = ng_board_newton[leg] * (contact - ng_board_no_contact[leg]);
        for (int i = 0; i < NG_LEG_JOINTS; ++i) {
            const int motor = ng_board_motor[leg][i];
            const ng_real sign = ng_board_sign[leg][i], gear = ng_board_gear[leg][i];
            const ng_real angle =
                sign * (readings->position[motor] / gear - ng_board_zero[leg][i]);
            encoders->joints[leg][i] = angle;
            encoders->djoints[leg][i] = sign * readings->velocity[motor] / gear;
            if (!outside && !(angle >= ng_board_lower[leg][i] && angle <= ng_board_upper[leg][i])) {
                outside = 1 + motor;
            }
        }
    }
    return outside;
}

/* The torque on a joint in the robot file's sign, within the limit of the deployment file. */
static ng_real joint_torque(const ng_command *command, int leg, int i)
{
    const ng_real limit = ng_board_torque_limit[leg][i];
    return ng_clamp(ng_joint_sign[leg][i] * command->torque[leg][i], -limit, limit);
}

void ng_board_torques(const ng_command *command, ng_real torques[NG_BOARD_MOTORS])
{
    for (int motor = 0; motor < NG_BOARD_MOTORS; ++motor) {
        torques[motor] = NG(0.0);
    }
    for (int leg = 0; leg < NG_LEGS; ++leg) {
        for (int i = 0; i < NG_LEG_JOINTS; ++i) {
            torques[ng_board_motor[leg][i]] =
                ng_board_sign[leg][i] * joint_torque(command, leg, i) / ng_board_gear[leg][i];
        }
    }
}

void ng_board_map_targets(const ng_target joints[NG_LEGS][NG_LEG_JOINTS],
                          ng_target targets[NG_BOARD_MOTORS])
{
    const ng_target nothing = {NG(0.0), NG(0.0), NG(0.0), NG(0.0), NG(0.0)};
    for (int motor = 0; motor < NG_BOARD_MOTORS; ++motor) {
        targets[motor] = nothing;
    }
    for (int leg = 0; leg < NG_LEGS; ++leg) {
        for (int i = 0; i < NG_LEG_JOINTS; ++i) {
            const ng_target *from = &joints[leg][i];
            const ng_real sign = ng_board_sign[leg][i], gear = ng_board_gear[leg][i];
            ng_target *to = &targets[ng_board_motor[leg][i]];
            to->q_des = gear * (sign * from->q_des + ng_board_zero[leg][i]);
            to->dq_des = gear * sign * from->dq_des;
            to->kp = from->kp / (gear * gear);
            to->kd = from->kd / (gear * gear);
            to->tau_ff = sign * from->tau_ff / gear;
        }
    }
}

void ng_board_targets(const ng_measurement *reading, const ng_command *command,
                      ng_target targets[NG_BOARD_MOTORS])
{
    ng_target wanted[NG_LEGS][NG_LEG_JOINTS];
    /* Without gains, tau_ff is the whole torque. */
    ng_impedance(reading, command, NG(0.0), NG(0.0), wanted);
    for (int leg = 0; leg < NG_LEGS; ++leg) {
        for (int i = 0; i < NG_LEG_JOINTS; ++i) {
            const ng_real own = ng_joint_sign[leg][i];
            const ng_real q = own * (reading->angles[leg][i] - ng_joint_offset[leg][i]);
            const ng_real dq = own * reading->rates[leg][i];
            ng_target *to = &wanted[leg][i];
            to->q_des = ng_clamp(to->q_des, ng_board_lower[leg][i], ng_board_upper[leg][i]);
            to->kp = ng_board_kp[leg][i];
            to->kd = ng_board_kd[leg][i];
            to->tau_ff = joint_torque(command, leg, i) - to->kp * (to->q_des - q) -
                         to->kd * (to->dq_des - dq);
        }
    }
    ng_board_map_targets((const ng_target(*)[NG_LEG_JOINTS])wanted, targets);
    for (int motor = 0; command->fault != NG_NO_FAULT && motor < NG_BOARD_MOTORS; ++motor) {
        targets[motor].q_des = targets[motor].dq_des = NG(0.0);
        targets[motor].kp = targets[motor].tau_ff = NG(0.0);
    }
}

void ng_board_limit_targets(const ng_measurement *reading,
                            ng_target joints[NG_LEGS][NG_LEG_JOINTS])
{
    for (int leg = 0; leg < NG_LEGS; ++leg) {
        for (int i = 0; i < NG_LEG_JOINTS; ++i) {
            ng_target *to = &joints[leg][i];
            const ng_real own = ng_joint_sign[leg][i], limit = ng_board_torque_limit[leg][i];
            const ng_real q = own * (reading->angles[leg][i] - ng_joint_offset[leg][i]);
            const ng_real dq = own * reading->rates[leg][i];
            const ng_real torque = to->tau_ff + to->kp * (to->q_des - q) + to->kd * (to->dq_des - dq);
            if (to->kp != NG(0.0)) {
                to->tau_ff += ng_clamp(torque, -limit, limit) - torque;
            }
        }
    }
}
