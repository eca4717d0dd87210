/*
 * The monitor on the exporter's own machine: records of q, dq, and with commands before, after and
 * the step's numbers; results, for each level, inside, the margin and the place of its name, then
 * all margins of each set; and whether the commands are admissible. All as doubles.
 * `export/monitor_check.py` mirrors the layout.
 */
#define _POSIX_C_SOURCE 200809L
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "monitor.h"

#if NG_COMMANDS
#define CASE (2 * NG_COORDINATES + 2 * NG_COMMANDS + NG_STEP)
#else
#define CASE (2 * NG_COORDINATES)
#endif
#define RESULT (3 * NG_MONITOR_LEVELS + NG_MONITOR_SETS * NG_MONITOR_MARGINS + 1)

static const double *take(const double *from, ng_real *to, int count)
{
    for (int i = 0; i < count; ++i) {
        to[i] = (ng_real)from[i];
    }
    return from + count;
}

static void read_case(const double *in, ng_state *state, ng_command *command)
{
    const ng_state no_state = {0};
    const ng_command no_command = {0};
    *state = no_state;
    *command = no_command;
    in = take(in, command->q, NG_COORDINATES);
    in = take(in, command->dq, NG_COORDINATES);
#if NG_COMMANDS
    in = take(in, state->before, NG_COMMANDS);
    in = take(in, state->after, NG_COMMANDS);
    take(in, state->step, NG_STEP);
#endif
}

static double place(int set, const char *name)
{
    for (int i = 0; i < ng_monitor_ends[set] + ng_monitor_walls[set]; ++i) {
        if (ng_monitor_names[set][i] == name) {
            return (double)i;
        }
    }
    return -1.0;
}

static int answer(const double *in)
{
    ng_state state;
    ng_command command;
    double result[RESULT], *out = result;
    read_case(in, &state, &command);
    for (int k = 0; k < NG_MONITOR_LEVELS; ++k) {
        const ng_membership found = ng_monitor_membership(k, &state, &command);
        *out++ = (double)found.inside;
        *out++ = (double)found.margin;
        *out++ = place(ng_monitor_set_of[k], found.name);
    }
    for (int set = 0; set < NG_MONITOR_SETS; ++set) {
        ng_real margins[NG_MONITOR_MARGINS] = {0};
        ng_monitor_margins(set, &state, &command, margins);
        for (int i = 0; i < NG_MONITOR_MARGINS; ++i) {
            *out++ = (double)margins[i];
        }
    }
    *out++ = (double)ng_monitor_admissible(&state);
    return fwrite(result, sizeof result, 1, stdout) == 1;
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

/* Names, and the times of one call each [us]: p50, p99, the reading of the clock included. */
static int latency(const double *cases, long count)
{
    double *times = malloc((size_t)count * sizeof *times);
    volatile ng_real sink = NG(0.0);
    if (times == NULL) {
        return 1;
    }
    for (int kind = 0; kind <= NG_MONITOR_SETS; ++kind) {
        ng_monitor monitor;
        ng_monitor_start(&monitor);
        for (long i = 0; i < count; ++i) {
            ng_state state;
            ng_command command;
            ng_monitor_answer found;
            ng_real margins[NG_MONITOR_MARGINS];
            read_case(cases + i * CASE, &state, &command);
            const double began = now_us();
            if (kind < NG_MONITOR_SETS) {
                ng_monitor_margins(kind, &state, &command, margins);
                sink = margins[0];
            } else {
                ng_monitor_step(&monitor, &state, (uint32_t)i * 1000u, &command, &found);
                sink = found.levels[0].margin;
            }
            times[i] = now_us() - began;
        }
        qsort(times, (size_t)count, sizeof *times, ascending);
        printf("%d %.4f %.4f\n", kind, times[count / 2], times[count * 99 / 100]);
    }
    (void)sink;
    free(times);
    return 0;
}

/* Ticks of one monitor, a state and its time [us] each: for each answer what the caller is told. */
static int ticks(const double *in, long count)
{
    ng_state state;
    ng_command command;
    ng_monitor monitor;
    ng_monitor_answer found;
    ng_monitor_start(&monitor);
    for (long i = 0; i + CASE < count; i += CASE + 1) {
        read_case(in + i, &state, &command);
        ng_monitor_step(&monitor, &state, (uint32_t)in[i + CASE], &command, &found);
        printf("%u %d %d", (unsigned)found.gap_us, found.in_time, found.admissible);
        for (int k = 0; k < NG_MONITOR_LEVELS; ++k) {
            const ng_membership *one = &found.levels[k];
            printf(" %d %d %s %llu %llu", one->level, one->inside, one->name,
                   (unsigned long long)one->outside_us, (unsigned long long)one->stretch_us);
        }
        printf(" %s %s\n", found.proof_sha256, found.robot_sha256);
    }
    return 0;
}

int main(int argc, char **argv)
{
    double *cases = NULL;
    long count = 0;
    int failed = 2;
    FILE *file = argc == 3 ? fopen(argv[2], "rb") : NULL;
    if (file != NULL && fseek(file, 0, SEEK_END) == 0) {
        const long size = ftell(file);
        count = size / (long)sizeof(double);
        cases = malloc((size_t)size + 1u);
        rewind(file);
        if (cases != NULL && fread(cases, 1, (size_t)size, file) == (size_t)size) {
            if (strcmp(argv[1], "compare") == 0) {
                failed = 0;
                for (long i = 0; i < count / CASE && !failed; ++i) {
                    failed = !answer(cases + i * CASE);
                }
            } else if (strcmp(argv[1], "latency") == 0) {
                failed = latency(cases, count / CASE);
            } else if (strcmp(argv[1], "ticks") == 0) {
                failed = ticks(cases, count);
            }
        }
        free(cases);
    }
    if (file != NULL) {
        fclose(file);
    }
    if (failed == 2) {
        fprintf(stderr, "usage: check_monitor compare FILE | latency FILE | ticks FILE\n");
    }
    return failed;
}
