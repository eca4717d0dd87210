/* See fmu.h. The controller itself is in controller.c, which knows nothing of this file. */
#include "fmu.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define SIZE_TOLERANCE 1.0e-6 /* of a step, as a share of the period: rounding of the host */
#define TIME_TOLERANCE 1.0e-3 /* of its beginning, likewise: hosts add up their steps */
#define MESSAGE 160           /* longest message, with its end */

ng_fmu_status ng_fmu_refuse(ng_fmu *fmu, const char *message)
{
    fmu->log(fmu, NG_FMU_ERROR, message);
    return NG_FMU_ERROR;
}

void ng_fmu_reset(ng_fmu *fmu)
{
    ng_fmu_memory *memory = &fmu->memory;
    memset(memory, 0, sizeof *memory);
    memory->phase = NG_FMU_INSTANTIATED;
    memcpy(memory->reals, ng_fmu_real_start, sizeof memory->reals);
    memcpy(memory->integers, ng_fmu_integer_start, sizeof memory->integers);
    memcpy(memory->booleans, ng_fmu_boolean_start, sizeof memory->booleans);
}

ng_fmu_status ng_fmu_enter_initialization(ng_fmu *fmu, double start_time)
{
    ng_fmu_memory *memory = &fmu->memory;
    if (memory->phase != NG_FMU_INSTANTIATED) {
        return ng_fmu_refuse(fmu, "initialisation: expected a new instance, or one after reset");
    }
    if (!(start_time - start_time == 0.0)) {
        return ng_fmu_refuse(fmu, "initialisation: expected a finite start time");
    }
    memory->start_time = memory->time = start_time;
    memory->phase = NG_FMU_INITIALIZATION;
    return NG_FMU_OK;
}

/* Start controller, estimator and monitor with the parameters. */
static void start(ng_fmu_memory *memory)
{
    ng_fmu_start_control(memory);
    ng_estimator_start(&memory->estimator);
#if NG_FMU_MONITOR
    ng_monitor_start(&memory->monitor);
#endif
}

ng_fmu_status ng_fmu_exit_initialization(ng_fmu *fmu)
{
    if (fmu->memory.phase != NG_FMU_INITIALIZATION) {
        return ng_fmu_refuse(fmu, "end of initialisation: expected its beginning before it");
    }
    start(&fmu->memory);
    fmu->memory.phase = NG_FMU_STEPPING;
    return NG_FMU_OK;
}

ng_fmu_status ng_fmu_terminate(ng_fmu *fmu)
{
    if (fmu->memory.phase != NG_FMU_STEPPING) {
        return ng_fmu_refuse(fmu, "terminate: expected an instance that is initialised");
    }
    fmu->memory.phase = NG_FMU_TERMINATED;
    return NG_FMU_OK;
}

/* The inputs as a reading. Joints of the model may serve in both legs. */
static void read_encoders(const ng_fmu_memory *memory, ng_encoders *encoders)
{
    const double *in = memory->reals;
    const double since = 1.0e6 * (memory->time - memory->start_time);
    encoders->time_us = (uint32_t)(uint64_t)(since + 0.5);
    encoders->pitch = (ng_real)in[NG_FMU_PITCH];
    encoders->dpitch = (ng_real)in[NG_FMU_PITCH_RATE];
    encoders->base_velocity[0] = (ng_real)in[NG_FMU_VELOCITY];
    encoders->base_velocity[1] = (ng_real)in[NG_FMU_VELOCITY + 1];
    for (int leg = 0; leg < NG_LEGS; ++leg) {
        encoders->normal_force[leg] = (ng_real)in[NG_FMU_FORCE + leg];
        for (int i = 0; i < NG_LEG_JOINTS; ++i) {
            const int joint = ng_fmu_joint[leg][i];
            encoders->joints[leg][i] = (ng_real)in[NG_FMU_ANGLE + joint];
            encoders->djoints[leg][i] = (ng_real)in[NG_FMU_RATE + joint];
        }
    }
}

/* Torques, motor commands and targets of drives, in the robot file's signs. */
static void write_joints(ng_fmu_memory *memory, const ng_command *command,
                         const ng_target targets[NG_LEGS][NG_LEG_JOINTS])
{
    double *out = memory->reals;
    ng_real motors[NG_LEGS][NG_LEG_JOINTS];
    ng_drive(command, motors);
    for (int leg = 0; leg < NG_LEGS; ++leg) {
        for (int i = 0; i < NG_LEG_JOINTS; ++i) {
            const int joint = ng_fmu_joint[leg][i];
            const ng_target *target = &targets[leg][i];
            out[NG_FMU_TORQUE + joint] = (double)(ng_joint_sign[leg][i] * command->torque[leg][i]);
            out[NG_FMU_MOTOR + joint] = (double)motors[leg][i];
            out[NG_FMU_TARGET_ANGLE + joint] = (double)target->q_des;
            out[NG_FMU_TARGET_RATE + joint] = (double)target->dq_des;
            out[NG_FMU_TARGET_KP + joint] = (double)target->kp;
            out[NG_FMU_TARGET_KD + joint] = (double)target->kd;
            out[NG_FMU_TARGET_TORQUE + joint] = (double)target->tau_ff;
        }
    }
}

#if NG_FMU_MONITOR
/* Number of a margin's name in its set, counted from 0; -1 for a fault. */
static int32_t number_of(const char *name, int level)
{
    for (int i = 0; i < NG_MONITOR_MARGINS; ++i) {
        const char *other = ng_monitor_names[ng_monitor_set_of[level]][i];
        if (other != NULL && strcmp(name, other) == 0) {
            return i;
        }
    }
    return -1;
}

/* Answers where nothing is asked: the robot is not inside, and its times begin anew. */
static void stop_monitor(ng_fmu_memory *memory)
{
    ng_monitor_start(&memory->monitor);
    for (int k = 0; k < NG_MONITOR_LEVELS; ++k) {
        memory->booleans[NG_FMU_INSIDE + k] = 0;
        memory->integers[NG_FMU_MARGIN_NAME + k] = -1;
        memory->reals[NG_FMU_MARGIN + k] = 0.0;
        memory->reals[NG_FMU_OUTSIDE + k] = memory->reals[NG_FMU_STRETCH + k] = 0.0;
    }
    memory->booleans[NG_FMU_ADMISSIBLE] = 0;
    memory->integers[NG_FMU_IN_TIME] = -1;
}

static void ask_monitor(ng_fmu_memory *memory, uint32_t time_us, ng_command *command)
{
    ng_monitor_answer answer;
    if (!ng_fmu_walks(memory)) {
        stop_monitor(memory);
        return;
    }
    ng_monitor_step(&memory->monitor, ng_fmu_state(memory), time_us, command, &answer);
    for (int k = 0; k < NG_MONITOR_LEVELS; ++k) {
        const ng_membership *level = &answer.levels[k];
        memory->booleans[NG_FMU_INSIDE + k] = level->inside;
        memory->integers[NG_FMU_MARGIN_NAME + k] = number_of(level->name, k);
        memory->reals[NG_FMU_MARGIN + k] = (double)level->margin;
        memory->reals[NG_FMU_OUTSIDE + k] = 1.0e-6 * (double)level->outside_us;
        memory->reals[NG_FMU_STRETCH + k] = 1.0e-6 * (double)level->stretch_us;
    }
    memory->booleans[NG_FMU_ADMISSIBLE] = answer.admissible;
    memory->integers[NG_FMU_IN_TIME] = answer.in_time;
}
#endif

/* One tick of the controller. */
static void tick(ng_fmu *fmu)
{
    ng_fmu_memory *memory = &fmu->memory;
    ng_state *state = ng_fmu_state(memory);
    const ng_fault before = state->fault;
    ng_encoders encoders;
    ng_measurement reading;
    ng_command command = {0};
    ng_target targets[NG_LEGS][NG_LEG_JOINTS];
    read_encoders(memory, &encoders);
    ng_measure(&encoders, &reading);
    if (memory->booleans[NG_FMU_ESTIMATE]) {
        ng_estimate(&memory->estimator, state, &reading);
    }
#if NG_COMMANDS
    ng_real wish[NG_COMMANDS];
    for (int i = 0; i < NG_COMMANDS; ++i) {
        wish[i] = (ng_real)memory->reals[NG_FMU_COMMAND + i];
    }
    ng_tell(state, wish);
#endif
    ng_fmu_control(memory, &reading, &command, targets);
#if NG_FMU_MONITOR
    ask_monitor(memory, reading.time_us, &command);
#endif
    write_joints(memory, &command, (const ng_target(*)[NG_LEG_JOINTS])targets);
    memory->reals[NG_FMU_SINCE_TOUCHDOWN] = (double)command.since_touchdown;
    memory->reals[NG_FMU_HIP_AHEAD] = (double)command.z[0];
    memory->reals[NG_FMU_MOMENTUM] = (double)command.z[1];
    memory->integers[NG_FMU_STANCE_LEG] = command.leg;
    memory->integers[NG_FMU_FAULT] = (int32_t)command.fault;
    memory->booleans[NG_FMU_TOUCHDOWN] = command.touchdown;
    memory->booleans[NG_FMU_SATURATED] = command.saturated;
    if (fmu->events && command.fault != before) {
        char message[MESSAGE];
        snprintf(message, sizeof message, "fault at %.6f s: %s; %s until reset", memory->time,
                 ng_fault_text(command.fault),
                 NG_FMU_SUPERVISOR ? "joints damp" : "torques are zero");
        fmu->log(fmu, NG_FMU_OK, message);
    }
}

static double distance(double a, double b) { return a < b ? b - a : a - b; }

ng_fmu_status ng_fmu_step(ng_fmu *fmu, double time, double size)
{
    ng_fmu_memory *memory = &fmu->memory;
    const double period = (double)NG_PERIOD;
    char message[MESSAGE];
    if (memory->phase != NG_FMU_STEPPING) {
        return ng_fmu_refuse(fmu, "step: expected an instance that is initialised");
    }
    if (!(distance(size, period) <= SIZE_TOLERANCE * period)) {
        snprintf(message, sizeof message, "step: expected a size of %.9g s, found %.9g s", period,
                 size);
        fmu->log(fmu, NG_FMU_DISCARD, message);
        return NG_FMU_DISCARD;
    }
    if (!(distance(time, memory->time) <= TIME_TOLERANCE * period)) {
        snprintf(message, sizeof message, "step: expected a step from %.9g s, found %.9g s",
                 memory->time, time);
        fmu->log(fmu, NG_FMU_DISCARD, message);
        return NG_FMU_DISCARD;
    }
    memory->time = time;
    tick(fmu);
    memory->time = time + size;
    return NG_FMU_OK;
}

/* The place of a reference among those from `first` on, or -1. */
static int place(ng_fmu *fmu, uint32_t reference, uint32_t first, uint32_t count)
{
    char message[MESSAGE];
    if (reference >= first && reference - first < count) {
        return (int)(reference - first);
    }
    snprintf(message, sizeof message, "value reference %lu: expected one of a variable of this type",
             (unsigned long)reference);
    ng_fmu_refuse(fmu, message);
    return -1;
}

/* Whether a variable of a kind may be written now: see fmu_model.h for the letters. */
static int writable(ng_fmu *fmu, char kind, uint32_t reference)
{
    const ng_fmu_phase phase = fmu->memory.phase;
    const int early = phase == NG_FMU_INSTANTIATED || phase == NG_FMU_INITIALIZATION;
    char message[MESSAGE];
    if (early ? kind != 'o' : (phase == NG_FMU_STEPPING && (kind == 'i' || kind == 't'))) {
        return 1;
    }
    snprintf(message, sizeof message,
             "value reference %lu: expected %s", (unsigned long)reference,
             kind == 'o' ? "an input or a parameter to set, found an output"
             : kind == 'p' ? "a fixed parameter to be set before the end of initialisation"
                           : "an instance that is not terminated");
    ng_fmu_refuse(fmu, message);
    return 0;
}

ng_fmu_status ng_fmu_read_real(ng_fmu *fmu, uint32_t reference, double *value)
{
    if (reference == NG_FMU_TIME) {
        *value = fmu->memory.time;
        return NG_FMU_OK;
    }
    const int i = place(fmu, reference, NG_FMU_FIRST_REAL, NG_FMU_REALS);
    *value = i < 0 ? 0.0 : fmu->memory.reals[i];
    return i < 0 ? NG_FMU_ERROR : NG_FMU_OK;
}

ng_fmu_status ng_fmu_read_integer(ng_fmu *fmu, uint32_t reference, int32_t *value)
{
    const int i = place(fmu, reference, NG_FMU_FIRST_INTEGER, NG_FMU_INTEGERS);
    *value = i < 0 ? 0 : fmu->memory.integers[i];
    return i < 0 ? NG_FMU_ERROR : NG_FMU_OK;
}

ng_fmu_status ng_fmu_read_boolean(ng_fmu *fmu, uint32_t reference, int *value)
{
    const int i = place(fmu, reference, NG_FMU_FIRST_BOOLEAN, NG_FMU_BOOLEANS);
    *value = i < 0 ? 0 : fmu->memory.booleans[i];
    return i < 0 ? NG_FMU_ERROR : NG_FMU_OK;
}

ng_fmu_status ng_fmu_write_real(ng_fmu *fmu, uint32_t reference, double value)
{
    const int i = place(fmu, reference, NG_FMU_FIRST_REAL, NG_FMU_REALS);
    if (i < 0 || !writable(fmu, ng_fmu_real_kind[i], reference)) {
        return NG_FMU_ERROR;
    }
    if (ng_fmu_real_kind[i] != 'i' && !(value >= 0.0 && value - value == 0.0)) {
        char message[MESSAGE];
        snprintf(message, sizeof message,
                 "value reference %lu: expected a parameter of 0 or more, found %g",
                 (unsigned long)reference, value);
        return ng_fmu_refuse(fmu, message);
    }
    fmu->memory.reals[i] = value;
    return NG_FMU_OK;
}

ng_fmu_status ng_fmu_write_integer(ng_fmu *fmu, uint32_t reference, int32_t value)
{
    const int i = place(fmu, reference, NG_FMU_FIRST_INTEGER, NG_FMU_INTEGERS);
    if (i < 0 || !writable(fmu, ng_fmu_integer_kind[i], reference)) {
        return NG_FMU_ERROR;
    }
    const int32_t most = ng_fmu_integer_most[i];
    if (value < 0 || value > most) {
        char message[MESSAGE];
        snprintf(message, sizeof message, "value reference %lu: expected 0 to %ld, found %ld",
                 (unsigned long)reference, (long)most, (long)value);
        return ng_fmu_refuse(fmu, message);
    }
    fmu->memory.integers[i] = value;
#if !NG_FMU_SUPERVISOR
    if (i == NG_FMU_FIRST_LEG) {
        fmu->memory.integers[NG_FMU_STANCE_LEG] = value; /* until the first step */
    }
#endif
    return NG_FMU_OK;
}

ng_fmu_status ng_fmu_write_boolean(ng_fmu *fmu, uint32_t reference, int value)
{
    const int i = place(fmu, reference, NG_FMU_FIRST_BOOLEAN, NG_FMU_BOOLEANS);
    if (i < 0 || !writable(fmu, ng_fmu_boolean_kind[i], reference)) {
        return NG_FMU_ERROR;
    }
    fmu->memory.booleans[i] = value != 0;
    return NG_FMU_OK;
}

ng_fmu_memory *ng_fmu_save(const ng_fmu *fmu)
{
    ng_fmu_memory *copy = malloc(sizeof *copy);
    if (copy != NULL) {
        *copy = fmu->memory;
    }
    return copy;
}
