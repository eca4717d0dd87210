/*
 * The controller as an FMU for co-simulation: what FMI 2.0 and FMI 3.0 have in common.
 *
 * Variables, their places and their start values: fmu_model.h. The functions of the standards are
 * in fmi2.c and fmi3.c. An instance owns all of its memory, so instances do not disturb each other.
 */
#ifndef NG_FMU_H
#define NG_FMU_H

#include <stddef.h>

#include "estimator.h"
#include "fmu_model.h"

#if NG_FMU_MONITOR
#include "monitor.h"
#endif

typedef enum { NG_FMU_OK, NG_FMU_DISCARD, NG_FMU_ERROR } ng_fmu_status;

typedef enum {
    NG_FMU_INSTANTIATED,
    NG_FMU_INITIALIZATION,
    NG_FMU_STEPPING,
    NG_FMU_TERMINATED
} ng_fmu_phase;

/* What a saved state holds: everything that steps and setters change. */
typedef struct {
    ng_fmu_phase phase;
    double start_time; /* [s] */
    double time;       /* at which the next step begins [s] */
    double reals[NG_FMU_REALS];
    int32_t integers[NG_FMU_INTEGERS];
    int booleans[NG_FMU_BOOLEANS];
#if NG_FMU_SUPERVISOR
    ng_supervisor_config config;
    ng_supervisor supervisor;
#else
    ng_config config;
    ng_state state;
#endif
    ng_estimator estimator;
#if NG_FMU_MONITOR
    ng_monitor monitor;
#endif
} ng_fmu_memory;

typedef struct ng_fmu ng_fmu;

/* Hands a message to the host, in the way of its version of the standard. */
typedef void ng_fmu_log(ng_fmu *fmu, ng_fmu_status status, const char *message);

/* An instance; fmi2.c and fmi3.c put it at the head of theirs. */
struct ng_fmu {
    ng_fmu_memory memory;
    ng_fmu_log *log;
    int events; /* whether faults are logged, too; errors always are */
};

/* To the start values, before initialisation. */
void ng_fmu_reset(ng_fmu *fmu);

/* From one phase to the next. Out of order they are errors and change nothing. */
ng_fmu_status ng_fmu_enter_initialization(ng_fmu *fmu, double start_time);
ng_fmu_status ng_fmu_exit_initialization(ng_fmu *fmu);
ng_fmu_status ng_fmu_terminate(ng_fmu *fmu);

/*
 * One tick: the inputs are read, and the outputs are those of the tick until the next. A step of
 * another size, or that begins at another time, is discarded and changes nothing.
 */
ng_fmu_status ng_fmu_step(ng_fmu *fmu, double time, double size);

/* A value by its reference. One that may not be read or written now is an error. */
ng_fmu_status ng_fmu_read_real(ng_fmu *fmu, uint32_t reference, double *value);
ng_fmu_status ng_fmu_read_integer(ng_fmu *fmu, uint32_t reference, int32_t *value);
ng_fmu_status ng_fmu_read_boolean(ng_fmu *fmu, uint32_t reference, int *value);
ng_fmu_status ng_fmu_write_real(ng_fmu *fmu, uint32_t reference, double value);
ng_fmu_status ng_fmu_write_integer(ng_fmu *fmu, uint32_t reference, int32_t value);
ng_fmu_status ng_fmu_write_boolean(ng_fmu *fmu, uint32_t reference, int value);

/* A copy of everything that a later ng_fmu_restore brings back, or NULL without memory. */
ng_fmu_memory *ng_fmu_save(const ng_fmu *fmu);

/*
 * The controller of an instance: that of fmu_gait.c is in the middle of a walk from its first tick,
 * that of fmu_supervised.c damps, stands, walks and stops as requested.
 */
void ng_fmu_start_control(ng_fmu_memory *memory);
ng_state *ng_fmu_state(ng_fmu_memory *memory);

/* One tick: torques, and targets of the drives in the robot file's order and signs. */
void ng_fmu_control(ng_fmu_memory *memory, const ng_measurement *reading, ng_command *command,
                    ng_target targets[NG_LEGS][NG_LEG_JOINTS]);

/* Whether the robot walks, so that its state may be compared with sets of a walk. */
int ng_fmu_walks(const ng_fmu_memory *memory);

/* Report an error. */
ng_fmu_status ng_fmu_refuse(ng_fmu *fmu, const char *message);

#endif
