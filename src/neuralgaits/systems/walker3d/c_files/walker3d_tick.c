#include "walker3d_tick.h"

#ifdef NG_SPEED_LOW
static const ng_real low = NG(NG_SPEED_LOW), high = NG(NG_SPEED_HIGH), change = NG(NG_SPEED_CHANGE);

int ng_walker3d_tell(ng_walker3d *self, ng_real speed) {
  if (speed == speed) self->requested = ng_clamp(speed, low, high);
  return !(speed >= low && speed <= high);
}

void ng_walker3d_start_at(ng_walker3d *self, int left, ng_real speed) {
  ng_walker3d_start(self, left);
  ng_walker3d_tell(self, speed);
  self->told[0] = self->told[1] = self->requested;
}
#endif

void ng_walker3d_start(ng_walker3d *self, int left) {
  self->left = left != 0;
  self->phase = NG(0.0);
  for (int i = 0; i < 4; ++i) self->z[i] = NG(0.0);
#ifdef NG_SPEED_LOW
  self->requested = self->told[0] = self->told[1] = NG(0.5) * (low + high);
#endif
}

static void touch_down(ng_walker3d *self) {
  self->left = !self->left;
#ifdef NG_SPEED_LOW
  self->told[0] = self->told[1];
  self->told[1] = ng_clamp(self->requested, self->told[0] - change, self->told[0] + change);
#endif
}

/* Angles or rates as the law has them: torso, stance leg, swing leg, of a robot on its right foot. */
static void arranged(int left, ng_real roll, ng_real pitch, const ng_real legs[6], ng_real out[8]) {
  const ng_real side = left ? NG(-1.0) : NG(1.0);
  out[0] = side * roll;
  out[1] = pitch;
  for (int i = 0; i < 6; ++i) {
    const ng_real own = legs[left ? (i + 3) % 6 : i];
    out[2 + i] = i % 3 == 0 ? side * own : own;
  }
}

int ng_walker3d_tick(ng_walker3d *self, const ng_walker3d_reading *r, ng_real torques[6]) {
  static const ng_real limits[] = {NG(NG_ROLL_LIMIT), NG(NG_PITCH_LIMIT), NG(NG_KNEE_LIMIT)};
  ng_real state[NG_STATE], asked[6];
  int known = 1;
  if (self->phase > NG(NG_LANDING) && r->contact[self->left ? 0 : 1]) touch_down(self);
  arranged(self->left, r->roll, r->pitch, r->joints, state);
  arranged(self->left, r->roll_rate, r->pitch_rate, r->rates, state + 8);
  for (int i = 0; i < 3; ++i)
    state[16 + i] = self->left && i == 1 ? -r->velocity[i] : r->velocity[i];
  state[19] = r->velocity_known ? NG(1.0) : NG(0.0);
#ifdef NG_SPEED_LOW
  state[20] = self->told[0];
  state[21] = self->told[1];
#endif
  ng_walker3d_law(state, &self->phase, asked, self->z);
  for (int i = 0; i < 6; ++i) known = known && ng_finite(asked[i]);
  for (int i = 0; i < 6; ++i) {
    const ng_real own = asked[self->left ? (i + 3) % 6 : i];
    const ng_real turned = self->left && i % 3 == 0 ? -own : own;
    torques[i] = known ? ng_clamp(turned, -limits[i % 3], limits[i % 3]) : NG(0.0);
  }
  return known ? 0 : 1;
}
