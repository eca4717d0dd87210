/* See adapt.h. Source of the mathematics: neuralgaits.control.speed_adapter, repeated here. */
#include "adapt.h"

#if NG_COMMANDS
#define INTEGRAL_GAIN NG(0.2)
#define ERROR_GAIN NG(0.3)
#define NEAR NG(1.0e-3) /* a command this near to a limit is at it, a share of the change */
/* Place of the speed; 0 for a gait that takes none, which is never adapted. */
#define SPEED (NG_SPEED_COMMAND > 0 ? NG_SPEED_COMMAND - 1 : 0)
#define LOW ng_command_low[SPEED]
#define HIGH ng_command_high[SPEED]
#define CHANGE ng_command_change[SPEED]

/* The hip ahead of a foot that stands; a point foot rolls on its sphere. */
static ng_real hip_over_foot(const ng_measurement *reading, int leg)
{
    ng_real q[NG_COORDINATES], foot[2], hip[2];
    ng_coordinates(reading->pitch, reading->angles, leg, q);
    ng_feet(q, foot, hip);
    return hip[0] - NG_ROLLING_RADIUS * q[0];
}

/* The reference of a step that is told a speed; NaN leaves it as it is. */
static ng_real reference_for(const ng_adapt *adapt, ng_real told)
{
    const ng_real last = adapt->reference;
    if (!(told == told)) {
        return last;
    }
    return ng_clamp(ng_clamp(told, LOW, HIGH), last - CHANGE, last + CHANGE);
}

/* Keep time and hip of a touchdown. Returns whether the step before it was measured. */
static int measure(ng_adapt *adapt, const ng_measurement *reading, int leg)
{
    const ng_real passed = (ng_real)(reading->time_us - adapt->last_us) * NG(1.0e-6);
    const ng_real way = hip_over_foot(reading, 1 - leg) - adapt->hip;
    const ng_real walked = passed > NG(0.0) ? way / passed : NG(0.0);
    const int measured = adapt->begun && passed > NG(0.0) && ng_finite(walked);
    adapt->hip = hip_over_foot(reading, leg);
    adapt->last_us = reading->time_us;
    adapt->begun = 1;
    if (measured) {
        adapt->walked = walked;
    }
    return measured;
}

/* At a limit the integral does not grow further that way. */
static void integrate(ng_adapt *adapt, ng_real before, ng_real after)
{
    const ng_real width = HIGH - LOW, error = adapt->error;
    const ng_real top = ng_clamp(before + CHANGE, LOW, HIGH), near = NEAR * CHANGE;
    const ng_real bottom = ng_clamp(before - CHANGE, LOW, HIGH);
    const int highest = after >= top - near, lowest = after <= bottom + near;
    if (!((highest && error > NG(0.0)) || (lowest && error < NG(0.0)))) {
        adapt->integral = ng_clamp(adapt->integral + INTEGRAL_GAIN * error, -width, width);
    }
}

void ng_adapt_start(ng_adapt *adapt, const ng_real told[NG_COMMANDS])
{
    const ng_adapt fresh = {0};
    *adapt = fresh;
    adapt->active = NG_SPEED_COMMAND > 0;
    adapt->reference = told[SPEED] == told[SPEED] ? ng_clamp(told[SPEED], LOW, HIGH)
                                                  : NG(0.5) * (LOW + HIGH);
}

int ng_adapt_tell(const ng_adapt *adapt, ng_state *state, const ng_real told[NG_COMMANDS])
{
    ng_real wish[NG_COMMANDS];
    for (int i = 0; i < NG_COMMANDS; ++i) {
        wish[i] = told[i];
    }
    if (adapt->active && NG_SPEED_COMMAND > 0) {
        wish[SPEED] = ng_clamp(reference_for(adapt, told[SPEED]) + adapt->integral +
                                   ERROR_GAIN * adapt->error,
                               LOW, HIGH);
    }
    return ng_tell(state, wish);
}

void ng_adapt_step(ng_adapt *adapt, const ng_state *state, const ng_measurement *reading,
                   const ng_command *command, const ng_real told[NG_COMMANDS])
{
    if (command->fault != NG_NO_FAULT || !command->touchdown) {
        return;
    }
    const ng_real width = HIGH - LOW;
    adapt->measured = measure(adapt, reading, command->leg);
    if (adapt->measured) {
        adapt->error = ng_clamp(adapt->reference - adapt->walked, -width, width);
        integrate(adapt, state->before[SPEED], state->after[SPEED]);
    }
    adapt->reference = reference_for(adapt, told[SPEED]);
}
#else
typedef int ng_adapt_is_empty; /* a gait that takes no command */
#endif
