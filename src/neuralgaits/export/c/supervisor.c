/* See supervisor.h. */
#include "supervisor.h"

#define LIGHT_REAR_FOOT (3 * NG_STAND_KNOTS / 4) /* knot at which it carries an eighth */

/* Parts of the modes. */
enum { FEET_APART, MOVING, HOLDING }; /* of NG_STAND: where a walk ended; on the way; there */
enum { LEANING, STEPPING };           /* of NG_WALK */
enum { LAST_STEPS, ON_TWO_FEET };     /* of NG_STOP */

static ng_real smooth(ng_real s)
{
    const ng_real t = ng_clamp(s, NG(0.0), NG(1.0));
    return t * t * (NG(3.0) - NG(2.0) * t);
}

static ng_real smooth_rate(ng_real s)
{
    return s > NG(0.0) && s < NG(1.0) ? NG(6.0) * s * (NG(1.0) - s) : NG(0.0);
}

/* Where a robot is, seen from the foot of one leg. */
typedef struct {
    ng_real q[NG_COORDINATES], dq[NG_COORDINATES];
    ng_real foot[2]; /* the other foot [m] */
    ng_real z[2];
    ng_real ahead;   /* centre of mass from this leg's foot [m] */
    ng_real tips;    /* momentum beyond what just tips over this foot [kg m^2/s] */
} ng_pose;

static void look(const ng_measurement *reading, int leg, ng_pose *pose)
{
    ng_real dz[2], ddz2[1], hip[2];
    ng_coordinates(reading->pitch, reading->angles, leg, pose->q);
    ng_coordinates(reading->dpitch, reading->rates, leg, pose->dq);
    ng_feet(pose->q, pose->foot, hip);
    const ng_real lean = NG(0.0); /* of the robot's file */
    (void)lean;
    ng_zero_state(pose->dq, reading->hip_velocity, NG_BELIEVED(&lean) pose->q, ddz2, dz, pose->z);
    pose->ahead = dz[1] / NG_WEIGHT; /* the weight's moment is all that changes the momentum */
    pose->tips = pose->z[1] + dz[1] / NG_PENDULUM;
}

/* The leg that is ahead. */
static int front_leg(const ng_measurement *reading)
{
    ng_pose pose;
    look(reading, 0, &pose);
    return pose.foot[0] > NG(0.0);
}

/* In mid-step the leg that feels the floor; without a force the lower one, and else the front. */
static int standing_leg(const ng_measurement *reading, int front)
{
    ng_pose pose;
    const ng_real *force = reading->normal_force;
    if ((force[0] >= NG_CONTACT_FORCE) != (force[1] >= NG_CONTACT_FORCE)) {
        return force[1] >= NG_CONTACT_FORCE;
    }
    look(reading, 0, &pose);
    return pose.foot[1] == NG(0.0) ? front : pose.foot[1] < NG(0.0);
}

static void enter(ng_supervisor *own, ng_mode mode, int part)
{
    if (own->mode != mode) {
        own->in_mode = NG(0.0);
    }
    own->mode = mode;
    own->part = part;
    own->knot = 0;
    own->apart = NG(0.0);
    own->elapsed = NG(0.0);
}

static void change(ng_supervisor *own, ng_mode mode, int part, ng_reason reason,
                   ng_supervision *decided)
{
    enter(own, mode, part);
    decided->mode = mode;
    decided->reason = reason;
}

/* Damp until the operator has requested that. */
static void give_up(ng_supervisor *own, ng_reason reason, ng_supervision *decided)
{
    own->refused = 1;
    change(own, NG_DAMP, 0, reason, decided);
}

/* Where a tick decides a second time, its torques still change from those of the tick before. */
static void copy_torques(const ng_real (*from)[NG_LEG_JOINTS], ng_real (*to)[NG_LEG_JOINTS])
{
    for (int leg = 0; leg < NG_LEGS; ++leg) {
        for (int i = 0; i < NG_LEG_JOINTS; ++i) {
            to[leg][i] = from[leg][i];
        }
    }
}

/* The controller's state for another stance leg; torques go on from those of the last tick. */
static void stand_on(ng_supervisor *own, int leg)
{
    const ng_state last = own->state;
#if NG_COMMANDS
    ng_start_at(&own->state, leg, last.requested);
#else
    ng_start(&own->state, leg);
#endif
    copy_torques(last.torque, own->state.torque);
    own->state.running = last.running;
    own->state.last_us = last.last_us;
    own->state.elapsed = last.elapsed;
}

/* Torques within limits of size and rate. */
static void give(const ng_config *config, ng_supervisor *own,
                 const ng_real wanted[NG_LEGS][NG_LEG_JOINTS], ng_command *command)
{
#if NG_ANKLES
    const ng_real ankle_limit = NG_ANKLE_LIMIT;
#else
    const ng_real ankle_limit = NG(0.0);
#endif
    const ng_real change = config->torque_rate * NG_PERIOD;
    ng_real limits[NG_LEGS][NG_LEG_JOINTS];
    ng_by_legs(config->torque_limit, ankle_limit, 0, limits);
    for (int leg = 0; leg < NG_LEGS; ++leg) {
        for (int i = 0; i < NG_LEG_JOINTS; ++i) {
            const ng_real limit = ng_abs(limits[leg][i]), before = own->state.torque[leg][i];
            ng_real torque = ng_clamp(wanted[leg][i], -limit, limit);
            torque = ng_clamp(torque, before - change, before + change);
            own->state.torque[leg][i] = command->torque[leg][i] = torque;
        }
    }
}

/* Hold desired coordinates with the gains of the configuration. */
static void hold(const ng_supervisor_config *config, ng_supervisor *own, const ng_pose *pose,
                 const ng_real desired[NG_COORDINATES], const ng_real rates[NG_COORDINATES],
                 ng_command *command)
{
    ng_real off[NG_COORDINATES], rate[NG_COORDINATES], wanted[NG_LEGS][NG_LEG_JOINTS];
    ng_real angle[NG_LEGS][NG_LEG_JOINTS], speed[NG_LEGS][NG_LEG_JOINTS];
    for (int i = 0; i < NG_COORDINATES; ++i) {
        off[i] = desired[i] - pose->q[i];
        rate[i] = rates[i] - pose->dq[i];
        command->q[i] = pose->q[i];
        command->dq[i] = pose->dq[i];
    }
    for (int i = 0; i < NG_ACTUATED; ++i) {
        command->y_d[i] = desired[i + 1];
        command->dy_d[i] = rates[i + 1];
    }
    command->leg = own->state.leg;
    command->z[0] = pose->z[0];
    command->z[1] = pose->z[1];
    command->since_touchdown = own->state.since_touchdown;
    ng_by_legs(off + 1, off[0], own->state.leg, angle);
    ng_by_legs(rate + 1, rate[0], own->state.leg, speed);
    for (int leg = 0; leg < NG_LEGS; ++leg) {
        for (int i = 0; i < NG_LEG_JOINTS; ++i) {
            wanted[leg][i] = config->kp[i] * angle[leg][i] + config->kd[i] * speed[leg][i];
        }
    }
    give(&config->walk, own, (const ng_real(*)[NG_LEG_JOINTS])wanted, command);
}

/* From the posture at the beginning of this part to another one. */
static void move_to(const ng_supervisor_config *config, ng_supervisor *own, const ng_pose *pose,
                    const ng_real to[NG_COORDINATES], ng_command *command)
{
    ng_real desired[NG_COORDINATES], rates[NG_COORDINATES];
    const ng_real s = own->elapsed / own->move_s;
    for (int i = 0; i < NG_COORDINATES; ++i) {
        const ng_real way = to[i] - own->from[i];
        desired[i] = own->from[i] + smooth(s) * way;
        rates[i] = smooth_rate(s) * way / own->move_s;
    }
    hold(config, own, pose, desired, rates, command);
}

/* Somewhere on the path from standing to the first step, at a rate of knots a second. */
static void along(const ng_supervisor_config *config, ng_supervisor *own, const ng_pose *pose,
                  ng_real at, ng_real rate, ng_command *command)
{
    ng_real desired[NG_COORDINATES], rates[NG_COORDINATES];
    int knot = (int)at;
    knot = knot > NG_STAND_KNOTS - 2 ? NG_STAND_KNOTS - 2 : knot;
    for (int i = 0; i < NG_COORDINATES; ++i) {
        const ng_real a = ng_stand_path[knot][i], b = ng_stand_path[knot + 1][i];
        desired[i] = a + (at - (ng_real)knot) * (b - a);
        rates[i] = (b - a) * rate;
    }
    hold(config, own, pose, desired, rates, command);
}

static ng_real furthest(const ng_real a[NG_COORDINATES], const ng_real b[NG_COORDINATES])
{
    ng_real found = NG(0.0);
    for (int i = 1; i < NG_COORDINATES; ++i) {
        const ng_real off = ng_abs(a[i] - b[i]);
        found = off > found ? off : found;
    }
    return found;
}

/*
 * Follow the pitch, slowly. On two feet no estimate of the robot's turning holds, which takes one
 * of them for the pivot: it rests if its pitch is where it was for some time.
 */
static void follow_pitch(const ng_supervisor_config *config, ng_supervisor *own, ng_real pitch)
{
    const ng_real off = pitch - own->pitch;
    own->pitch += off * NG_PERIOD / config->rest_s;
    const int still = ng_abs(off) <= config->at_rest * config->rest_s;
    own->still_s = still ? own->still_s + NG_PERIOD : NG(0.0);
}

/* Whether neither a joint moves, nor the whole robot. */
static int at_rest(const ng_supervisor_config *config, const ng_supervisor *own,
                   const ng_pose *pose)
{
    static const ng_real rest[NG_COORDINATES];
    return own->still_s >= NG(3.0) * config->rest_s &&
           furthest(pose->dq, rest) <= config->at_rest;
}

/* Begin to move from where the robot is; the fastest joint takes its rate. */
static void begin_move(const ng_supervisor_config *config, ng_supervisor *own,
                       const ng_pose *pose, const ng_real to[NG_COORDINATES])
{
    for (int i = 0; i < NG_COORDINATES; ++i) {
        own->from[i] = pose->q[i];
    }
    own->move_s = NG(1.5) * furthest(pose->q, to) / config->joint_rate;
    own->move_s = own->move_s < config->settle_s ? config->settle_s : own->move_s;
}

/*
 * Stand with the feet apart. The centre of mass goes to the other side of where it is going to,
 * which its weight alone would not stop.
 */
static void balance(const ng_supervisor_config *config, ng_supervisor *own, const ng_pose *pose,
                    ng_real desired[NG_COORDINATES])
{
    const ng_real between = ng_abs(pose->foot[0]) + NG_TOUCHDOWN_ADVANCE;
    const ng_real going = pose->tips * NG_PENDULUM / (NG_WEIGHT * between) + NG(0.5);
    const ng_real step = config->balance_rate * NG_PERIOD;
    const ng_real left = NG(1.0) - smooth((own->in_step - config->balance_s) / config->balance_s);
    const ng_real gain = own->mode == NG_STOP ? left * config->balance : NG(0.0);
    const ng_real place = ng_clamp(NG(0.5) - gain * going, NG(0.0), NG(1.0));
    own->place = ng_clamp(place, own->place - step, own->place + step);
    for (int i = 0; i < NG_COORDINATES; ++i) {
        desired[i] = ng_wide_path[0][i] + own->place * (ng_wide_path[1][i] - ng_wide_path[0][i]);
    }
}

/* Joints only damp; a rate that no joint has is none to act on. */
static void damp(const ng_supervisor_config *config, ng_supervisor *own,
                 const ng_measurement *reading, ng_command *command)
{
    ng_real wanted[NG_LEGS][NG_LEG_JOINTS];
    const ng_command nothing = {0};
    *command = nothing;
    copy_torques((const ng_real(*)[NG_LEG_JOINTS])own->given, own->state.torque);
    for (int leg = 0; leg < NG_LEGS; ++leg) {
        for (int i = 0; i < NG_LEG_JOINTS; ++i) {
            const ng_real rate = reading->rates[leg][i];
            const int known = ng_abs(rate) <= config->walk.largest_rate;
            const ng_target damped = {NG(0.0), NG(0.0), NG(0.0), config->kd[i], NG(0.0)};
            wanted[leg][i] = known ? -config->kd[i] * rate : NG(0.0);
            own->targets[leg][i] = damped;
        }
    }
    command->leg = own->state.leg;
    command->since_touchdown = own->state.since_touchdown;
    command->fault = own->state.fault;
    give(&config->walk, own, (const ng_real(*)[NG_LEG_JOINTS])wanted, command);
}

/* Whether the centre of mass is too far outside of the feet to come back; not in the air. */
static int tipped_over(const ng_supervisor_config *config, const ng_measurement *reading,
                       const ng_pose *pose)
{
    const ng_real *foot = pose->foot, *force = reading->normal_force;
    if (force[0] < config->walk.contact_force && force[1] < config->walk.contact_force) {
        return 0;
    }
    const ng_real first = foot[0] < NG(0.0) ? foot[0] : NG(0.0);
    const ng_real last = foot[0] > NG(0.0) ? foot[0] : NG(0.0);
    return pose->ahead > last + config->over_foot || pose->ahead < first - config->over_foot;
}

static int both_feet(const ng_supervisor_config *config, const ng_measurement *reading)
{
    return reading->normal_force[0] >= config->walk.contact_force &&
           reading->normal_force[1] >= config->walk.contact_force;
}

/* What a walk still waits for. */
static ng_waiting waiting(const ng_supervisor_config *config, const ng_supervisor *own,
                          const ng_measurement *reading, const ng_pose *pose)
{
    if (own->mode != NG_STAND || own->part != HOLDING) {
        return NG_FOR_STANDING;
    }
    if (!both_feet(config, reading)) {
        return NG_FOR_TWO_FEET;
    }
    if (furthest(pose->q, ng_stand_path[0]) > config->near_posture) {
        return NG_FOR_POSTURE;
    }
    return at_rest(config, own, pose) ? NG_NOTHING : NG_FOR_REST;
}

/* Begin to walk on a leg; what the robot does now fades into what the gait wants. */
static void begin_walk(ng_supervisor *own, const ng_supervisor_config *config,
                       const ng_measurement *reading, int leg)
{
    stand_on(own, leg);
    own->state.running = 0; /* the reading has been checked, and may have been used at this tick */
    ng_state trial = own->state;
    ng_command command;
    ng_step(&config->walk, &trial, reading, &command);
    for (int i = 0; i < NG_ACTUATED; ++i) {
        own->lead[i] = command.q[i + 1] - command.y_d[i];
        own->lead_rate[i] = command.dq[i + 1] - command.dy_d[i];
    }
    own->in_step = NG(0.0);
}

/* Share of the step that is over. */
static ng_real phase_of(const ng_state *state, ng_real z1)
{
#if NG_COMMANDS
    return (z1 - state->step[0]) / (state->step[1] - state->step[0]);
#else
    (void)state;
    return (z1 - ng_z_lower[0]) / (ng_z_upper[0] - ng_z_lower[0]);
#endif
}

/* Whether a robot in mid-step may go on with the gait, standing on a leg. */
static int on_the_gait(const ng_supervisor_config *config, const ng_supervisor *own,
                       const ng_measurement *reading, int leg)
{
    ng_supervisor trial = *own;
    ng_pose pose;
    look(reading, leg, &pose);
    begin_walk(&trial, config, reading, leg);
    const ng_real phase = phase_of(&trial.state, pose.z[0]);
    int near = phase >= NG(0.0) && phase <= NG(1.0) && pose.z[1] >= ng_z_lower[1] &&
               pose.z[1] <= ng_z_upper[1];
    for (int i = 0; i < NG_ACTUATED; ++i) {
        near &= ng_abs(trial.lead[i]) <= config->near_gait;
    }
    return near;
}

/* A step of the gait with its outputs shifted. */
static void shifted_step(const ng_supervisor_config *config, ng_supervisor *own,
                         const ng_measurement *reading, ng_command *command)
{
    ng_state *state = &own->state;
    const ng_state before = *state;
    ng_step(&config->walk, state, reading, command);
    if (command->touchdown) {
        /* The shift was one of the other leg's step. */
        *state = before;
        own->in_step = NG(0.0);
        for (int i = 0; i < NG_ACTUATED; ++i) {
            state->shift[i] = state->shift_rate[i] = own->lead[i] = own->lead_rate[i] = NG(0.0);
        }
        ng_step(&config->walk, state, reading, command);
    }
}

/* What is left of the lead: a cubic from it and its rate to nothing. */
static void fade(const ng_supervisor_config *config, ng_supervisor *own)
{
    const ng_real T = config->fade_s, t = own->elapsed, s = t / T;
    for (int i = 0; i < NG_ACTUATED; ++i) {
        ng_real value = NG(0.0), rate = NG(0.0);
        if (s < NG(1.0)) {
            const ng_real left = NG(1.0) - s, a = own->lead[i], b = own->lead_rate[i];
            value = left * left * (a * (NG(1.0) + NG(2.0) * s) + b * t);
            rate = left * (b * (NG(1.0) - NG(3.0) * s) - NG(6.0) * a * s / T);
        }
        own->state.shift[i] = value;
        own->state.shift_rate[i] = rate;
    }
}

/* Steps that do not come: back to standing. Returns whether that is so. */
static int stalled(const ng_supervisor_config *config, ng_supervisor *own,
                   const ng_measurement *reading, ng_pose *pose, ng_supervision *decided)
{
    if (own->in_step <= config->step_timeout_s) {
        return 0;
    }
    if (!NG_HAS_STANDING) {
        give_up(own, NG_TOO_LATE, decided); /* no posture to go back to */
        return 1;
    }
    stand_on(own, front_leg(reading));
    look(reading, own->state.leg, pose);
    begin_move(config, own, pose, ng_stand_path[0]);
    change(own, NG_STAND, MOVING, NG_TOO_LATE, decided);
    return 1;
}

/* Lean forward, both feet on the floor. Returns whether the first step may begin. */
static int lean(const ng_supervisor_config *config, ng_supervisor *own, const ng_pose *pose,
                ng_supervision *decided)
{
    const ng_real s = own->elapsed / config->lean_s, knots = (ng_real)(NG_STAND_KNOTS - 1);
    if (pose->tips > config->first_momentum) {
        return 1;
    }
    along(config, own, pose, knots * smooth(s), knots * smooth_rate(s) / config->lean_s,
          &decided->command);
    if (own->elapsed > config->lean_timeout_s) {
        begin_move(config, own, pose, ng_stand_path[0]);
        change(own, NG_STAND, MOVING, NG_TOO_LATE, decided);
    }
    return 0;
}

static void walk(const ng_supervisor_config *config, ng_supervisor *own,
                 const ng_measurement *reading, ng_pose *pose, ng_supervision *decided)
{
    if (own->part == LEANING) {
        if (!lean(config, own, pose, decided)) {
            return;
        }
        begin_walk(own, config, reading, own->state.leg);
        enter(own, NG_WALK, STEPPING);
    }
    if (stalled(config, own, reading, pose, decided)) {
        if (own->mode == NG_STAND) {
            move_to(config, own, pose, ng_stand_path[0], &decided->command);
        }
        return;
    }
    fade(config, own);
    shifted_step(config, own, reading, &decided->command);
}

/* Put the foot of the last step further ahead than the gait does. */
static void brake(const ng_supervisor_config *config, ng_supervisor *own, const ng_pose *pose)
{
    ng_state *state = &own->state;
    const ng_real width = config->brake_to - config->brake_from;
    const ng_real phase = phase_of(state, pose->z[0]);
    const ng_real s = smooth((phase - config->brake_from) / width);
    for (int i = 0; i < NG_ACTUATED; ++i) {
        const ng_real away = ng_braking[i + 1] - state->held.y[i];
        state->shift[i] += s * (away - state->shift[i]);
        state->shift_rate[i] += s * (-state->held.dy[i] - state->shift_rate[i]);
    }
}

/* Steps up to the touchdown of one that brakes. Returns whether that has come. */
static int last_steps(const ng_supervisor_config *config, ng_supervisor *own,
                      const ng_measurement *reading, ng_pose *pose, ng_supervision *decided)
{
    if (stalled(config, own, reading, pose, decided)) {
        if (own->mode == NG_STAND) {
            move_to(config, own, pose, ng_stand_path[0], &decided->command);
        }
        return 0;
    }
    fade(config, own);
    if (own->steps_to_brake == 0) {
        brake(config, own, pose);
    }
    shifted_step(config, own, reading, &decided->command);
    if (!decided->command.touchdown || own->steps_to_brake-- > 0) {
        return 0;
    }
    copy_torques((const ng_real(*)[NG_LEG_JOINTS])own->given, own->state.torque);
    look(reading, own->state.leg, pose);
    own->place = NG(0.5);
    begin_move(config, own, pose, ng_wide_path[0]);
    enter(own, NG_STOP, ON_TWO_FEET);
    own->braked += 1;
    return 1;
}

static void stop(const ng_supervisor_config *config, ng_supervisor *own,
                 const ng_measurement *reading, ng_pose *pose, ng_supervision *decided)
{
    if (own->part == LAST_STEPS && !last_steps(config, own, reading, pose, decided)) {
        return;
    }
    if (pose->tips > NG(0.0) && pose->foot[0] < NG(0.0) && own->braked < config->brakes) {
        /* It would tip over the foot in front: one more step. */
        begin_walk(own, config, reading, own->state.leg);
        own->state.since_touchdown = NG(0.0);
        own->steps_to_brake = 0;
        enter(own, NG_STOP, LAST_STEPS);
        fade(config, own);
        shifted_step(config, own, reading, &decided->command);
        return;
    }
    ng_real wide[NG_COORDINATES];
    balance(config, own, pose, wide);
    move_to(config, own, pose, wide, &decided->command);
    if (own->elapsed > own->move_s && both_feet(config, reading) &&
        at_rest(config, own, pose)) {
        change(own, NG_STAND, FEET_APART, NG_SETTLED, decided);
    } else if (own->elapsed > config->stop_timeout_s) {
        give_up(own, NG_TOO_LATE, decided);
    }
}

/*
 * Move to the standing posture. Friction may hold a foot where it is: then lean forward, where the
 * rear foot carries little and gives way, and back again. If it does not, more tries are in vain.
 */
static void move_to_standing(const ng_supervisor_config *config, ng_supervisor *own,
                             const ng_pose *pose, ng_supervision *decided)
{
    const ng_real *posture = ng_stand_path[own->knot];
    move_to(config, own, pose, posture, &decided->command);
    if (own->elapsed <= own->move_s) {
        return;
    }
    const ng_real off = furthest(pose->q, posture), apart = ng_abs(pose->foot[0]);
    const int tried = own->knot == 0 && own->elapsed > own->move_s + config->settle_s;
    if (own->knot == 0 && off <= config->near_posture) {
        enter(own, NG_STAND, HOLDING);
    } else if (own->in_mode > config->stand_timeout_s) {
        give_up(own, NG_TOO_LATE, decided);
    } else if (tried && own->apart > NG(0.0) && own->apart - apart < config->feet_held &&
               off > NG(2.0) * config->near_posture) {
        give_up(own, NG_FEET_HELD, decided);
    } else if (own->elapsed > own->move_s + config->settle_s) {
        const int knot = own->knot == 0 ? LIGHT_REAR_FOOT : 0;
        const ng_real last = tried ? apart : own->apart;
        begin_move(config, own, pose, ng_stand_path[knot]);
        enter(own, NG_STAND, MOVING);
        own->knot = knot;
        own->apart = last;
    }
}

static void stand(const ng_supervisor_config *config, ng_supervisor *own,
                  const ng_pose *pose, ng_supervision *decided)
{
    static const ng_real rest[NG_COORDINATES];
    ng_real wide[NG_COORDINATES];
    if (own->part == MOVING) {
        move_to_standing(config, own, pose, decided);
    } else if (own->part == HOLDING) {
        hold(config, own, pose, ng_stand_path[0], rest, &decided->command);
    } else {
        balance(config, own, pose, wide);
        hold(config, own, pose, wide, rest, &decided->command);
    }
}

/* From damping to a posture, or on with a step that is under way. */
static void leave_damp(const ng_supervisor_config *config, ng_supervisor *own,
                       const ng_measurement *reading, ng_request request,
                       ng_supervision *decided)
{
    const int leg = front_leg(reading), standing = standing_leg(reading, leg);
    ng_pose pose;
    if (own->refused) {
        decided->waiting = NG_FOR_DAMP;
    } else if (request == NG_REQUEST_WALK && on_the_gait(config, own, reading, standing)) {
        begin_walk(own, config, reading, standing);
        for (int i = 0; i < NG_ACTUATED; ++i) {
            own->lead[i] = own->lead_rate[i] = NG(0.0);
        }
        change(own, NG_WALK, STEPPING, NG_FROM_MID_STEP, decided);
    } else if (!NG_HAS_STANDING) {
        decided->waiting = NG_FOR_LEGS;
    } else {
        stand_on(own, leg);
        look(reading, leg, &pose);
        begin_move(config, own, &pose, ng_stand_path[0]);
        change(own, NG_STAND, MOVING, NG_AS_REQUESTED, decided);
    }
}

/* To a posture on two feet: from leaning at once, from a walk by way of a step that brakes. */
static void leave_walk(const ng_supervisor_config *config, ng_supervisor *own,
                       const ng_pose *pose, ng_supervision *decided)
{
    if (own->part == LEANING) {
        begin_move(config, own, pose, ng_stand_path[0]);
        change(own, NG_STAND, MOVING, NG_AS_REQUESTED, decided);
    } else if (!NG_HAS_STANDING) {
        change(own, NG_DAMP, 0, NG_AS_REQUESTED, decided);
    } else {
        const ng_real since = own->elapsed; /* what leads the gait goes on fading */
        change(own, NG_STOP, LAST_STEPS, NG_AS_REQUESTED, decided);
        own->elapsed = since;
        own->braked = 0;
        own->steps_to_brake = phase_of(&own->state, pose->z[0]) > config->brake_from;
    }
}

/* A robot that tips over its front foot steps on: to walk, or to end that step far ahead. */
static void catch_fall(const ng_supervisor_config *config, ng_supervisor *own,
                       const ng_measurement *reading, ng_request request,
                       ng_supervision *decided)
{
    begin_walk(own, config, reading, own->state.leg);
    own->braked = own->steps_to_brake = 0;
    if (request == NG_REQUEST_WALK) {
        change(own, NG_WALK, STEPPING, NG_TIPS_FORWARD, decided);
    } else {
        change(own, NG_STOP, LAST_STEPS, NG_TIPS_FORWARD, decided);
    }
}

/* The operator's request, where the mode follows it. */
static void follow_request(const ng_supervisor_config *config, ng_supervisor *own,
                           const ng_measurement *reading, ng_request request,
                           ng_supervision *decided)
{
    ng_pose pose;
    if (request == NG_REQUEST_DAMP) {
        own->refused = 0;
        if (own->mode != NG_DAMP) {
            change(own, NG_DAMP, 0, NG_AS_REQUESTED, decided);
        }
        return;
    }
    if (own->mode == NG_DAMP) {
        leave_damp(config, own, reading, request, decided);
        return;
    }
    look(reading, own->state.leg, &pose);
    if (own->mode == NG_STAND && pose.tips > config->first_momentum && pose.foot[0] < NG(0.0) &&
        reading->normal_force[own->state.leg] >= config->walk.contact_force &&
        !tipped_over(config, reading, &pose)) {
        catch_fall(config, own, reading, request, decided);
        return;
    }
    if (request == NG_REQUEST_STAND && own->mode == NG_WALK) {
        leave_walk(config, own, &pose, decided);
    } else if (request == NG_REQUEST_WALK && own->mode != NG_WALK) {
        decided->waiting = waiting(config, own, reading, &pose);
        if (own->mode == NG_STAND && own->part == FEET_APART) {
            begin_move(config, own, &pose, ng_stand_path[0]);
            enter(own, NG_STAND, MOVING);
            own->in_mode = NG(0.0); /* its time-out counts from the request */
        } else if (decided->waiting == NG_NOTHING) {
            change(own, NG_WALK, LEANING, NG_AS_REQUESTED, decided);
        }
    }
}

/* What the mode does, and whether it ends. */
static void carry_on(const ng_supervisor_config *config, ng_supervisor *own,
                     const ng_measurement *reading, ng_supervision *decided)
{
    ng_pose pose;
    look(reading, own->state.leg, &pose);
    const int steps = (own->mode == NG_WALK && own->part == STEPPING) ||
                      (own->mode == NG_STOP && own->part == LAST_STEPS);
    if (own->mode != NG_DAMP && !steps && tipped_over(config, reading, &pose)) {
        give_up(own, NG_TIPPED_OVER, decided);
    }
    switch (own->mode) {
    case NG_WALK:
        walk(config, own, reading, &pose, decided);
        break;
    case NG_STOP:
        stop(config, own, reading, &pose, decided);
        break;
    case NG_STAND:
        stand(config, own, &pose, decided);
        break;
    case NG_DAMP:
        break;
    }
}

/* What to tell the drives: ng_impedance with the gains of each joint. */
static void aim(const ng_supervisor_config *config, ng_supervisor *own,
                const ng_measurement *reading, const ng_command *command)
{
    for (int i = 0; i < NG_LEG_JOINTS; ++i) {
        ng_target targets[NG_LEGS][NG_LEG_JOINTS];
        ng_impedance(reading, command, config->kp[i], config->kd[i], targets);
        for (int leg = 0; leg < NG_LEGS; ++leg) {
            own->targets[leg][i] = targets[leg][i];
        }
    }
}

void ng_supervise(const ng_supervisor_config *config, ng_supervisor *own,
                  const ng_measurement *reading, ng_request request, ng_supervision *decided)
{
    const ng_supervision nothing = {0};
    const ng_fault latched = own->state.fault;
    const ng_real since = own->state.since_touchdown;
    *decided = nothing;
    decided->before = own->mode;
    ng_fault fault = latched != NG_NO_FAULT ? latched
                                            : ng_check(&config->walk, &own->state, reading);
    if (fault == NG_NO_FAULT) {
        follow_pitch(config, own, reading->pitch);
        follow_request(config, own, reading, request, decided);
        carry_on(config, own, reading, decided);
        own->state.running = 1;
        own->state.last_us = reading->time_us;
        if (own->state.since_touchdown == since && since < NG_NEVER) {
            own->state.since_touchdown += NG_PERIOD; /* no step counted it: for ng_estimate */
        }
        fault = own->state.fault;
    }
    own->state.fault = decided->fault = fault;
    decided->fault_is_new = fault != NG_NO_FAULT && latched == NG_NO_FAULT;
    if (decided->fault_is_new && own->mode != NG_DAMP) {
        change(own, NG_DAMP, 0, NG_BY_FAULT, decided);
    }
    decided->mode = own->mode;
    own->elapsed += NG_PERIOD;
    own->in_mode += NG_PERIOD;
    own->in_step += NG_PERIOD;
    if (own->mode == NG_DAMP) {
        damp(config, own, reading, &decided->command);
    } else {
        aim(config, own, reading, &decided->command);
    }
    copy_torques((const ng_real(*)[NG_LEG_JOINTS])own->state.torque, own->given);
}

void ng_supervisor_start(ng_supervisor *supervisor)
{
    const ng_supervisor fresh = {0};
    *supervisor = fresh;
    ng_start(&supervisor->state, 0);
}

ng_supervisor_config ng_supervisor_config_of(const ng_law *law)
{
    ng_supervisor_config config = {
        .walk = ng_config_of(law),
        .joint_rate = NG(0.5),
        .near_posture = NG(0.1),
        .at_rest = NG(0.1),
        .rest_s = NG(0.1),
        .stand_timeout_s = NG(15.0),
        .lean_s = NG(2.5) / NG_PENDULUM,
        .lean_timeout_s = NG(10.0) / NG_PENDULUM,
        .first_momentum = NG_FIRST_MOMENTUM,
        .fade_s = NG(1.0) / NG_PENDULUM,
        .near_gait = NG(0.05),
        .step_timeout_s = NG(7.0) / NG_PENDULUM,
        .brake_from = NG(0.45),
        .brake_to = NG(0.9),
        .brakes = 3,
        .over_foot = NG_OVER_FOOT,
        .settle_s = NG(0.5),
        .balance = NG(1.0),
        .balance_rate = NG(4.0),
        .balance_s = NG(1.0),
        .stop_timeout_s = NG(4.0),
    };
    ng_real foot[2], hip[2];
    ng_feet(ng_stand_path[0], foot, hip);
    config.feet_held = NG(0.01) * ng_abs(foot[0]);
    for (int i = 0; i < NG_LEG_JOINTS; ++i) {
        config.kp[i] = ng_stand_stiffness[i];
        config.kd[i] = ng_stand_damping[i];
    }
    return config;
}

const char *ng_mode_text(ng_mode mode)
{
    static const char *const words[] = {"damp", "stand", "walk", "stop"};
    return mode <= NG_STOP ? words[mode] : "unknown mode";
}

const char *ng_reason_text(ng_reason reason)
{
    static const char *const words[] = {
        "no change",
        "as requested",
        "the robot was in mid-step already",
        "the robot tips over its front foot",
        "the walk has ended on two feet",
        "not there in time",
        "the centre of mass has left the feet",
        "a fault",
        "the feet stay where they are: friction, or a motor at its limit",
    };
    return reason <= NG_FEET_HELD ? words[reason] : "unknown reason";
}

const char *ng_waiting_text(ng_waiting waiting)
{
    static const char *const words[] = {
        "nothing",
        "a request to damp, after what went wrong before",
        "legs that can stand on two feet as this gait needs it",
        "a posture to be held",
        "both feet on the floor",
        "every joint near its posture",
        "every joint at rest",
    };
    return waiting <= NG_FOR_REST ? words[waiting] : "unknown condition";
}
