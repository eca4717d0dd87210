/* What a board must give: five functions, written for the drives and the inertial unit at hand. */
#ifndef BOARD_H
#define BOARD_H

#include "controller.h"

/* Wait for the next tick of NG_PERIOD. Returns 0 if it has been missed. */
int board_wait_for_tick(void);

/*
 * Read all sensors at one moment, in the signs and zeros of the robot file. With ESTIMATE rates and
 * the velocity of the base are read once, when the robot stands still: zeros will do.
 */
void board_read(ng_encoders *encoders);

/* Send torques to the drives. They must stop by themselves if nothing comes for some ticks. */
void board_drive(ng_real motors[NG_LEGS][NG_LEG_JOINTS]);

/* The operator's switch: 1 while the robot may move. */
int board_enabled(void);

/* Show a fault: 0 is none; 100 and above are lines of the self-test that failed. */
void board_report(int fault);

#endif
