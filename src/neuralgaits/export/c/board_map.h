/*
 * Between motors and channels of the hardware and the joints of the robot file, as the deployment
 * file says: its numbers stand in board_facts.c. Motors and channels count from 0; those that no
 * joint or foot has are ignored, and told zero.
 */
#ifndef NG_BOARD_MAP_H
#define NG_BOARD_MAP_H

#include "board_facts.h"
#include "controller.h"

/* What the hardware shows, in its own order, signs and zeros. */
typedef struct {
    uint32_t time_us;                    /* of the reading; may wrap around [us] */
    ng_real position[NG_BOARD_MOTORS];   /* of the drives [rad] */
    ng_real velocity[NG_BOARD_MOTORS];   /* of the drives; zeros beside ng_estimate [rad/s] */
    ng_real pitch;                       /* of the inertial unit [rad] */
    ng_real dpitch;                      /* its rate [rad/s] */
    ng_real base_velocity[2];            /* as in ng_encoders; zeros beside ng_estimate [m/s] */
    ng_real contact[NG_BOARD_CHANNELS];  /* in the unit of the channel */
} ng_board_readings;

/*
 * The reading for ng_measure. Returns 0, or 1 + the motor of the first joint that is outside of the
 * range in the deployment file, or that is no number.
 */
int ng_board_encoders(const ng_board_readings *readings, ng_encoders *encoders);

/* In place of ng_drive: torques of the drives [N m], within the limits of the deployment file. */
void ng_board_torques(const ng_command *command, ng_real torques[NG_BOARD_MOTORS]);

/*
 * In place of ng_impedance: what drives with a loop of their own are told, with the gains of the
 * deployment file. At the angles of the reading they give the torques of ng_board_torques. After a
 * fault they only damp.
 */
void ng_board_targets(const ng_measurement *reading, const ng_command *command,
                      ng_target targets[NG_BOARD_MOTORS]);

/*
 * Targets of the joints, as those of ng_impedance or of the supervisor, for the drives. Their gains
 * and torques are taken as they are.
 */
void ng_board_map_targets(const ng_target joints[NG_LEGS][NG_LEG_JOINTS],
                          ng_target targets[NG_BOARD_MOTORS]);

/*
 * Hold targets of the joints, in place, so that at the angles of the reading they give no torque
 * beyond the deployment file's. Drives that only damp are left as they are.
 */
void ng_board_limit_targets(const ng_measurement *reading,
                            ng_target joints[NG_LEGS][NG_LEG_JOINTS]);

#endif
