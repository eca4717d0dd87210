/* See walk.h. */
#include "walk.h"

#include <math.h>
#include <setjmp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define SENSORS (1 + NG_LEGS * NG_LEG_JOINTS)
#define MICROSECONDS 1.0e6

/* The true values of all measured quantities. */
typedef struct {
    ng_measurement reading;
    double hip[2]; /* in the world [m] */
} truth_of_tick;

static __thread jmp_buf *way_out;
static __thread char complaint[256];
static void (*before_us)(const char *);

static void on_error(const char *text)
{
    if (way_out != NULL) {
        snprintf(complaint, sizeof complaint, "%s", text);
        longjmp(*way_out, 1);
    }
    if (before_us != NULL) {
        before_us(text);
    } else {
        fprintf(stderr, "MuJoCo: %s\n", text);
    }
    exit(EXIT_FAILURE);
}

void ng_walk_catch(void (**user_error)(const char *))
{
    if (*user_error != on_error) {
        before_us = *user_error;
        *user_error = on_error;
    }
}

const char *ng_walk_error(void) { return complaint; }

void ng_walk_sizes(int sizes[3])
{
    sizes[0] = (int)sizeof(ng_scene);
    sizes[1] = (int)sizeof(ng_walk);
    sizes[2] = (int)sizeof(ng_record);
}

static double larger(double a, double b) { return a > b ? a : b; }
static double smaller(double a, double b) { return a < b ? a : b; }

static ng_extremes no_extremes(void)
{
    const ng_extremes none = {0.0, 0.0, 0.0, 0.0, INFINITY};
    return none;
}

static void widen(ng_extremes *of, const ng_extremes *other)
{
    of->output_error = larger(of->output_error, other->output_error);
    of->settled_torque = larger(of->settled_torque, other->settled_torque);
    of->torque = larger(of->torque, other->torque);
    of->joint_rate = larger(of->joint_rate, other->joint_rate);
    of->normal_force = smaller(of->normal_force, other->normal_force);
}

void ng_walk_start(ng_walk *walk, int leg, const double *command)
{
    const ng_walk fresh = {0};
    *walk = fresh;
    ng_start(&walk->controller, leg);
    ng_estimator_start(&walk->estimator);
#if NG_COMMANDS
    if (command != NULL) {
        ng_start_at(&walk->controller, leg, command);
    }
    ng_adapt_start(&walk->adapt, walk->controller.requested);
    walk->adapt.active = walk->adapt.learns = 0;
#else
    (void)command;
#endif
    walk->push_start = INFINITY;
    walk->steady = walk->running = no_extremes();
    walk->ending = NG_RUNNING;
}

/* Read the plant as sensors without errors would. */
static void look(const ng_scene *scene, const ng_walk *walk, const mjData *data,
                 truth_of_tick *truth)
{
    ng_measurement *reading = &truth->reading;
    const double turn = scene->pitch_sign * data->qpos[scene->root[2]];
    const double sine = ng_sin(turn), cosine = ng_cos(turn);
    const double arm_x = scene->root_to_hip[0] * cosine - scene->root_to_hip[1] * sine;
    const double arm_z = scene->root_to_hip[0] * sine + scene->root_to_hip[1] * cosine;
    reading->time_us = walk->time_us;
    reading->pitch = turn + scene->root_angle;
    reading->dpitch = scene->pitch_sign * data->qvel[scene->root[2]];
    reading->hip_velocity[0] = data->qvel[scene->root[0]] - reading->dpitch * arm_z;
    reading->hip_velocity[1] = data->qvel[scene->root[1]] + reading->dpitch * arm_x;
    truth->hip[0] = data->qpos[scene->root[0]] + scene->root_origin[0] + arm_x;
    truth->hip[1] = data->qpos[scene->root[1]] + scene->root_origin[1] + arm_z;
    for (int leg = 0; leg < NG_LEGS; ++leg) {
        reading->normal_force[leg] = walk->touch[leg];
        for (int i = 0; i < NG_LEG_JOINTS; ++i) {
            const int at = scene->joints[leg][i];
            const double sign = scene->joint_sign[leg][i];
            reading->angles[leg][i] = sign * data->qpos[at] + scene->joint_offset[leg][i];
            reading->rates[leg][i] = sign * data->qvel[at];
        }
    }
}

/* Round to the nearest multiple of the step, halves to the even one. */
static double counted(double angle, double step)
{
    volatile double shifted = angle / step + NG_ROUNDER;
    return step * (shifted - NG_ROUNDER);
}

/* Offset and noise, then rounding. */
static void blur(const ng_scene *scene, const double *noise, ng_measurement *reading)
{
    reading->pitch += scene->pitch_offset;
    if (noise != NULL) {
        const double *of_angles = noise, *of_rates = noise + SENSORS;
        reading->pitch += scene->pitch_noise * *of_angles++;
        reading->dpitch += scene->rate_noise * *of_rates++;
        for (int leg = 0; leg < NG_LEGS; ++leg) {
            for (int i = 0; i < NG_LEG_JOINTS; ++i) {
                reading->angles[leg][i] += scene->angle_noise * *of_angles++;
                reading->rates[leg][i] += scene->rate_noise * *of_rates++;
            }
        }
    }
    if (scene->encoder_step > 0.0) {
        reading->pitch = counted(reading->pitch, scene->encoder_step);
        for (int leg = 0; leg < NG_LEGS; ++leg) {
            for (int i = 0; i < NG_LEG_JOINTS; ++i) {
                reading->angles[leg][i] = counted(reading->angles[leg][i], scene->encoder_step);
            }
        }
    }
}

static double largest(const double values[NG_ACTUATED])
{
    double found = 0.0;
    for (int i = 0; i < NG_ACTUATED; ++i) {
        found = larger(found, ng_abs(values[i]));
    }
    return found;
}

/* Add one tick to the figures of the walk. */
static void gauge(const ng_scene *scene, ng_walk *walk, const ng_command *command, double time,
                  double hip)
{
    ng_extremes now = no_extremes();
    double power = 0.0, errors[NG_ACTUATED];
    for (int i = 0; i < NG_ACTUATED; ++i) {
        power += ng_abs(command->actuated[i] * command->dq[i + 1]);
        errors[i] = command->q[i + 1] - command->y_d[i];
    }
    now.torque = largest(command->actuated);
    if (command->since_touchdown >= scene->settling_s) {
        now.output_error = largest(errors);
        now.settled_torque = now.torque;
        now.joint_rate = largest(command->dq + 1);
        now.normal_force = walk->touch[command->leg];
    }
    if (command->touchdown) {
        const ng_milestone here = {time, hip, walk->energy};
        if (walk->steps >= scene->start_up_steps) {
            widen(&walk->steady, &walk->running);
        }
        walk->running = no_extremes();
        walk->steps += 1;
        if (walk->steps == scene->start_up_steps) {
            walk->first = here;
        }
        walk->last = here;
    }
    widen(&walk->running, &now);
    walk->energy += NG_PERIOD * power;
    walk->peak_torque = larger(walk->peak_torque, now.torque);
    walk->saturated += command->saturated;
    walk->relaxed[0] += command->relaxed[0];
    walk->relaxed[1] += command->relaxed[1];
    walk->ticks += 1;
}

/*
 * Error of the hip speed from which the torques that are applied now were computed. They and the
 * estimate are delay_ticks old.
 */
static void gauge_estimate(const ng_scene *scene, ng_walk *walk, double estimate, double truth)
{
    const int rows = scene->delay_ticks + 1;
    if (!scene->estimator || walk->believed == NULL) {
        return;
    }
    walk->believed[walk->ticks % rows] = estimate;
    if (walk->ticks >= scene->delay_ticks) {
        const double error = walk->believed[(walk->ticks + 1) % rows] - truth;
        walk->speed_error += error * error;
    }
}

/* Whether time, positions and rates are finite. */
static int all_state_finite(const ng_scene *scene, const mjData *data)
{
    int all = ng_finite(data->time);
    for (int i = 0; i < scene->model->nq; ++i) {
        all &= ng_finite(data->qpos[i]);
    }
    for (int i = 0; i < scene->model->nv; ++i) {
        all &= ng_finite(data->qvel[i]);
    }
    return all;
}

/* Where both feet are in the world. */
static void place_feet(ng_walk *walk, const truth_of_tick *truth, const ng_command *command)
{
    double foot[2], hip[2];
    ng_feet(command->q, foot, hip);
    for (int i = 0; i < 2; ++i) {
        walk->feet[0][i] = truth->hip[i] - hip[i];
        walk->feet[1][i] = walk->feet[0][i] + foot[i];
    }
}

/* Whether a foot is below its stones, the standing one on `level`. */
static int in_gap(const ng_scene *scene, const ng_walk *walk, const ng_command *command,
                  double level)
{
    double rise = 0.0; /* of the stone that the swing foot is on its way to */
#if NG_COMMANDS
    if (scene->told_height) {
        rise = walk->controller.after[scene->told_height - 1];
    }
#endif
    const double lowest = smaller(walk->floor[1 - command->leg], level + rise);
    return walk->feet[1][1] - scene->foot_radius < lowest - scene->gap_depth ||
           walk->feet[0][1] - scene->foot_radius < level - scene->gap_depth;
}

/* Whether the walk has ended, and how; `ending` in ticks/falls.py does the same. */
static ng_ending judge(const ng_scene *scene, const ng_walk *walk, const mjData *data,
                       const truth_of_tick *truth, const ng_command *command)
{
    double level = walk->floor[command->leg];
    if (scene->course && command->touchdown) {
        /* `walk->floor` gets this foothold only after this tick's decision. */
        level = walk->feet[0][1] - scene->foot_radius;
    }
    const double floor = level + scene->slope * truth->hip[0];
    /*
     * Any fault counts as "not finite": the scene sets the safeguard's other limits to infinity, so
     * a fault says that a reading or a torque is NaN or infinite.
     */
    if (command->fault != NG_NO_FAULT || !all_state_finite(scene, data)) {
        return NG_NOT_FINITE;
    }
    if (in_gap(scene, walk, command, level)) {
        return NG_GAP;
    }
    if (truth->hip[1] - floor < scene->lowest_hip) {
        return NG_LOW_HIP;
    }
    if (ng_abs(truth->reading.pitch) > scene->largest_pitch) {
        return NG_TORSO;
    }
    if (walk->age > scene->patience_s) {
        return NG_STALLED;
    }
    return walk->steps >= scene->steps ? NG_WALKED : NG_RUNNING;
}

static void keep(const ng_walk *walk, const mjData *data, const truth_of_tick *truth,
                 const ng_command *command, ng_record *record)
{
    record->time = data->time;
    memcpy(record->torque, command->torque, sizeof record->torque);
    memcpy(record->actuated, command->actuated, sizeof record->actuated);
    memcpy(record->q, command->q, sizeof record->q);
    memcpy(record->dq, command->dq, sizeof record->dq);
    memcpy(record->y_d, command->y_d, sizeof record->y_d);
    memcpy(record->dy_d, command->dy_d, sizeof record->dy_d);
    memcpy(record->z, command->z, sizeof record->z);
    record->leg = command->leg;
    record->since_touchdown = command->since_touchdown;
    record->touchdown = command->touchdown;
    record->saturated = command->saturated;
    record->relaxed[0] = command->relaxed[0];
    record->relaxed[1] = command->relaxed[1];
    record->pitch = truth->reading.pitch;
    record->dpitch = truth->reading.dpitch;
    memcpy(record->angles, truth->reading.angles, sizeof record->angles);
    memcpy(record->rates, truth->reading.rates, sizeof record->rates);
    memcpy(record->hip_velocity, truth->reading.hip_velocity, sizeof record->hip_velocity);
    memcpy(record->normal_force, walk->touch, sizeof record->normal_force);
    memcpy(record->floor, walk->floor, sizeof record->floor);
    memcpy(record->feet, walk->feet, sizeof record->feet);
#if NG_COMMANDS
    memcpy(record->told[0], walk->controller.before, sizeof record->told[0]);
    memcpy(record->told[1], walk->controller.after, sizeof record->told[1]);
#endif
}

/* Record a touchdown; `reference` is the adapted speed of the step that ended. */
static void stride(ng_walk *walk, const ng_command *command, double time, double hip,
                   double reference)
{
    double *row = walk->strides + NG_STRIDE * walk->strides_used++;
    double foot[2], unused[2];
    ng_feet(command->q, foot, unused); /* the old foothold from the new one */
    row[0] = time;
    row[1] = hip;
    row[2] = -foot[0];
    row[3] = -foot[1];
    row[4] = walk->feet[0][0];
#if NG_COMMANDS
    row[5] = NG_SPEED_COMMAND > 0 ? reference : NAN;
    row[6] = NG_SPEED_COMMAND > 0 && walk->adapt.measured ? walk->adapt.walked : NAN;
    memcpy(row + 7, walk->controller.before, sizeof walk->controller.before);
#else
    (void)reference;
#endif
}

/* Swing foot above the floor through the stance foothold. */
static double clearance(const ng_scene *scene, const ng_command *command)
{
    double swing_foot[2], hip[2];
    ng_feet(command->q, swing_foot, hip);
    return swing_foot[1] - scene->slope * swing_foot[0];
}

#if NG_COMMANDS
/* The slope that is seen at a place, between rows of the table. */
static double slope_at(const ng_walk *walk, double x)
{
    const double *row = walk->seen;
    int low = 0, high = walk->seen_rows - 1;
    if (!(x > row[0])) {
        return row[1];
    }
    if (x >= row[2 * high]) {
        return row[2 * high + 1];
    }
    while (high - low > 1) {
        const int middle = (low + high) / 2;
        if (row[2 * middle] <= x) {
            low = middle;
        } else {
            high = middle;
        }
    }
    row += 2 * low;
    return row[1] + (row[3] - row[1]) / (row[2] - row[0]) * (x - row[0]);
}

/* On a course: set the commands of the next touchdown, as far as they can be seen. */
static void look_ahead(const ng_scene *scene, ng_walk *walk)
{
    const double *foot = walk->feet[1];
    if (!scene->stones) {
        walk->told[scene->told_slope - 1] = slope_at(walk, foot[0]);
        return;
    }
    /* The foot is on its way to the stone before this one. */
    const int next = walk->steps + 2;
    if (next >= walk->seen_rows) {
        return;
    }
    walk->told[scene->told_length - 1] = walk->seen[2 * next] - foot[0];
    if (scene->told_height) {
        walk->told[scene->told_height - 1] =
            walk->seen[2 * next + 1] - (foot[1] - scene->foot_radius);
    }
}
#endif

/* What a control adds for the targets of a drive with a loop of its own [N m]. */
static double held(const ng_scene *scene, const ng_measurement *seen, int leg, int i)
{
    const double angle = seen->angles[leg][i] - scene->joint_offset[leg][i];
    return scene->drive_stiffness * angle + scene->drive_damping * seen->rates[leg][i];
}

/* One tick without the plant: measure, ask the controller, judge, set the controls. */
static void decide(const ng_scene *scene, ng_walk *walk, const mjData *data, const double *noise,
                   double *controls, ng_command *command, ng_record *record)
{
    truth_of_tick truth;
    look(scene, walk, data, &truth);
    ng_measurement seen = truth.reading;
    blur(scene, noise, &seen);
    if (scene->estimator) {
        ng_estimate(&walk->estimator, &walk->controller, &seen);
    }
    double reference = 0.0;
#if NG_COMMANDS
    const double *told = walk->seen != NULL     ? walk->told
                         : walk->orders != NULL ? walk->orders + NG_COMMANDS * walk->orders_used
                                                : walk->controller.requested;
    reference = walk->adapt.reference;
    ng_adapt_tell(&walk->adapt, &walk->controller, told);
#endif
    ng_step(&scene->config, &walk->controller, &seen, command);
#if NG_COMMANDS
    ng_adapt_step(&walk->adapt, &walk->controller, &seen, command, told);
    walk->orders_used += command->touchdown;
#endif
    place_feet(walk, &truth, command);
    if (command->touchdown && walk->strides != NULL) {
        stride(walk, command, data->time, truth.hip[0], reference);
    }
    walk->time_us += (uint32_t)(NG_PERIOD * MICROSECONDS + 0.5);
    walk->age = command->touchdown ? 0.0 : walk->age + NG_PERIOD;
    gauge_estimate(scene, walk, seen.hip_velocity[0], truth.reading.hip_velocity[0]);
    gauge(scene, walk, command, data->time, truth.hip[0]);
#if NG_COMMANDS
    if (walk->seen != NULL) {
        look_ahead(scene, walk);
    }
#endif
    walk->ending = judge(scene, walk, data, &truth, command);
    for (int leg = 0; leg < NG_LEGS; ++leg) {
        for (int i = 0; i < NG_LEG_JOINTS; ++i) {
            controls[scene->motors[leg][i]] =
                (command->torque[leg][i] + held(scene, &seen, leg, i)) / scene->gear[leg][i];
        }
    }
    if (record != NULL) {
        keep(walk, data, &truth, command, record);
        record->clearance = clearance(scene, command);
    }
}

void ng_walk_tick(const ng_scene *scene, ng_walk *walk, const mjData *data, double *controls,
                  ng_record *record)
{
    ng_command command;
    decide(scene, walk, data, NULL, controls, &command, record);
}

/*
 * On an uneven floor, draw the next foothold's level at a touchdown, and move its plane once the
 * foot is above. On a course, record the level at which the foot came down.
 */
static void lay_floors(const ng_scene *scene, ng_walk *walk, const ng_command *command)
{
    if (scene->course && command->touchdown) {
        walk->floor[command->leg] = walk->feet[0][1] - scene->foot_radius;
    }
    if (!scene->uneven) {
        return;
    }
    if (command->touchdown) {
        walk->next_rise = walk->rises[walk->rises_used++];
#if NG_COMMANDS
        if (scene->told_height) {
            walk->next_rise += walk->controller.after[scene->told_height - 1];
        }
#endif
        walk->rise_pending = 1;
    }
    if (!walk->rise_pending || !(command->z[0] > 0.0)) {
        return;
    }
    if (clearance(scene, command) > walk->next_rise + scene->room_under_foot) {
        walk->floor[1 - command->leg] = walk->floor[command->leg] + walk->next_rise;
        walk->rise_pending = 0;
    }
}

/* Forward force of the push at this time. */
static double push(const ng_scene *scene, ng_walk *walk, const ng_command *command)
{
    if (command->touchdown && walk->steps == scene->push_after) {
        walk->push_start = walk->clock + walk->push_wait;
    }
    const int pushing = walk->clock >= walk->push_start &&
                        walk->clock < walk->push_start + scene->push_s;
    return pushing ? scene->push_force : 0.0;
}

/* The controls that are applied now, from a ring as long as the delay. */
static const double *due(const ng_scene *scene, const ng_walk *walk)
{
    const int rows = scene->delay_ticks + 1;
    return walk->late + scene->model->nu * (walk->ticks % rows);
}

/*
 * Step MuJoCo through one tick. Where MuJoCo has reset a bad state, the remaining steps are left
 * out, as in its rollouts.
 */
static void advance(const ng_scene *scene, ng_walk *walk, mjData *data, double force)
{
    const mjModel *model = scene->model;
    const double *controls = due(scene, walk);
    memset(data->qacc_warmstart, 0, sizeof(double) * (size_t)model->nv);
    for (int i = 0; i < mjNWARNING; ++i) {
        data->warning[i].number = 0;
    }
    for (int step = 0; step < scene->substeps; ++step) {
        int warned = 0;
        for (int i = 0; i < mjNWARNING; ++i) {
            warned |= data->warning[i].number;
        }
        if (warned) {
            break;
        }
        memcpy(data->ctrl, controls, sizeof(double) * (size_t)model->nu);
        data->qfrc_applied[scene->root[0]] = force;
        for (int leg = 0; leg < NG_LEGS && !scene->course; ++leg) {
            data->mocap_pos[3 * leg] = data->mocap_pos[3 * leg + 1] = 0.0;
            data->mocap_pos[3 * leg + 2] = walk->floor[leg];
        }
        scene->step(model, data);
    }
    walk->plant_steps += scene->substeps;
    for (int leg = 0; leg < NG_LEGS; ++leg) {
        walk->touch[leg] = data->sensordata[model->nsensordata - NG_LEGS + leg];
    }
    walk->clock += scene->substeps * model->opt.timestep;
}

int ng_walk_run(const ng_scene *scene, ng_walk *walk, mjData *data, int ticks,
                const double *noise, ng_record *records, double *states)
{
    const mjModel *model = scene->model;
    const int size = 1 + model->nq + model->nv;
    volatile int done = 0; /* keeps its value through longjmp */
    jmp_buf here;
    if (setjmp(here) != 0) {
        way_out = NULL;
        walk->ending = NG_REFUSED;
        return done;
    }
    way_out = &here;
    while (done < ticks && walk->ending == NG_RUNNING) {
        const int tick = done;
        ng_command command;
        double *controls = walk->late + model->nu * (walk->ticks % (scene->delay_ticks + 1));
        if (states != NULL) {
            double *row = states + (size_t)tick * (size_t)size;
            row[0] = data->time;
            memcpy(row + 1, data->qpos, sizeof(double) * (size_t)model->nq);
            memcpy(row + 1 + model->nq, data->qvel, sizeof(double) * (size_t)model->nv);
        }
        decide(scene, walk, data, noise == NULL ? NULL : noise + (size_t)tick * 2 * SENSORS,
               controls, &command, records == NULL ? NULL : records + tick);
        done = tick + 1;
        if (walk->ending != NG_RUNNING) {
            break;
        }
        const double force = push(scene, walk, &command);
        lay_floors(scene, walk, &command);
        advance(scene, walk, data, force);
    }
    way_out = NULL;
    return done;
}
