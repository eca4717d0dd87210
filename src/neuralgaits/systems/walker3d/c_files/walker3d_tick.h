/*
 * A biped's controller from tick to tick, every millisecond: torques of the law `pd` on either foot.
 * No heap and no other state than ng_walker3d. Written by neuralgaits.
 */
#ifndef NG_WALKER3D_TICK_H
#define NG_WALKER3D_TICK_H

#include "walker3d.h"

/*
 * What is measured, with the signs and zeros of the robot file. Legs: right hip roll, hip pitch and
 * knee, then the left ones. Roll is about the forward axis, then pitch about the torso's left axis.
 */
typedef struct {
  ng_real roll, pitch, roll_rate, pitch_rate; /* of the torso: rad, rad/s */
  ng_real joints[6], rates[6];                /* rad, rad/s */
  ng_real velocity[3];  /* of the middle of the hips, forward, left and up: m/s */
  int velocity_known;   /* 0 if nothing measures it: then the stance foot counts as at rest */
  int contact[2];       /* whether the right and the left foot touch the floor */
} ng_walker3d_reading;

/* On which foot the robot stands, and where it is in the step. */
typedef struct {
  int left;      /* whether that is the left foot */
  ng_real phase; /* 0 at the start of a step, 1 at its end */
  ng_real z[4];  /* hip forward and aside of that foot, m; L_y and n, kg m^2/s. Mirrored on the left */
#ifdef NG_SPEED_LOW
  ng_real requested; /* speed for the steps to come, see ng_walker3d_tell: m/s */
  ng_real told[2];   /* speeds told to the step before and to this one: m/s */
#endif
} ng_walker3d;

/*
 * Begin a step on the right foot, or on the left one. A gait that is told its speed has then been told
 * the middle of its range all the time.
 */
void ng_walker3d_start(ng_walker3d *self, int left);

#ifdef NG_SPEED_LOW
/* The same of a robot that has been told this speed all the time, m/s; clamped as by ng_walker3d_tell. */
void ng_walker3d_start_at(ng_walker3d *self, int left, ng_real speed);

/*
 * The speed that the next touchdowns are to go to, m/s; at any time between two ticks. Each touchdown
 * goes up to NG_SPEED_CHANGE towards it. A speed outside the range is clamped, a NaN keeps the last
 * one. Returns: 0, or 1 if the speed was changed so.
 */
int ng_walker3d_tell(ng_walker3d *self, ng_real speed);
#endif

/*
 * One tick: the torques of the motors in the order of the joints, N m, within their limits. A touch
 * of the swing foot is a touchdown once NG_LANDING of the step is done. Returns: 0; 1 if the gait has
 * no pose for this state, with torques of 0. Falls are the caller's to see.
 */
int ng_walker3d_tick(ng_walker3d *self, const ng_walker3d_reading *reading, ng_real torques[6]);

#endif
