/*
 * The controller on the exporter's own machine: cases for comparison, times, hostile inputs.
 * Numbers in and out are doubles in the machine's order, one record after the other; the layout of
 * a record is that of `read_case` and `write_result`, which neuralgaits/export/cases.py mirrors.
 */
#define _POSIX_C_SOURCE 200809L
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "controller.h"

#if NG_COMMANDS
#define STEP NG_STEP
#define GIVEN_STEP numbers,
#else
#define STEP 0
#define GIVEN_STEP
#endif
#define JOINTS (NG_LEGS * NG_LEG_JOINTS)
#define CASE (18 + 4 * NG_ACTUATED + 4 * JOINTS + 4 * NG_COMMANDS + STEP)
#define RESULT (10 + 3 * NG_ACTUATED + 2 * JOINTS + 3 * NG_COMMANDS + STEP)

typedef struct {
    ng_config config;
    ng_state state;
    ng_encoders encoders;
} ng_case;

static const double *take(const double *from, ng_real *to, int count)
{
    for (int i = 0; i < count; ++i) {
        to[i] = (ng_real)from[i];
    }
    return from + count;
}

static void read_case(const double *in, ng_case *one)
{
    const ng_state fresh = {0}; /* what no case sets */
    ng_state *state = &one->state;
    ng_encoders *encoders = &one->encoders;
    *state = fresh;
    one->config = ng_config_of(&ng_laws[(int)in[0]]);
    one->config.blend_s = (ng_real)in[1];
    one->config.torque_rate = (ng_real)in[2];
    state->leg = (int)in[3];
    state->since_touchdown = in[4] < 1e30 ? (ng_real)in[4] : NG_NEVER;
    state->ticks_to_policy = (int)in[5];
    state->running = (int)in[6];
    state->last_us = (uint32_t)in[7];
    state->elapsed = (ng_real)in[8];
    state->airborne = (ng_real)in[9];
    state->fault = (ng_fault)(int)in[10];
    encoders->time_us = (uint32_t)in[11];
    encoders->pitch = (ng_real)in[12];
    encoders->dpitch = (ng_real)in[13];
    in += 14;
    in = take(in, state->held.y, NG_ACTUATED);
    in = take(in, state->held.dy, NG_ACTUATED);
    in = take(in, state->held.slope, NG_ACTUATED);
    in = take(in, state->held.drift, NG_ACTUATED);
    in = take(in, &state->posture[0][0], JOINTS);
    in = take(in, &state->torque[0][0], JOINTS);
    in = take(in, encoders->base_velocity, 2);
    in = take(in, encoders->normal_force, NG_LEGS);
    in = take(in, &encoders->joints[0][0], JOINTS);
    in = take(in, &encoders->djoints[0][0], JOINTS);
#if NG_COMMANDS
    ng_real given[NG_COMMANDS];
    in = take(in, given, NG_COMMANDS);
    in = take(in, state->requested, NG_COMMANDS);
    in = take(in, state->before, NG_COMMANDS);
    in = take(in, state->after, NG_COMMANDS);
    take(in, state->step, NG_STEP);
    ng_tell(state, given);
#endif
}

static double *give(const ng_real *from, double *to, int count)
{
    for (int i = 0; i < count; ++i) {
        to[i] = (double)from[i];
    }
    return to + count;
}

static void write_result(const ng_state *state, const ng_command *command, double *out)
{
    ng_real motors[NG_LEGS][NG_LEG_JOINTS];
    ng_drive(command, motors);
    *out++ = (double)command->fault;
    *out++ = (double)command->leg;
    *out++ = (double)command->touchdown;
    *out++ = (double)command->saturated;
    *out++ = (double)command->since_touchdown;
    *out++ = (double)state->ticks_to_policy;
    *out++ = (double)state->elapsed;
    *out++ = (double)state->airborne;
    out = give(command->z, out, 2);
    out = give(command->y_d, out, NG_ACTUATED);
    out = give(command->dy_d, out, NG_ACTUATED);
    out = give(command->actuated, out, NG_ACTUATED);
    out = give(&command->torque[0][0], out, JOINTS);
    out = give(&motors[0][0], out, JOINTS);
#if NG_COMMANDS
    out = give(state->requested, out, NG_COMMANDS);
    out = give(state->before, out, NG_COMMANDS);
    out = give(state->after, out, NG_COMMANDS);
    give(state->step, out, NG_STEP);
#endif
}

static void step(ng_case *one, ng_command *command)
{
    ng_measurement reading;
    ng_measure(&one->encoders, &reading);
    ng_step(&one->config, &one->state, &reading, command);
}

static int compare(double *cases, long count)
{
    for (long i = 0; i < count; ++i) {
        ng_case one;
        ng_command command;
        double out[RESULT];
        read_case(cases + i * CASE, &one);
        step(&one, &command);
        write_result(&one.state, &command, out);
        if (fwrite(out, sizeof out, 1, stdout) != 1) {
            return 1;
        }
    }
    return 0;
}

/* Records of z, dz, ddz and the numbers of a step; results y, dy, slope, drift, and y, dy of the function for rates. */
static int policy(const double *records, long count)
{
    for (long i = 0; i < count; ++i) {
        ng_real z[2], dz[2], ddz[2], all[6 * NG_ACTUATED];
        double out[6 * NG_ACTUATED];
        const double *in = records + (6 + STEP) * i;
        in = take(take(take(in, z, 2), dz, 2), ddz, 2);
#if NG_COMMANDS
        ng_real numbers[NG_STEP];
        take(in, numbers, NG_STEP);
#endif
        ng_policy_path(ddz, dz, GIVEN_STEP z, all + 3 * NG_ACTUATED, all + NG_ACTUATED,
                       all + 2 * NG_ACTUATED, all);
        ng_policy_rate(dz, GIVEN_STEP z, all + 5 * NG_ACTUATED, all + 4 * NG_ACTUATED);
        give(all, out, 6 * NG_ACTUATED);
        if (fwrite(out, sizeof out, 1, stdout) != 1) {
            return 1;
        }
    }
    return 0;
}

static double now_us(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return 1e6 * (double)t.tv_sec + 1e-3 * (double)t.tv_nsec;
}

static int ascending(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static void report(const char *name, double *times, long count)
{
    qsort(times, (size_t)count, sizeof *times, ascending);
    printf("%s %.4f %.4f\n", name, times[count / 2], times[count * 99 / 100]);
}

/* One call at a time, the reading of the clock included. */
static int latency(double *cases, long count)
{
    double *times = malloc((size_t)count * sizeof *times);
    volatile ng_real sink = NG(0.0);
    if (times == NULL) {
        return 1;
    }
    for (int kind = 0; kind < 3 + NG_LAW_COUNT + (NG_COMMANDS > 0); ++kind) {
        for (long i = 0; i < count; ++i) {
            ng_case one;
            ng_command command;
            ng_real y[NG_ACTUATED], dy[NG_ACTUATED], slope[NG_ACTUATED], drift[NG_ACTUATED];
            ng_real motors[NG_LEGS][NG_LEG_JOINTS];
            ng_real z[2], dz[2] = {NG(0.5), NG(10.0)}, ddz[2] = {NG(0.0), NG(100.0)};
            read_case(cases + i * CASE, &one);
            const ng_real phase = (ng_real)(i % 1009) / NG(1009.0);
            for (int k = 0; k < 2; ++k) {
                z[k] = ng_z_lower[k] + phase * (ng_z_upper[k] - ng_z_lower[k]);
            }
#if NG_COMMANDS
            ng_real numbers[NG_STEP];
            memcpy(numbers, one.state.step, sizeof numbers);
            one.state.since_touchdown = NG(0.0); /* no touchdown: that is timed by itself */
#endif
            if (kind >= 3 && kind < 3 + NG_LAW_COUNT) {
                one.config.law = &ng_laws[kind - 3];
                one.state.ticks_to_policy = 0;
                one.state.fault = NG_NO_FAULT;
            }
            const double began = now_us();
            if (kind == 1) {
                ng_policy_rate(dz, GIVEN_STEP z, dy, y);
                sink = y[0] + dy[0];
            } else if (kind == 2) {
                ng_policy_path(ddz, dz, GIVEN_STEP z, drift, dy, slope, y);
                sink = y[0] + drift[0];
#if NG_COMMANDS
            } else if (kind == 3 + NG_LAW_COUNT) {
                ng_policy_step(one.state.after, one.state.before, numbers);
                sink = numbers[0];
#endif
            } else if (kind >= 3) {
                step(&one, &command);
                ng_drive(&command, motors);
                sink = motors[0][0];
            }
            times[i] = now_us() - began;
        }
        const char *names[] = {"clock", "policy", "policy_path"};
        const int law = kind - 3;
        report(kind < 3 ? names[kind] : law < NG_LAW_COUNT ? ng_laws[law].name : "policy_step",
               times, count);
    }
    (void)sink;
    free(times);
    return 0;
}

/* xorshift64*: Vigna (2016). */
static uint64_t draw(uint64_t *seed)
{
    *seed ^= *seed >> 12;
    *seed ^= *seed << 25;
    *seed ^= *seed >> 27;
    return *seed * 2685821657736338717ull;
}

static double uniform(uint64_t *seed) { return (double)(draw(seed) >> 11) / 9007199254740992.0; }

/* Sometimes a number no sensor gives, often any bits at all, mostly one near what is right. */
static double hostile(uint64_t *seed, double usual, int *spoilt)
{
    static const char *const words[] = {"nan", "inf", "-inf", "1e308", "-1e308", "3e38",
                                        "4.9e-324", "1e-40", "-0.0", "0", "1e6", "-1e3"};
    const uint64_t kind = draw(seed) % 64;
    if (kind == 0) {
        *spoilt = 1;
        return strtod(words[draw(seed) % (sizeof words / sizeof *words)], NULL);
    }
    if (kind == 1) {
        const uint64_t bits = draw(seed);
        double value;
        memcpy(&value, &bits, sizeof value);
        *spoilt = 1;
        return value;
    }
    return usual * (4.0 * uniform(seed) - 2.0);
}

/* Walks of hostile readings through one state; a fault is cleared by a new start. */
static int fuzz(long count, uint64_t seed)
{
    long broken = 0, faults = 0, spoilt_count = 0;
    ng_state state;
    ng_start(&state, 0);
    for (long i = 0; i < count; ++i) {
        ng_case one;
        ng_command command;
        int spoilt = 0;
        one.config = ng_config_of(&ng_laws[draw(&seed) % NG_LAW_COUNT]);
        one.config.blend_s = draw(&seed) % 4 == 0 ? NG(0.2) : NG(0.0);
        if (state.fault != NG_NO_FAULT || draw(&seed) % 64 == 0) {
            ng_start(&state, (int)(draw(&seed) % 2));
        }
#if NG_COMMANDS
        ng_real told[NG_COMMANDS];
        for (int k = 0; k < NG_COMMANDS; ++k) {
            int strange = 0;
            told[k] = (ng_real)hostile(&seed, (double)ng_command_high[k], &strange);
        }
        ng_tell(&state, told);
#endif
        one.state = state;
        ng_encoders *encoders = &one.encoders;
        encoders->time_us = state.last_us + (draw(&seed) % 64 == 0 ? (uint32_t)draw(&seed) : 1000u);
        encoders->pitch = (ng_real)hostile(&seed, 0.4, &spoilt);
        encoders->dpitch = (ng_real)hostile(&seed, 5.0, &spoilt);
        for (int leg = 0; leg < NG_LEGS; ++leg) {
            encoders->base_velocity[leg] = (ng_real)hostile(&seed, 2.0, &spoilt);
            encoders->normal_force[leg] = (ng_real)hostile(&seed, 300.0, &spoilt);
            for (int k = 0; k < NG_LEG_JOINTS; ++k) {
                const double middle = 0.5 * (double)(ng_joint_lower[leg][k] + ng_joint_upper[leg][k]);
                const double file = (middle - (double)ng_joint_offset[leg][k]) *
                                    (double)ng_joint_sign[leg][k];
                encoders->joints[leg][k] = (ng_real)(file + hostile(&seed, 0.5, &spoilt));
                encoders->djoints[leg][k] = (ng_real)hostile(&seed, 10.0, &spoilt);
            }
        }
        step(&one, &command);
        state = one.state;
        faults += command.fault != NG_NO_FAULT;
        spoilt_count += spoilt;
        int bad = 0;
        for (int leg = 0; leg < NG_LEGS; ++leg) {
            for (int k = 0; k < NG_LEG_JOINTS; ++k) {
                const double torque = (double)command.torque[leg][k];
                const double limit = (double)ng_torque_limit[0] * 1.0001;
                bad |= !(torque <= limit && torque >= -limit);
                bad |= command.fault != NG_NO_FAULT && torque != 0.0;
            }
        }
        broken += bad;
    }
    printf("inputs %ld spoilt %ld faults %ld broken %ld\n", count, spoilt_count, faults, broken);
    return broken != 0;
}

static double *read_cases(const char *path, long *count)
{
    FILE *file = fopen(path, "rb");
    if (file == NULL || fseek(file, 0, SEEK_END) != 0) {
        return NULL;
    }
    const long size = ftell(file);
    double *cases = malloc((size_t)size);
    rewind(file);
    if (cases == NULL || fread(cases, 1, (size_t)size, file) != (size_t)size) {
        fclose(file);
        return NULL;
    }
    fclose(file);
    *count = size / (long)sizeof(double);
    return cases;
}

int main(int argc, char **argv)
{
    long count = 0;
    if (argc == 2 && strcmp(argv[1], "selftest") == 0) {
        const int line = ng_selftest();
        printf("selftest %d\n", line);
        return line != 0;
    }
    if (argc == 2 && strcmp(argv[1], "sizes") == 0) {
        printf("state %zu\nencoders %zu\nmeasurement %zu\ncommand %zu\nconfig %zu\n",
               sizeof(ng_state), sizeof(ng_encoders), sizeof(ng_measurement), sizeof(ng_command),
               sizeof(ng_config));
        return 0;
    }
    if (argc == 4 && strcmp(argv[1], "fuzz") == 0) {
        return fuzz(atol(argv[2]), strtoull(argv[3], NULL, 10) + 1);
    }
    if (argc == 3) {
        double *cases = read_cases(argv[2], &count);
        int failed = 2;
        if (cases != NULL && strcmp(argv[1], "compare") == 0) {
            failed = compare(cases, count / CASE);
        } else if (cases != NULL && strcmp(argv[1], "policy") == 0) {
            failed = policy(cases, count / (6 + STEP));
        } else if (cases != NULL && strcmp(argv[1], "latency") == 0) {
            failed = latency(cases, count / CASE);
        }
        free(cases);
        return failed;
    }
    fprintf(stderr, "usage: check selftest | sizes | compare FILE | policy FILE | latency FILE | fuzz COUNT SEED\n");
    return 2;
}
