/*
 * Adapt the commanded speed from step to step, so that a robot that is not its file walks as told:
 * another centre of mass, a slope, other friction. A gait that takes the command `speed` has this.
 * Of a gait that takes the command `lean` it is learned where the torso's centre of mass is, of one
 * that takes `slope` how the ground lies.
 *
 * Call ng_adapt_start beside ng_start_at, ng_adapt_tell in place of ng_tell, and ng_adapt_step after
 * every ng_step. The commands stay in the range, and the controller limits their change, so a proof
 * about every sequence of commands is about these, however wrong the measured speed is.
 */
#ifndef NG_ADAPT_H
#define NG_ADAPT_H

#include "controller.h"

#if NG_COMMANDS
/* What is remembered from step to step. */
typedef struct {
    int active;        /* 1: commands are adapted; 0: they are those told. At any tick */
    int begun;         /* 0 before the first touchdown; set it to 0 where a walk ends */
    int measured;      /* whether the step before the last touchdown was measured */
    uint32_t last_us;  /* time of the last touchdown [us] */
    ng_real hip;       /* ahead of the foot there, see ng_adapt_step [m] */
    ng_real walked;    /* mean speed of the last measured step [m/s] */
    ng_real reference; /* what this step is to walk: as told, spread over steps [m/s] */
    ng_real integral;  /* of errors [m/s] */
    ng_real error;     /* of the last measured step: reference - walked [m/s] */
    int learns;        /* 1: the lean is learned; 0: it is the one told. At any tick */
    int lean_steps;    /* steps that showed a lean */
    ng_real believed;  /* mean of the leans that steps showed, the one under way not yet [m] */
    ng_real shown;     /* lean that the last step showed [m] */
    int lean_doubted;  /* whether that cannot be; the belief is then as it was */
    uint32_t tick_us;  /* time of the last tick [us] */
    ng_real since;     /* of the window of the step under way, to the last tick; else -1 [s] */
    ng_real least;     /* shortest window that counts [s] */
    ng_real q[NG_COORDINATES];   /* at the last tick [rad] */
    ng_real of_momentum[3][2];   /* sums over the window, see control/lean_sums.py */
    ng_real of_ahead[3][2];
    int tilts;             /* 1: the slope is learned; 0, at first: it is the one told. At any tick */
    int slope_steps;       /* touchdowns that showed a slope */
    ng_real slope;         /* mean of the slopes shown: the next touchdown latches it [rad] */
    ng_real slope_shown;   /* slope of the line through both feet at the last touchdown [rad] */
    int slope_doubted;     /* whether that cannot be; the belief is then as it was */
    int slope_repeated;    /* touchdowns in a row that showed another slope than the mean */
    ng_real slope_apart;   /* mean of these [rad] */
    int slope_pause;       /* touchdowns until errors are summed, after that became the mean */
} ng_adapt;

/*
 * What to give ng_start_at and ng_adapt_start where `told` is told: of a gait that takes speed and
 * lean the speed is at least the middle of its range. No step has shown the lean yet, and a slow
 * robot whose weight is far behind would stall. Later steps are as ng_adapt_tell is told.
 */
void ng_adapt_first(const ng_real told[NG_COMMANDS], ng_real first[NG_COMMANDS]);

/* Before the first tick; commands as in ng_start_at. Speed and lean are adapted, no slope. */
void ng_adapt_start(ng_adapt *adapt, const ng_real told[NG_COMMANDS]);

/*
 * In place of ng_tell, before every ng_step: what the operator tells, the speed adapted, the lean
 * as the steps and the one under way show it. Returns as ng_tell does.
 */
int ng_adapt_tell(const ng_adapt *adapt, ng_state *state, const ng_real told[NG_COMMANDS]);

/*
 * After every ng_step, with its state, reading and command, and what was told before it. At a
 * touchdown it measures the step that ended: how far the hip went over the foot, by joint angles
 * and pitch, in that time. The lean follows from every tick in between, the slope from both feet.
 */
void ng_adapt_step(ng_adapt *adapt, const ng_state *state, const ng_measurement *reading,
                   const ng_command *command, const ng_real told[NG_COMMANDS]);
#endif

#endif
