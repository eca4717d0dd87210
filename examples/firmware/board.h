/* What a board must give, written for the drives and the inertial unit at hand. */
#ifndef BOARD_H
#define BOARD_H

#include "supervisor.h"

/* The switch of the drives: 1 while they have power. What the robot does starts anew with it. */
int board_enabled(void);

/* Limits and gains of a start: those of `config` may be left as they are. */
void board_configure(ng_supervisor_config *config);

/*
 * Wait for the next tick of NG_PERIOD. Returns 0 if it has been missed. With ESTIMATE 0 it may end
 * the wait early, when the interrupt of a foot switch has set a flag: a tick at the touchdown.
 */
int board_wait_for_tick(void);

/*
 * Read all sensors at one moment, in the signs and zeros of the robot file. With ESTIMATE rates and
 * the velocity of the base are read once, when the robot stands still: zeros will do.
 */
void board_read(ng_encoders *encoders);

/* What the operator wants: to damp, to stand or to walk. */
ng_request board_request(void);

#if NG_COMMANDS
/* What the operator requests from the next touchdown on, in the order of ng_command_low. */
void board_requested(ng_real requested[NG_COMMANDS]);
#endif

/*
 * Send to the drives: torques over gears, or with DRIVES what those with a loop of their own are
 * told. They must stop by themselves if nothing comes for some ticks.
 */
void board_drive(ng_real motors[NG_LEGS][NG_LEG_JOINTS]);
void board_aim(ng_target targets[NG_LEGS][NG_LEG_JOINTS]);

/* Show what a tick has decided, on a wire or in a log; it may do nothing. */
void board_log(const ng_supervisor *supervisor, const ng_supervision *decided);

/* Show that the mode has changed, with its reason, or that there is a fault. */
void board_changed(const ng_supervision *decided);

/* Show the line of the self-test that failed. */
void board_failed(int line);

#endif
