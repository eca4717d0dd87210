/*
 * A hopper's controller from tick to tick: stances by the policy, flights by a plan that is made at
 * lift-off. No heap and no other state than ng_hopper. Written by neuralgaits.
 */
#ifndef NG_HOPPER_TICK_H
#define NG_HOPPER_TICK_H

#include "hopper.h"

/* What is measured. Leans are positive forward, lengths from hip to foot. */
typedef struct {
  ng_real lean, length, turning, sliding; /* of the leg: rad, m, and their rates */
  ng_real momentum;       /* about the foot, kg m^2/s; read in stance */
  ng_real wheel_momentum; /* the wheel's inertia times its absolute rate, kg m^2/s */
  ng_real foot_height;    /* over the floor, m; read at lift-off */
  ng_real time;           /* s */
  int contact;            /* whether the foot touches the floor; read in flight */
} ng_hopper_reading;

/* The leg at lift-off, the flight's duration, and the rate of the lean at its end. */
typedef struct {
  int flying;
  ng_real began, duration, lean, length, turning, sliding, landing_turning;
} ng_hopper;

/* Begin in a stance. */
void ng_hopper_start(ng_hopper *self);

/*
 * One tick: the leg's force, N, positive where it lengthens, and the wheel's torque, N m. Clamp them
 * at NG_FORCE_LIMIT and NG_TORQUE_LIMIT. Falls are the caller's to see: a stance or a flight that
 * takes a second, a lean beyond 0.6 rad in stance.
 */
void ng_hopper_tick(ng_hopper *self, const ng_hopper_reading *reading, ng_real *force,
                    ng_real *torque);

#endif
