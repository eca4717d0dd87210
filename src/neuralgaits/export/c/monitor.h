/*
 * Which proved sets the state is in that the controller is told, and by how much: beside the tick.
 *
 * The sets, and the hash of the proof that they are from: monitor_set.h. An answer is about the
 * model, at the q and dq of a tick; docs/monitor.md says what it does not cover. The caller owns
 * all memory.
 */
#ifndef NG_MONITOR_H
#define NG_MONITOR_H

#include "monitor_set.h"

/* The answer about the set of one level of the proof. */
typedef struct {
    int level;
    int inside;          /* 1: no margin is negative; 0 after a fault of the controller */
    ng_real margin;      /* the smallest that counts, see monitor_set.h; -NG_NEVER for no number */
    const char *name;    /* of that margin; "fault" after a fault */
    uint64_t outside_us; /* time outside since ng_monitor_start [us] */
    uint64_t stretch_us; /* of it, since the last tick inside [us] */
} ng_membership;

typedef struct {
    ng_membership levels[NG_MONITOR_LEVELS]; /* lowest first */
    int admissible;           /* 1: the latched commands are in the proved ranges and changes;
                                 at others the proof is about no state, inside or not */
    int in_time;              /* 1: no later than the proved hold; -1: none is proved (level 5) */
    uint32_t gap_us;          /* time since the last tick, 0 at the first [us] */
    const char *proof_sha256; /* of the proof file */
    const char *robot_sha256; /* of the robot file */
} ng_monitor_answer;

/* Called with every answer, before the torques reach the drives: it may change the command. */
typedef void ng_fallback(const ng_monitor_answer *answer, ng_command *command, void *own);

typedef struct {
    ng_fallback *fallback; /* or NULL for none */
    void *own;             /* what it is given, too */
    int running;           /* 0 before the first tick */
    uint32_t last_us;      /* time of the last tick [us] */
    uint64_t outside_us[NG_MONITOR_LEVELS];
    uint64_t stretch_us[NG_MONITOR_LEVELS];
} ng_monitor;

/* Before the first tick, beside ng_start; no fallback. */
void ng_monitor_start(ng_monitor *monitor);

/* After every ng_step, with its state and command, and the time of its reading. */
void ng_monitor_step(ng_monitor *monitor, const ng_state *state, uint32_t time_us,
                     ng_command *command, ng_monitor_answer *answer);

/* The answer about the set of level number `k`, ng_monitor_level[k], without any memory. */
ng_membership ng_monitor_membership(int k, const ng_state *state, const ng_command *command);

/* Whether the commands of the step before and of this one are those that the proof is about. */
int ng_monitor_admissible(const ng_state *state);

#endif
