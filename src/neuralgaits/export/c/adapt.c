/*
 * See adapt.h. Source of the mathematics: neuralgaits.control.speed_adapter, lean_sums and
 * command_belief, repeated here.
 */
#include "adapt.h"

#if NG_COMMANDS
#define INTEGRAL_GAIN NG(0.2)
#define ERROR_GAIN NG(0.3)
#define MOVING_GAIN NG(0.6) /* while a lean is on its way */
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

#if NG_LEAN_COMMAND || NG_SLOPE_COMMAND
#define BELIEF_GAIN NG(0.3)    /* least share of the way to what a step shows */
#define LEAN_SETTLED NG(5e-3)  /* a belief that lacks less has settled [m] */
#define SLOPE_SETTLED NG(8e-3) /* likewise [rad] */
#define LEAN_JUMP NG(5e-3)     /* a step that shows this much else is of another robot [m] */
#define SLOPE_JUMP NG(15e-3)   /* steps that show this much else are of another ground [rad], */
#define SLOPE_REPEATS 3        /* if these many in a row do */
#define SLOPE_ALIKE NG(8e-3)   /* and each is no further from the mean of those before it [rad] */
#define SLOPE_PAUSE 5          /* steps after that until errors are summed: speeds have followed */

/* Whether a step may show a value: its range, and its width beyond either end. */
static int can_be(int command, ng_real shown)
{
    const ng_real low = ng_command_low[command], high = ng_command_high[command];
    return shown >= low - (high - low) && shown <= high + (high - low);
}

/* Take a step into the mean: the first ones count alike, later on about three; anew after a jump. */
static void take(ng_real *estimate, int *steps, ng_real shown, ng_real jump, int whole)
{
    if (ng_abs(shown - *estimate) > jump) {
        *steps = 0;
    }
    const ng_real share = NG(1.0) / (ng_real)(*steps + 1);
    *estimate += (share > BELIEF_GAIN ? share : BELIEF_GAIN) * (shown - *estimate);
    *steps += whole;
}

/* The value in a command's range that is nearest to an estimate. */
static ng_real believable(int command, ng_real estimate)
{
    return ng_clamp(estimate, ng_command_low[command], ng_command_high[command]);
}

/* What is told of a command to begin with. */
static ng_real first_of(int command, ng_real told)
{
    const ng_real low = ng_command_low[command], high = ng_command_high[command];
    return told == told ? ng_clamp(told, low, high) : NG(0.5) * (low + high);
}
#endif

#if NG_SLOPE_COMMAND
#define SLOPE (NG_SLOPE_COMMAND - 1)
#define FEET_APART NG(0.05) /* least distance of the feet that shows a slope [m] */

/* The angle of a line that rises so much over a run above zero, by Newton's method [rad]. */
static ng_real angle_of(ng_real rise, ng_real run)
{
    ng_real angle = rise / (run + ng_abs(rise));
    for (int i = 0; i < 6; ++i) {
        const ng_real sine = ng_sin(angle), cosine = ng_cos(angle);
        angle -= (run * sine - rise * cosine) / (run * cosine + rise * sine);
    }
    return angle;
}

/* Take a slope into the mean: one step of an uneven floor says little, so several begin it anew. */
static void take_slope(ng_adapt *adapt, ng_real shown)
{
    if (adapt->slope_pause > 0) {
        --adapt->slope_pause;
    }
    if (!(ng_abs(shown - adapt->slope) > SLOPE_JUMP)) {
        adapt->slope_repeated = 0;
    } else if (adapt->slope_repeated && ng_abs(shown - adapt->slope_apart) <= SLOPE_ALIKE) {
        adapt->slope_repeated += 1;
        adapt->slope_apart += (shown - adapt->slope_apart) / (ng_real)adapt->slope_repeated;
    } else {
        adapt->slope_apart = shown;
        adapt->slope_repeated = 1;
    }
    if (adapt->slope_repeated == SLOPE_REPEATS) {
        adapt->slope = adapt->slope_apart;
        adapt->slope_steps = SLOPE_REPEATS;
        adapt->slope_repeated = 0;
        adapt->slope_pause = SLOPE_PAUSE;
        return;
    }
    take(&adapt->slope, &adapt->slope_steps, shown, NG_NEVER, 1);
}

/* Take note of a touchdown: the old foot is below and behind the new one. */
static void tilt(ng_adapt *adapt, const ng_command *command)
{
    ng_real foot[2], hip[2];
    ng_feet(command->q, foot, hip);
    adapt->slope_doubted = 0;
    if (!NG_ANKLES && -foot[0] > FEET_APART && ng_finite(foot[1])) {
        adapt->slope_shown = angle_of(-foot[1], -foot[0]);
        adapt->slope_doubted = !can_be(SLOPE, adapt->slope_shown);
        if (!adapt->slope_doubted) {
            take_slope(adapt, adapt->slope_shown);
        }
    }
}
#endif

#if NG_LEAN_COMMAND
#define LEAN (NG_LEAN_COMMAND - 1)
#define SETTLING NG(0.015)    /* of a foot after a touchdown [s] */
#define FIRST NG(0.05)        /* shortest window of a step without a touchdown before it [s] */

/* Whether the step under way shows a lean so far, that of its window's sums. */
static int lean_shown(const ng_adapt *adapt, ng_real *lean)
{
    if (!(adapt->since > adapt->least && adapt->since > NG(0.0))) {
        return 0;
    }
    const ng_real length = adapt->since, square = length * length;
    const ng_real slope[3] = {NG(2.0) * square, NG(-6.0) * length, NG(4.0)};
    const ng_real share[3] = {square, NG(-2.0) * length, NG(1.0)};
    ng_real sums[2] = {NG(0.0), NG(0.0)};
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 2; ++j) {
            sums[j] += slope[i] * adapt->of_momentum[i][j] +
                       NG_WEIGHT * share[i] * adapt->of_ahead[i][j];
        }
    }
    *lean = -sums[0] / sums[1];
    return 1;
}

/* What the interval since the last tick adds to the sums. */
static void add_interval(ng_adapt *adapt, const ng_real q[NG_COORDINATES], ng_real passed)
{
    ng_real middle[NG_COORDINATES], change[NG_COORDINATES], ahead[2], momentum[2];
    for (int i = 0; i < NG_COORDINATES; ++i) {
        middle[i] = NG(0.5) * (adapt->q[i] + q[i]);
        change[i] = q[i] - adapt->q[i];
    }
    ng_lean(change, middle, ahead, momentum);
    ng_real power = adapt->since + NG(0.5) * passed;
    const ng_real time = power;
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 2; ++j) {
            adapt->of_momentum[i][j] += power * momentum[j];
            adapt->of_ahead[i][j] += power * time * passed * ahead[j];
        }
        power *= time;
    }
    adapt->since += passed;
}

/* Take note of a tick; at a touchdown, of the lean that the step before it showed. */
static void learn(ng_adapt *adapt, const ng_measurement *reading, const ng_command *command)
{
    const ng_real passed = (ng_real)(reading->time_us - adapt->tick_us) * NG(1.0e-6);
    const int first = command->since_touchdown >= NG_NEVER * NG(0.5);
    if (command->touchdown) {
        adapt->lean_doubted = 0;
        if (lean_shown(adapt, &adapt->shown)) {
            adapt->lean_doubted = ng_finite(adapt->shown) && !can_be(LEAN, adapt->shown);
            if (can_be(LEAN, adapt->shown)) {
                /* A part of a step counts until a whole one. */
                take(&adapt->believed, &adapt->lean_steps, adapt->shown, LEAN_JUMP, adapt->begun);
            }
        }
        adapt->since = NG(-1.0);
    } else if (adapt->since >= NG(0.0)) {
        add_interval(adapt, command->q, passed);
    } else if (command->since_touchdown >= SETTLING - NG(1.0e-6)) {
        adapt->since = NG(0.0);
        adapt->least = first ? FIRST : NG(0.0);
        for (int i = 0; i < 3; ++i) {
            for (int j = 0; j < 2; ++j) {
                adapt->of_momentum[i][j] = adapt->of_ahead[i][j] = NG(0.0);
            }
        }
    }
    adapt->tick_us = reading->time_us;
    for (int i = 0; i < NG_COORDINATES; ++i) {
        adapt->q[i] = command->q[i];
    }
}
#endif

#if NG_LEAN_COMMAND
/* The estimate with what the step under way shows so far: its touchdown latches that. */
static ng_real lean_so_far(const ng_adapt *adapt)
{
    ng_real lean = adapt->believed, shown;
    int steps = adapt->lean_steps;
    if (lean_shown(adapt, &shown) && can_be(LEAN, shown)) {
        take(&lean, &steps, shown, LEAN_JUMP, adapt->begun);
    }
    return lean;
}

/* Speed that a lean beyond the belief of the next step adds; whether that is still on its way. */
static ng_real excess(const ng_adapt *adapt, const ng_state *state, ng_real lean, int *moving)
{
    const ng_real last = state->after[LEAN], change = ng_command_change[LEAN];
    const ng_real wish = believable(LEAN, lean);
    const ng_real next = ng_clamp(wish, last - change, last + change);
    *moving = adapt->learns && next != wish;
    return adapt->learns ? NG_SPEED_BY_LEAN * (lean - next) : NG(0.0);
}
#endif

/* Whether a belief is on its way, so that a speed says little about the next one. */
static int believes_anew(const ng_adapt *adapt, const ng_state *state)
{
#if NG_LEAN_COMMAND
    const ng_real lean = believable(LEAN, adapt->believed);
    if (adapt->learns && ng_abs(lean - state->before[LEAN]) > LEAN_SETTLED) {
        return 1;
    }
#endif
#if NG_SLOPE_COMMAND
    const ng_real slope = believable(SLOPE, adapt->slope);
    const ng_real lacking = ng_abs(slope - state->before[SLOPE]);
    if (adapt->tilts && (adapt->slope_pause > 0 || lacking > SLOPE_SETTLED)) {
        return 1;
    }
#endif
    (void)adapt;
    (void)state;
    return 0;
}

void ng_adapt_first(const ng_real told[NG_COMMANDS], ng_real first[NG_COMMANDS])
{
    for (int i = 0; i < NG_COMMANDS; ++i) {
        first[i] = told[i];
    }
#if NG_LEAN_COMMAND && NG_SPEED_COMMAND
    const ng_real middle = NG(0.5) * (LOW + HIGH);
    first[SPEED] = told[SPEED] > middle ? told[SPEED] : middle; /* of a NaN, too */
#endif
}

void ng_adapt_start(ng_adapt *adapt, const ng_real told[NG_COMMANDS])
{
    const ng_adapt fresh = {0};
    *adapt = fresh;
    adapt->since = NG(-1.0);
#if NG_LEAN_COMMAND
    adapt->learns = 1;
    adapt->believed = first_of(LEAN, told[LEAN]);
#endif
#if NG_SLOPE_COMMAND
    adapt->slope = first_of(SLOPE, told[SLOPE]);
#endif
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
    ng_real known = NG(0.0);
    int moving = 0;
#if NG_LEAN_COMMAND
    const ng_real lean = lean_so_far(adapt);
    known = excess(adapt, state, lean, &moving);
    if (adapt->learns) {
        wish[LEAN] = believable(LEAN, lean);
    }
#endif
#if NG_SLOPE_COMMAND
    if (adapt->tilts) {
        wish[SLOPE] = believable(SLOPE, adapt->slope);
    }
#endif
    if (adapt->active && NG_SPEED_COMMAND > 0) {
        const ng_real gain = moving ? MOVING_GAIN : ERROR_GAIN;
        wish[SPEED] = ng_clamp(reference_for(adapt, told[SPEED]) + adapt->integral +
                                   gain * adapt->error - known,
                               LOW, HIGH);
    }
    return ng_tell(state, wish);
}

void ng_adapt_step(ng_adapt *adapt, const ng_state *state, const ng_measurement *reading,
                   const ng_command *command, const ng_real told[NG_COMMANDS])
{
    if (command->fault != NG_NO_FAULT) {
        adapt->since = NG(-1.0); /* the step under way shows nothing */
        return;
    }
#if NG_LEAN_COMMAND
    learn(adapt, reading, command);
#endif
    if (!command->touchdown) {
        return;
    }
#if NG_SLOPE_COMMAND
    tilt(adapt, command);
#endif
    const ng_real width = HIGH - LOW;
    adapt->measured = measure(adapt, reading, command->leg);
    if (adapt->measured) {
        adapt->error = ng_clamp(adapt->reference - adapt->walked, -width, width);
        if (!believes_anew(adapt, state)) {
            integrate(adapt, state->before[SPEED], state->after[SPEED]);
        }
    }
    adapt->reference = reference_for(adapt, told[SPEED]);
}
#else
typedef int ng_adapt_is_empty; /* a gait that takes no command */
#endif
