/* What a board must give: eight functions, written for the drives and the inertial unit at hand. */
#ifndef BOARD_H
#define BOARD_H

#include "controller.h"

/* The operator's switch: 1 while the robot may move. */
int board_enabled(void);

/*
 * Settings of a start: limits and blending are in `config`, which may be left as it is. Returns the
 * leg to stand on, 0 or 1.
 */
int board_configure(ng_config *config);

/* Wait for the next tick of NG_PERIOD. Returns 0 if it has been missed. */
int board_wait_for_tick(void);

/*
 * Read all sensors at one moment, in the signs and zeros of the robot file. With ESTIMATE rates and
 * the velocity of the base are read once, when the robot stands still: zeros will do.
 */
void board_read(ng_encoders *encoders);

#if NG_COMMANDS
/* What the operator requests from the next touchdown on, in the order of ng_command_low. */
void board_requested(ng_real requested[NG_COMMANDS]);
#endif

/* Send torques to the drives. They must stop by themselves if nothing comes for some ticks. */
void board_drive(ng_real motors[NG_LEGS][NG_LEG_JOINTS]);

/* Show what a tick has decided, on a wire or in a log; it may do nothing. */
void board_log(const ng_state *state, const ng_command *command);

/* Show a fault: 0 is none; 100 and above are lines of the self-test that failed. */
void board_report(int fault);

#endif
