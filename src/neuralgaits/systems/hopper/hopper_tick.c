#include "hopper_tick.h"

/* Newton's method from above: at lift-off alone, so the number of iterations does not matter. */
static ng_real square_root(ng_real x) {
  ng_real root = x > NG(1.0) ? x : NG(1.0);
  for (int i = 0; i < 60; ++i) root = NG(0.5) * (root + x / root);
  return root;
}

static ng_real larger(ng_real a, ng_real b) { return a > b ? a : b; }

static ng_real clipped(ng_real share) {
  return share < NG(0.0) ? NG(0.0) : share > NG(1.0) ? NG(1.0) : share;
}

/* Mass times distance of the centre of mass from the foot. */
static ng_real mass_moment(ng_real length) {
  return NG(NG_FOOT_MASS) * NG(NG_FOOT_OFFSET) +
         NG(NG_UPPER_MASS) * (length + NG(NG_UPPER_OFFSET));
}

/* Inertia about the centre of mass, without the wheel's own. */
static ng_real flight_inertia(ng_real length) {
  const ng_real reach = length + NG(NG_UPPER_OFFSET), moment = mass_moment(length);
  const ng_real foot =
      NG(NG_FOOT_INERTIA) + NG(NG_FOOT_MASS) * NG(NG_FOOT_OFFSET) * NG(NG_FOOT_OFFSET);
  return foot + NG(NG_UPPER_INERTIA) + NG(NG_UPPER_MASS) * reach * reach -
         moment * moment / (NG(NG_UPPER_MASS) + NG(NG_FOOT_MASS));
}

/* The centre of mass falls freely, and the momentum about it stays: both say how the flight ends. */
static void lift_off(ng_hopper *self, const ng_hopper_reading *r) {
  const ng_real mass = NG(NG_UPPER_MASS) + NG(NG_FOOT_MASS);
  const ng_real sine = ng_sin(r->lean), cosine = ng_cos(r->lean);
  const ng_real distance = mass_moment(r->length) / mass;
  const ng_real along = NG(NG_UPPER_MASS) / mass * r->sliding;
  const ng_real upward = along * cosine - distance * r->turning * sine;
  const ng_real fall = r->foot_height + distance * cosine -
                       mass_moment(NG(NG_LANDING_LENGTH)) / mass * ng_cos(NG(NG_TOUCHDOWN));
  const ng_real risen = larger(upward * upward + NG(2.0) * NG(NG_GRAVITY) * fall, NG(0.0));
  const ng_real spin = r->wheel_momentum + flight_inertia(r->length) * r->turning;
  self->flying = 1;
  self->began = r->time;
  self->duration = larger((upward + square_root(risen)) / NG(NG_GRAVITY), NG(NG_SHORTEST_FLIGHT));
  self->lean = r->lean;
  self->length = r->length;
  self->turning = r->turning;
  self->sliding = r->sliding;
  self->landing_turning = spin / flight_inertia(NG(NG_LANDING_LENGTH));
}

void ng_hopper_start(ng_hopper *self) {
  self->flying = 0;
  self->began = self->lean = self->length = self->turning = self->sliding = NG(0.0);
  self->duration = self->landing_turning = NG(1.0);
}

void ng_hopper_tick(ng_hopper *self, const ng_hopper_reading *r, ng_real *force,
                    ng_real *torque) {
  ng_real forces[3];
  if (self->flying && r->contact && r->time - self->began > NG(NG_EARLIEST) * self->duration)
    self->flying = 0;
  else if (!self->flying && r->lean >= NG(NG_LIFT_OFF))
    lift_off(self, r);
  {
    const ng_real state[] = {
        clipped((r->lean - NG(NG_TOUCHDOWN)) / (NG(NG_LIFT_OFF) - NG(NG_TOUCHDOWN))),
        larger(r->momentum, NG(NG_LEAST_MOMENTUM)),
        r->lean, r->length, r->turning, r->sliding,
        self->flying ? clipped((r->time - self->began) / self->duration) : NG(0.0),
        self->duration, self->lean, self->length, self->turning, self->sliding,
        self->landing_turning};
    ng_hopper_forces(state, forces);
  }
  *force = self->flying ? forces[1] : forces[0];
  *torque = self->flying ? forces[2] : -NG(NG_HOLD) * r->wheel_momentum;
}
