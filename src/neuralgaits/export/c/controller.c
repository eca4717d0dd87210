/* See controller.h. Source of the mathematics: neuralgaits.control, which this file repeats. */
#include "controller.h"

#if NG_ANKLES
#define ANKLE_LIMIT NG_ANKLE_LIMIT
#else
#define ANKLE_LIMIT NG(0.0)
#endif

/*
 * Actuated joints, stance leg first and upwards, then the swing leg downwards. `by_leg` is a
 * pointer to rows: with both bounds declared, gcc 12 warns of an overflow where there is none.
 */
static void stance_first(const ng_real (*by_leg)[NG_LEG_JOINTS], int leg,
                         ng_real actuated[NG_ACTUATED])
{
    const int skipped = 2 * NG_LEG_JOINTS - NG_ACTUATED; /* a shared hip, or the stance ankle */
    const int own = NG_LEG_JOINTS - NG_ANKLES;           /* of the stance leg */
    for (int i = 0; i < own; ++i) {
        actuated[i] = by_leg[leg][i + NG_ANKLES];
    }
    for (int i = own; i < NG_ACTUATED; ++i) {
        actuated[i] = by_leg[1 - leg][2 * NG_LEG_JOINTS - 1 - skipped - i];
    }
}

/* The inverse, with the value of a stance ankle, which is not among the actuated joints. */
void ng_by_legs(const ng_real actuated[NG_ACTUATED], ng_real ankle, int leg,
                ng_real by_leg[NG_LEGS][NG_LEG_JOINTS])
{
    by_leg[leg][0] = ankle; /* on point feet another joint's place, which is filled below */
    for (int i = NG_ANKLES; i < NG_LEG_JOINTS; ++i) {
        by_leg[leg][i] = actuated[i - NG_ANKLES];
    }
#if NG_HAS_TORSO
    for (int i = 0; i < NG_LEG_JOINTS; ++i) {
        by_leg[1 - leg][i] = actuated[NG_ACTUATED - 1 - i];
    }
#else
    for (int i = 0; i < NG_LEG_JOINTS - 1; ++i) {
        by_leg[1 - leg][i] = actuated[NG_ACTUATED - 1 - i];
    }
    by_leg[1 - leg][NG_LEG_JOINTS - 1] = -actuated[NG_LEG_JOINTS - 1];
#endif
}

void ng_coordinates(ng_real pitch, const ng_real (*by_leg)[NG_LEG_JOINTS], int leg,
                    ng_real q[NG_COORDINATES])
{
    stance_first(by_leg, leg, q + 1);
    q[0] = pitch;
    for (int i = 1; i < NG_COORDINATES; ++i) {
        q[0] -= ng_pitch_row[leg][i] * q[i];
    }
}

/* Let one period pass. Returns whether the swing foot has touched down. */
static int advance_stance(ng_state *state, const ng_measurement *reading)
{
    state->since_touchdown += NG_PERIOD;
    if (reading->normal_force[1 - state->leg] > NG_TOUCHDOWN_FORCE &&
        state->since_touchdown >= NG_LOCKOUT) {
        ng_real q[NG_COORDINATES], foot[2], hip[2];
        ng_coordinates(reading->pitch, reading->angles, state->leg, q);
        ng_feet(q, foot, hip);
        if (foot[0] > NG_TOUCHDOWN_ADVANCE) {
            state->leg = 1 - state->leg;
            state->since_touchdown = NG(0.0);
            return 1;
        }
    }
    return 0;
}

#if NG_COMMANDS
/* The policy of the step under way; z1 runs over the step's own interval. */
#define POLICY_RATE(dz, z, dy, y) ng_policy_rate(dz, state->step, z, dy, y)
#define POLICY_PATH(ddz, dz, z, drift, dy, slope, y) \
    ng_policy_path(ddz, dz, state->step, z, drift, dy, slope, y)
#define POLICY_ANKLE(z, slope, torque) ng_policy_ankle(state->step, z, slope, torque)
#define Z1_START state->step[0]
#define Z1_GUARD state->step[1]
#define Z1_MARGIN (NG_Z1_SHARE * (Z1_GUARD - Z1_START))

/* Begin a step: each command moves towards the requested one, by its largest change at most. */
static void latch(ng_state *state)
{
    for (int i = 0; i < NG_COMMANDS; ++i) {
        const ng_real last = state->after[i], change = ng_command_change[i];
        state->before[i] = last;
        state->after[i] = ng_clamp(state->requested[i], last - change, last + change);
    }
    ng_policy_step(state->after, state->before, state->step);
}
#else
#define POLICY_RATE ng_policy_rate
#define POLICY_PATH ng_policy_path
#define POLICY_ANKLE ng_policy_ankle
#define Z1_START ng_z_lower[0]
#define Z1_GUARD ng_z_upper[0]
#define Z1_MARGIN ng_z_margin[0]
#endif

/*
 * z as the policy gets it, with first two derivatives: unchanged to half the margin outside of its
 * bounds, then levelling off smoothly over a whole one.
 */
static void bounded(const ng_state *state, const ng_real z[2], ng_real value[2],
                    ng_real first[2], ng_real second[2])
{
    const ng_real lower[2] = {Z1_START, ng_z_lower[1]}, upper[2] = {Z1_GUARD, ng_z_upper[1]};
    const ng_real margins[2] = {Z1_MARGIN, ng_z_margin[1]};
    (void)state;
    for (int i = 0; i < 2; ++i) {
        const ng_real margin = margins[i], half = NG(0.5) * margin;
        const ng_real high = upper[i] + half, low = lower[i] - half;
        const ng_real over = z[i] > high ? z[i] - high : NG(0.0);
        const ng_real under = z[i] < low ? low - z[i] : NG(0.0);
        const ng_real t = ng_tanh(over / margin) - ng_tanh(under / margin);
        value[i] = z[i] - over + under + margin * t;
        first[i] = NG(1.0) - t * t;
        second[i] = NG(-2.0) * t * first[i] / margin;
    }
}

#if NG_ANKLES
/* Ask the policy for the torque of the stance ankle, and add it to the rates of z2. */
static void ask_ankle(const ng_law *law, const ng_state *state, const ng_real z[2],
                      ng_real dz[2], ng_real ddz2[1], ng_real *torque)
{
    ng_real at[2], first[2], second[2], slope[2];
    bounded(state, z, at, first, second);
    if (!law->measure_z2) {
        at[1] = first[1] = NG(0.0);
    }
    POLICY_ANKLE(at, slope, torque);
    dz[1] += *torque;
    ddz2[0] += slope[0] * first[0] * dz[0] + slope[1] * first[1] * dz[1];
}
#endif

/* Ask the policy at the measured z. */
static void ask(const ng_law *law, const ng_real z[2], const ng_real dz[2], ng_real ddz2,
                ng_state *state)
{
    ng_desired *held = &state->held;
    ng_real at[2], first[2], second[2], along[2], curved[2], slope[NG_ACTUATED];
    bounded(state, z, at, first, second);
    for (int i = 0; i < 2; ++i) {
        along[i] = first[i] * dz[i];
        curved[i] = second[i] * dz[i] * dz[i];
    }
    curved[1] += first[1] * ddz2;
    if (!law->measure_z2) {
        at[1] = along[1] = curved[1] = NG(0.0);
    }
    if (!law->model) {
        POLICY_RATE(along, at, held->dy, held->y);
        return;
    }
    POLICY_PATH(curved, along, at, held->drift, held->dy, slope, held->y);
    for (int i = 0; i < NG_ACTUATED; ++i) {
        held->slope[i] = slope[i] * first[0];
    }
}

/* The first of some rates or accelerations, from that of z1 and those of the actuated joints. */
static void lift(ng_real of_z1, ng_real of_q[NG_COORDINATES])
{
    of_q[0] = of_z1;
    for (int i = 1; i < NG_COORDINATES; ++i) {
        of_q[0] -= ng_hip_gradient[i] * of_q[i];
    }
    of_q[0] /= ng_hip_gradient[0];
}

/*
 * Solve for x = along x1 + rest, rates or accelerations, with row 1 of D x equal to -moment.
 * Returns x1, the rate or acceleration of z1. The caller gives along and rest of the actuated
 * joints; their first elements are filled in.
 */
static ng_real balanced(const ng_real mass[NG_COORDINATES * NG_COORDINATES], ng_real moment,
                        ng_real along[NG_COORDINATES], ng_real rest[NG_COORDINATES])
{
    ng_real denominator = NG(0.0);
    lift(NG(1.0), along);
    lift(NG(0.0), rest);
    for (int i = 0; i < NG_COORDINATES; ++i) {
        denominator += mass[i] * along[i];
        moment += mass[i] * rest[i];
    }
    ng_real size = ng_abs(denominator);
    size = size < NG_SMALLEST_DENOMINATOR ? NG_SMALLEST_DENOMINATOR : size;
    return moment / (denominator < NG(0.0) ? size : -size);
}

/*
 * The rates that meet the outputs at this momentum: joint rates measured at a touchdown are those
 * during the impact, while z2 already has its value after it.
 */
static void impact_consistent_rates(const ng_state *state, const ng_real q[NG_COORDINATES],
                                    const ng_real z[2], ng_real dz2, const ng_real *lean,
                                    ng_real dq[NG_COORDINATES])
{
    ng_real at[2], first[2], second[2], y[NG_ACTUATED];
    ng_real mass[NG_COORDINATES * NG_COORDINATES], bias[NG_COORDINATES];
    ng_real along[NG_COORDINATES], rest[NG_COORDINATES];
    bounded(state, z, at, first, second);
    const ng_real by_z1[2] = {first[0], NG(0.0)}, by_z2[2] = {NG(0.0), first[1] * dz2};
    POLICY_RATE(by_z1, at, along + 1, y);
    POLICY_RATE(by_z2, at, rest + 1, y);
    (void)lean;
    ng_dynamics(dq, NG_BELIEVED(lean) q, bias, mass);
    const ng_real dz1 = balanced(mass, z[1], along, rest);
    for (int i = 0; i < NG_COORDINATES; ++i) {
        dq[i] = along[i] * dz1 + rest[i];
    }
}

/*
 * The bias of the first row plus the torque at the foot: none on point feet, else the ankle's,
 * whose motor makes up for the joint's own friction.
 */
static ng_real moment_at_foot(ng_real bias, ng_real dq, ng_real ankle)
{
#if NG_ANKLES
    return bias - NG_ANKLE_DAMPING * dq + ankle;
#else
    (void)dq;
    (void)ankle;
    return bias;
#endif
}

/* Torques for ddq_a = slope ddz1 + rest, where ddz1 follows from the torque at the foot. */
static void inverse_dynamics(const ng_law *law, const ng_real q[NG_COORDINATES],
                             const ng_real dq[NG_COORDINATES], const ng_desired *wanted,
                             ng_real ankle, const ng_real *lean, ng_real torque[NG_ACTUATED])
{
    const ng_real w = law->bandwidth;
    ng_real mass[NG_COORDINATES * NG_COORDINATES], bias[NG_COORDINATES];
    ng_real along[NG_COORDINATES], rest[NG_COORDINATES];
    for (int i = 1; i < NG_COORDINATES; ++i) {
        const ng_real error = q[i] - wanted->y[i - 1], rate = dq[i] - wanted->dy[i - 1];
        along[i] = wanted->slope[i - 1];
        rest[i] = wanted->drift[i - 1] - w * w * error - NG(2.0) * w * rate;
    }
    (void)lean;
    ng_dynamics(dq, NG_BELIEVED(lean) q, bias, mass);
    const ng_real ddz1 = balanced(mass, moment_at_foot(bias[0], dq[0], ankle), along, rest);
    for (int i = 0; i < NG_ACTUATED; ++i) {
        torque[i] = bias[i + 1];
    }
    for (int j = 0; j < NG_COORDINATES; ++j) {
        const ng_real ddq = along[j] * ddz1 + rest[j];
        for (int i = 0; i < NG_ACTUATED; ++i) {
            torque[i] += mass[(i + 1) * NG_COORDINATES + j] * ddq;
        }
    }
}

/* A value inside its bounds, levelling off smoothly within the margin outside. */
static ng_real levelled_off(ng_real value, ng_real lower, ng_real upper, ng_real margin)
{
    const ng_real over = value > upper ? value - upper : NG(0.0);
    const ng_real under = value < lower ? lower - value : NG(0.0);
    return value - over + under +
           margin * (ng_tanh(over / margin) - ng_tanh(under / margin));
}

/* Chebyshev polynomials, T_(m + n) = 2 T_m T_n - T_(m - n) with m and n near half. */
static void chebyshev(ng_real x, int terms, ng_real values[NG_SERIES])
{
    values[0] = NG(1.0);
    values[1] = x;
    for (int k = 2; k < terms; ++k) {
        const int m = (k + 1) / 2, n = k / 2;
        values[k] = NG(2.0) * values[m] * values[n] - values[m - n];
    }
}

/* The values of `width` series of phase and level. */
static void series(const ng_real *table, const int terms[2], const ng_real *of_phase,
                   const ng_real *of_level, int width, ng_real *values)
{
    for (int k = 0; k < width; ++k) {
        values[k] = NG(0.0);
    }
    for (int i = 0; i < terms[0]; ++i) {
        for (int j = 0; j < terms[1]; ++j) {
            const ng_real term = of_phase[i] * of_level[j];
            for (int k = 0; k < width; ++k) {
                values[k] += *table++ * term;
            }
        }
    }
}

/* Torques u0 - M pull, u0 and M of the phase and the level of z. */
static void scheduled(const ng_schedule *of, const ng_real z[2], const ng_real pull[NG_ACTUATED],
                      ng_real torque[NG_ACTUATED])
{
    const ng_real half[2] = {NG(0.5) * of->margin[0], NG(0.5) * of->margin[1]};
    ng_real x[NG_SERIES], y[NG_SERIES] = {NG(1.0)}, fences[2], u[2];
    ng_real inertia[NG_ACTUATED * NG_ACTUATED];
    u[0] = levelled_off((z[0] - of->start) / of->stride, -half[0], NG(1.0) + half[0], half[0]);
    chebyshev(NG(2.0) * u[0] - NG(1.0), of->fence_terms[0], x);
    series(of->fences, of->fence_terms, x, y, 2, fences);
    u[1] = (NG(0.5) * z[1] * z[1] - fences[0]) / (fences[1] - fences[0]);
    u[1] = levelled_off(u[1], -half[1], NG(1.0) + half[1], half[1]);
    for (int i = 0; i < 2; ++i) {
        u[i] = (NG(2.0) * u[i] - NG(1.0)) / (NG(1.0) + NG(2.0) * of->margin[i]);
    }
    chebyshev(u[0], of->torque_terms[0], x);
    chebyshev(u[1], of->torque_terms[1], y);
    series(of->torque, of->torque_terms, x, y, NG_ACTUATED, torque);
    series(of->inertia, of->inertia_terms, x, y, NG_ACTUATED * NG_ACTUATED, inertia);
    for (int i = 0; i < NG_ACTUATED; ++i) {
        for (int j = 0; j < NG_ACTUATED; ++j) {
            torque[i] -= inertia[i * NG_ACTUATED + j] * pull[j];
        }
    }
}

/* The law's torques, before limits. */
static void torques(const ng_law *law, const ng_real z[2], const ng_real q[NG_COORDINATES],
                    const ng_real dq[NG_COORDINATES], const ng_desired *wanted,
                    ng_real ankle, const ng_real *lean, ng_real torque[NG_ACTUATED])
{
    for (int i = 0; i < NG_ACTUATED; ++i) {
        torque[i] = NG(0.0);
    }
    if (law->schedule) {
        const ng_real w = law->bandwidth;
        ng_real pull[NG_ACTUATED];
        for (int i = 0; i < NG_ACTUATED; ++i) {
            pull[i] = w * w * (q[i + 1] - wanted->y[i]) + NG(2.0) * w * (dq[i + 1] - wanted->dy[i]);
        }
        scheduled(law->schedule, z, pull, torque);
    }
    if (law->model) {
        inverse_dynamics(law, q, dq, wanted, ankle, lean, torque);
    }
    if (law->model || law->schedule) {
#ifdef NG_FRICTION_RATE
        for (int i = 0; i < NG_ACTUATED; ++i) {
            torque[i] += ng_friction[i] * ng_tanh(wanted->dy[i] / NG_FRICTION_RATE);
        }
#endif
    }
    for (int i = 0; i < NG_ACTUATED; ++i) {
        torque[i] -= law->stiffness[i] * (q[i + 1] - wanted->y[i]) +
                     law->damping[i] * (dq[i + 1] - wanted->dy[i]);
    }
}

/* Clip to the limits. Returns whether anything was clipped. */
static int saturate(const ng_config *config, ng_real torque[NG_ACTUATED])
{
    int clipped = 0;
    for (int i = 0; i < NG_ACTUATED; ++i) {
        const ng_real limit = config->torque_limit[i];
        clipped |= ng_abs(torque[i]) > limit;
        torque[i] = ng_clamp(torque[i], -limit, limit);
    }
    return clipped;
}

static int outside(ng_real value, ng_real largest) { return !(ng_abs(value) <= largest); }

static ng_fault check_joints(const ng_config *config, const ng_measurement *reading)
{
    for (int leg = 0; leg < NG_LEGS; ++leg) {
        for (int i = 0; i < NG_LEG_JOINTS; ++i) {
            const ng_real angle = reading->angles[leg][i];
            if (!(angle >= ng_joint_lower[leg][i] - config->angle_margin &&
                  angle <= ng_joint_upper[leg][i] + config->angle_margin)) {
                return NG_FAULT_ANGLE;
            }
            if (outside(reading->rates[leg][i], config->largest_rate)) {
                return NG_FAULT_RATE;
            }
        }
        if (outside(reading->normal_force[leg], config->largest_force)) {
            return NG_FAULT_FORCE;
        }
    }
    return NG_NO_FAULT;
}

static int all_finite(const ng_measurement *reading)
{
    int finite = ng_finite(reading->pitch) & ng_finite(reading->dpitch);
    for (int i = 0; i < 2; ++i) {
        finite &= ng_finite(reading->hip_velocity[i]);
    }
    for (int leg = 0; leg < NG_LEGS; ++leg) {
        finite &= ng_finite(reading->normal_force[leg]);
        for (int i = 0; i < NG_LEG_JOINTS; ++i) {
            finite &= ng_finite(reading->angles[leg][i]) & ng_finite(reading->rates[leg][i]);
        }
    }
    return finite;
}

ng_fault ng_check(const ng_config *config, const ng_state *state, const ng_measurement *reading)
{
    const uint32_t gap = reading->time_us - state->last_us; /* backwards: very long */
    if (!all_finite(reading)) {
        return NG_FAULT_NOT_FINITE;
    }
    if (outside(reading->pitch, config->largest_pitch)) {
        return NG_FAULT_PITCH;
    }
    if (outside(reading->dpitch, config->largest_rate)) {
        return NG_FAULT_RATE;
    }
    if (outside(reading->hip_velocity[0], config->largest_speed) ||
        outside(reading->hip_velocity[1], config->largest_speed)) {
        return NG_FAULT_SPEED;
    }
    if (state->running && (gap == 0u || gap > config->gap_us)) {
        return NG_FAULT_TIME;
    }
    return check_joints(config, reading);
}

/* Fault if both feet have been off the ground for too long. */
static ng_fault check_contact(const ng_config *config, ng_state *state,
                              const ng_measurement *reading)
{
    const int touching = reading->normal_force[0] >= config->contact_force ||
                         reading->normal_force[1] >= config->contact_force;
    state->airborne = touching ? NG(0.0) : state->airborne + NG_PERIOD;
    return state->airborne > config->airborne_s ? NG_FAULT_LOST_CONTACT : NG_NO_FAULT;
}

/* Blend from holding the first posture to the law, and limit the rates of torques. */
static ng_fault guard(const ng_config *config, ng_state *state, const ng_measurement *reading,
                      ng_real wanted[NG_LEGS][NG_LEG_JOINTS])
{
    const int blending = state->elapsed < config->blend_s;
    const ng_real s = blending ? state->elapsed / config->blend_s : NG(1.0);
    const ng_real share = s * s * (NG(3.0) - NG(2.0) * s);
    const ng_real change = config->torque_rate * NG_PERIOD;
    ng_real limits[NG_LEGS][NG_LEG_JOINTS];
    ng_by_legs(config->torque_limit, ANKLE_LIMIT, 0, limits);
    for (int leg = 0; leg < NG_LEGS; ++leg) {
        for (int i = 0; i < NG_LEG_JOINTS; ++i) {
            const ng_real limit = ng_abs(limits[leg][i]), before = state->torque[leg][i];
            ng_real torque = wanted[leg][i];
            if (blending) {
                const ng_real away = reading->angles[leg][i] - state->posture[leg][i];
                const ng_real hold = -config->hold_stiffness * away -
                                     config->hold_damping * reading->rates[leg][i];
                torque = (NG(1.0) - share) * ng_clamp(hold, -limit, limit) + share * torque;
            }
            torque = ng_clamp(torque, before - change, before + change);
            if (!ng_finite(torque)) {
                return NG_FAULT_TORQUE;
            }
            state->torque[leg][i] = torque;
        }
    }
    state->elapsed = blending ? state->elapsed + NG_PERIOD : state->elapsed;
    return NG_NO_FAULT;
}

/* Zero torque from now on. */
static void stop(ng_state *state, ng_fault fault, ng_command *command)
{
    const ng_command nothing = {0};
    *command = nothing;
    for (int leg = 0; leg < NG_LEGS; ++leg) {
        for (int i = 0; i < NG_LEG_JOINTS; ++i) {
            state->torque[leg][i] = NG(0.0);
        }
    }
    state->fault = command->fault = fault;
    command->leg = state->leg;
}

/* Compute the law's torques; advance stance, commands and held outputs by one tick. */
static void follow(const ng_config *config, ng_state *state, const ng_measurement *reading,
                   ng_command *command, ng_real wanted[NG_LEGS][NG_LEG_JOINTS])
{
    const ng_law *law = config->law;
    ng_real dz[2], ddz2[1], measured[NG_COORDINATES];
    command->touchdown = advance_stance(state, reading);
#if NG_COMMANDS
    if (command->touchdown) {
        latch(state);
    }
#endif
    ng_coordinates(reading->pitch, reading->angles, state->leg, command->q);
    ng_coordinates(reading->dpitch, reading->rates, state->leg, command->dq);
    command->lean = NG(0.0);
#if NG_LEAN_COMMAND
    command->lean = state->after[NG_LEAN_COMMAND - 1];
#endif
    ng_zero_state(command->dq, reading->hip_velocity, NG_BELIEVED(&command->lean) command->q, ddz2,
                  dz, command->z);
    command->ankle = NG(0.0);
#if NG_ANKLES
    const ng_real by_weight = ddz2[0];
    ask_ankle(law, state, command->z, dz, ddz2, &command->ankle);
    const ng_real ankle_rate = ddz2[0] - by_weight;
#endif
    state->ankle = command->ankle;
    for (int i = 0; i < NG_COORDINATES; ++i) {
        measured[i] = command->dq[i];
    }
    if (command->touchdown && law->uses_impact_consistent_rates) {
        ng_real pinned_z[2]; /* not what is measured */
        impact_consistent_rates(state, command->q, command->z, dz[1], &command->lean, command->dq);
        ng_zero_state(command->dq, reading->hip_velocity, NG_BELIEVED(&command->lean) command->q,
                      ddz2, dz, pinned_z);
#if NG_ANKLES
        dz[1] += command->ankle;
        ddz2[0] += ankle_rate;
#endif
    }
    /* When the hold is over; and at a touchdown, since held outputs are for the old stance. */
    if (command->touchdown || state->ticks_to_policy <= 0) {
        ask(law, command->z, dz, ddz2[0], state);
        state->ticks_to_policy = law->hold_ticks;
    }
    state->ticks_to_policy -= 1;
    ng_desired desired = state->held;
    for (int i = 0; i < NG_ACTUATED; ++i) {
        desired.y[i] += state->shift[i];
        desired.dy[i] += state->shift_rate[i];
    }
    torques(law, command->z, command->q, command->dq, &desired, command->ankle, &command->lean,
            command->actuated);
    command->relaxed[0] = command->relaxed[1] = 0;
    command->saturated = law->apply_limits
                             ? law->apply_limits(config, &desired, command)
                             : saturate(config, command->actuated);
    const ng_real ankle = moment_at_foot(NG(0.0), command->dq[0], command->ankle);
    ng_by_legs(command->actuated, ng_clamp(-ankle, -ANKLE_LIMIT, ANKLE_LIMIT), state->leg, wanted);
    for (int i = 0; i < NG_COORDINATES; ++i) {
        command->dq[i] = measured[i];
    }
    for (int i = 0; i < NG_ACTUATED; ++i) {
        command->y_d[i] = desired.y[i];
        command->dy_d[i] = desired.dy[i];
    }
    command->leg = state->leg;
    command->since_touchdown = state->since_touchdown;
}

void ng_step(const ng_config *config, ng_state *state, const ng_measurement *reading,
             ng_command *command)
{
    ng_real wanted[NG_LEGS][NG_LEG_JOINTS];
    ng_fault fault = state->fault != NG_NO_FAULT ? state->fault : ng_check(config, state, reading);
    if (fault == NG_NO_FAULT) {
        fault = check_contact(config, state, reading);
    }
    if (fault != NG_NO_FAULT) {
        stop(state, fault, command);
        return;
    }
    if (!state->running) {
        for (int leg = 0; leg < NG_LEGS; ++leg) {
            for (int i = 0; i < NG_LEG_JOINTS; ++i) {
                state->posture[leg][i] = reading->angles[leg][i];
            }
        }
        state->running = 1;
    }
    state->last_us = reading->time_us;
    follow(config, state, reading, command, wanted);
    fault = guard(config, state, reading, wanted);
    if (fault != NG_NO_FAULT) {
        stop(state, fault, command);
        return;
    }
    command->fault = NG_NO_FAULT;
    for (int leg = 0; leg < NG_LEGS; ++leg) {
        for (int i = 0; i < NG_LEG_JOINTS; ++i) {
            command->torque[leg][i] = state->torque[leg][i];
        }
    }
}

void ng_start(ng_state *state, int leg)
{
    const ng_state fresh = {0};
    *state = fresh;
    state->leg = leg != 0;
    state->since_touchdown = NG_NEVER;
#if NG_COMMANDS
    for (int i = 0; i < NG_COMMANDS; ++i) {
        state->requested[i] = NG(0.5) * (ng_command_low[i] + ng_command_high[i]);
        state->before[i] = state->after[i] = state->requested[i];
    }
    ng_policy_step(state->after, state->before, state->step);
#endif
}

#if NG_COMMANDS
void ng_start_at(ng_state *state, int leg, const ng_real requested[NG_COMMANDS])
{
    ng_start(state, leg);
    ng_tell(state, requested);
    for (int i = 0; i < NG_COMMANDS; ++i) {
        state->before[i] = state->after[i] = state->requested[i];
    }
    ng_policy_step(state->after, state->before, state->step);
}

int ng_tell(ng_state *state, const ng_real requested[NG_COMMANDS])
{
    int refused = 0;
    for (int i = 0; i < NG_COMMANDS; ++i) {
        const ng_real given = requested[i];
        if (given == given) {
            state->requested[i] = ng_clamp(given, ng_command_low[i], ng_command_high[i]);
        }
        refused += !(given >= ng_command_low[i] && given <= ng_command_high[i]);
    }
    return refused;
}
#endif

ng_config ng_config_of(const ng_law *law)
{
    ng_config config = {
        .law = law,
        .torque_rate = NG_TORQUE_RATE,
        .blend_s = NG(0.0),
        .hold_stiffness = NG_HOLD_STIFFNESS,
        .hold_damping = NG_HOLD_DAMPING,
        .largest_pitch = NG_LARGEST_PITCH,
        .angle_margin = NG_ANGLE_MARGIN,
        .largest_rate = NG_LARGEST_RATE,
        .largest_speed = NG_LARGEST_SPEED,
        .largest_force = NG_LARGEST_FORCE,
        .contact_force = NG_CONTACT_FORCE,
        .airborne_s = NG_AIRBORNE,
        .gap_us = NG_GAP_US,
    };
    for (int i = 0; i < NG_ACTUATED; ++i) {
        config.torque_limit[i] = ng_torque_limit[i];
    }
    return config;
}

void ng_measure(const ng_encoders *encoders, ng_measurement *reading)
{
    const ng_real sine = ng_sin(NG_PITCH_SIGN * encoders->pitch);
    const ng_real cosine = ng_cos(NG_PITCH_SIGN * encoders->pitch);
    const ng_real arm_x = NG_ROOT_TO_HIP_X * cosine - NG_ROOT_TO_HIP_Z * sine;
    const ng_real arm_z = NG_ROOT_TO_HIP_X * sine + NG_ROOT_TO_HIP_Z * cosine;
    reading->time_us = encoders->time_us;
    reading->pitch = NG_PITCH_SIGN * encoders->pitch + NG_ROOT_ANGLE;
    reading->dpitch = NG_PITCH_SIGN * encoders->dpitch;
    reading->hip_velocity[0] = encoders->base_velocity[0] - reading->dpitch * arm_z;
    reading->hip_velocity[1] = encoders->base_velocity[1] + reading->dpitch * arm_x;
    for (int leg = 0; leg < NG_LEGS; ++leg) {
        reading->normal_force[leg] = encoders->normal_force[leg];
        for (int i = 0; i < NG_LEG_JOINTS; ++i) {
            const ng_real sign = ng_joint_sign[leg][i];
            reading->angles[leg][i] = sign * encoders->joints[leg][i] + ng_joint_offset[leg][i];
            reading->rates[leg][i] = sign * encoders->djoints[leg][i];
        }
    }
}

void ng_drive(const ng_command *command, ng_real motors[NG_LEGS][NG_LEG_JOINTS])
{
    for (int leg = 0; leg < NG_LEGS; ++leg) {
        for (int i = 0; i < NG_LEG_JOINTS; ++i) {
            motors[leg][i] = command->torque[leg][i] / ng_gear[leg][i];
        }
    }
}

void ng_impedance(const ng_measurement *reading, const ng_command *command, ng_real kp, ng_real kd,
                  ng_target targets[NG_LEGS][NG_LEG_JOINTS])
{
    const ng_target damped = {NG(0.0), NG(0.0), NG(0.0), kd, NG(0.0)};
    const int own = command->leg;
    ng_real y[NG_LEGS][NG_LEG_JOINTS], dy[NG_LEGS][NG_LEG_JOINTS];
    /* No output says where a stance ankle shall be: it stays where it is. */
    ng_by_legs(command->y_d, reading->angles[own][0], own, y);
    ng_by_legs(command->dy_d, reading->rates[own][0], own, dy);
    for (int leg = 0; leg < NG_LEGS; ++leg) {
        for (int i = 0; i < NG_LEG_JOINTS; ++i) {
            const ng_real sign = ng_joint_sign[leg][i];
            const ng_real ahead = kp * (y[leg][i] - reading->angles[leg][i]) +
                                  kd * (dy[leg][i] - reading->rates[leg][i]);
            ng_target *target = &targets[leg][i];
            *target = damped;
            if (command->fault == NG_NO_FAULT) {
                target->q_des = sign * (y[leg][i] - ng_joint_offset[leg][i]);
                target->dq_des = sign * dy[leg][i];
                target->kp = kp;
                target->tau_ff = sign * (command->torque[leg][i] - ahead);
            }
        }
    }
}

const char *ng_fault_text(ng_fault fault)
{
    switch (fault) {
    case NG_NO_FAULT:
        return "no fault";
    case NG_FAULT_NOT_FINITE:
        return "a reading is NaN or infinite";
    case NG_FAULT_PITCH:
        return "the torso has tipped over";
    case NG_FAULT_ANGLE:
        return "a joint angle is far outside its range";
    case NG_FAULT_RATE:
        return "a joint or pitch rate is too large";
    case NG_FAULT_SPEED:
        return "the hip speed is too large";
    case NG_FAULT_FORCE:
        return "a ground force is too large";
    case NG_FAULT_TIME:
        return "readings are too far apart or out of order";
    case NG_FAULT_LOST_CONTACT:
        return "both feet are off the ground";
    case NG_FAULT_TORQUE:
        return "a torque is not finite";
    }
    return "unknown fault";
}
