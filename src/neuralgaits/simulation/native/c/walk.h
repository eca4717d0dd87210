/*
 * Walks in MuJoCo without anything in between: the exported controller and mj_step in one loop.
 *
 * What a tick means is written twice, here and in neuralgaits.simulation.ticks (tick and lockstep);
 * tests compare the two tick by tick. The caller owns all memory and fills the structures; a scene
 * may be shared by threads, a walk and its mjData belong to one.
 */
#ifndef NG_WALK_H
#define NG_WALK_H

#include <mujoco/mjdata.h>
#include <mujoco/mjmodel.h>

#include "adapt.h"
#include "clf_qp.h"
#include "controller.h"
#include "estimator.h"

#ifdef NG_FLOAT
#error "walks are compared with double precision"
#endif

/* What has become of a walk. */
typedef enum {
    NG_RUNNING,
    NG_WALKED,
    NG_LOW_HIP,
    NG_TORSO,
    NG_NOT_FINITE,
    NG_STALLED,
    NG_GAP,
    NG_REFUSED = -1 /* MuJoCo gave up; see ng_walk_error */
} ng_ending;

/* What stays fixed during a simulation. */
typedef struct {
    const mjModel *model;
    void (*step)(const mjModel *, mjData *); /* mj_step, from the library that is loaded already */
    /* Where the robot is in the model, and the signs and zeros of its file. */
    int root[3];                      /* slide x, slide z, pitch */
    int joints[NG_LEGS][NG_LEG_JOINTS];
    int motors[NG_LEGS][NG_LEG_JOINTS];
    double pitch_sign;
    double root_angle;                /* [rad] */
    double root_to_hip[2];            /* at pitch 0 [m] */
    double root_origin[2];            /* [m] */
    double joint_sign[NG_LEGS][NG_LEG_JOINTS];
    double joint_offset[NG_LEGS][NG_LEG_JOINTS]; /* [rad] */
    double gear[NG_LEGS][NG_LEG_JOINTS];         /* [N m] */
    /* Sensors and motors. */
    double angle_noise;               /* standard deviation [rad] */
    double rate_noise;                /* [rad/s] */
    double pitch_noise;               /* of the pitch, in place of angle_noise [rad] */
    double pitch_offset;              /* [rad] */
    int estimator;                    /* whether rates and hip velocity are estimated */
    double encoder_step;              /* resolution of angles, 0 for exact ones [rad] */
    int delay_ticks;                  /* from a reading to its torque */
    int substeps;                     /* MuJoCo steps a tick */
    double drive_stiffness;           /* of the drives' own loops, 0 without one [N m/rad] */
    double drive_damping;             /* [N m s/rad] */
    /* Floor and push. */
    double slope;                     /* rise per metre forward */
    int uneven;                       /* whether floors change their height */
    int told_height;                  /* place of the command that says how high the next foothold
                                         is, counted from 1; 0 without one */
    double room_under_foot;           /* a floor rises only below a foot that is higher [m] */
    int course;                       /* whether there are blocks in place of floors */
    int stones;                       /* whether each step has to end on a block of its own */
    int told_length, told_slope;      /* places of these commands, as told_height */
    double gap_depth;                 /* a foot this far below its stones has missed them [m] */
    double foot_radius;               /* [m] */
    double push_force;                /* [N] */
    double push_s;                    /* how long it lasts [s] */
    int push_after;                   /* touchdowns */
    /* The end of a walk. */
    int steps;                        /* touchdowns asked for */
    double lowest_hip;                /* above the floor [m] */
    double largest_pitch;             /* [rad] */
    double patience_s;                /* between two touchdowns [s] */
    /* Figures. */
    int start_up_steps;               /* left out of steady figures */
    double settling_s;                /* after a touchdown, left out likewise [s] */
    ng_law law;
    ng_clf_qp clf_qp;                 /* what that law knows, if it is one */
    ng_config config;                 /* its law is the one above */
} ng_scene;

/* Largest and smallest values over some time. */
typedef struct {
    double output_error;  /* [rad] */
    double settled_torque;/* [N m] */
    double torque;        /* [N m] */
    double joint_rate;    /* [rad/s] */
    double normal_force;  /* smallest [N] */
} ng_extremes;

/* Where a walk was at a touchdown. */
typedef struct {
    double time;   /* [s] */
    double hip;    /* forward [m] */
    double energy; /* mechanical work so far [J] */
} ng_milestone;

/*
 * A touchdown in numbers: time [s], hip [m], the new foothold from the old one, (x, z) [m], its x
 * in the world [m]; of a gait with commands also the reference of its speed and the measured one
 * [m/s], see ng_adapt, and the commands of the step that ended there.
 */
#define NG_STRIDE (5 + (NG_COMMANDS ? 2 + NG_COMMANDS : 0))

/* One walk. */
typedef struct {
    ng_state controller;
    ng_estimator estimator;
    uint32_t time_us;
    double age;               /* since the last touchdown or the start [s] */
    double clock;             /* ticks times their length, added up [s] */
    double touch[NG_LEGS];    /* normal force on each foot [N] */
    double floor[NG_LEGS];    /* level under each foot at x = 0; on a course, of the foothold that
                                 each had last [m] */
    double feet[2][2];        /* stance and swing foot in the world, (x, z) of their spheres [m] */
    const double *rises;      /* of the next floors: more than touchdowns to come [m] */
    int rises_used;
    int rise_pending;
    double next_rise;         /* [m] */
    double push_start;        /* [s] */
    double push_wait;         /* from its touchdown to the push [s] */
    double *late;             /* controls under way: delay_ticks + 1 rows of nu */
    double *believed;         /* estimated hip speeds of delay_ticks + 1 ticks [m/s] */
    double speed_error;       /* sum of squares of how far they were from what came [m^2/s^2] */
    double *strides;          /* rows of NG_STRIDE, more than touchdowns to come; or NULL */
    int strides_used;
#if NG_COMMANDS
    const double *orders;     /* rows of NG_COMMANDS: what each touchdown to come is to latch */
    int orders_used;
    const double *seen;       /* of a course: rows of the middles (x, z) of stones [m], or of x [m]
                                 and the slope seen there [rad]; or NULL */
    int seen_rows;
    double told[NG_COMMANDS]; /* on a course, of the next touchdown */
    ng_adapt adapt;           /* of the speed; the host says whether it is active */
#endif
    int ticks;
    int steps;
    int saturated;            /* ticks */
    int relaxed[2];           /* ticks: see ng_command */
    int ending;               /* an ng_ending */
    int plant_steps;
    double energy;
    double peak_torque;
    ng_milestone first, last;
    ng_extremes steady, running;
} ng_walk;

/* What a log holds of a tick. */
typedef struct {
    double time;                                 /* [s] */
    double torque[NG_LEGS][NG_LEG_JOINTS];       /* [N m] */
    double actuated[NG_ACTUATED];                /* [N m] */
    double q[NG_COORDINATES], dq[NG_COORDINATES];/* measured [rad], [rad/s] */
    double y_d[NG_ACTUATED], dy_d[NG_ACTUATED];  /* [rad], [rad/s] */
    double z[2];                                 /* measured (m, kg m^2/s) */
    double leg, since_touchdown, touchdown, saturated, relaxed[2];
    double pitch, dpitch;                        /* without noise [rad], [rad/s] */
    double angles[NG_LEGS][NG_LEG_JOINTS], rates[NG_LEGS][NG_LEG_JOINTS]; /* likewise */
    double hip_velocity[2];                      /* [m/s] */
    double normal_force[NG_LEGS];                /* [N] */
    double floor[NG_LEGS];                       /* [m] */
    double clearance;                            /* swing foot above the slope [m] */
    double feet[2][2];                           /* stance and swing foot in the world [m] */
#if NG_COMMANDS
    double told[2][NG_COMMANDS];                 /* of the step before, and of this one */
#endif
} ng_record;

/* Sizes of ng_scene, ng_walk and ng_record, for hosts in other languages. */
void ng_walk_sizes(int sizes[3]);

/*
 * Before the first tick, standing on `leg`, at a command that has been the same for long (NG_COMMANDS
 * numbers, or NULL); then the caller sets rises, late, strides, orders or what is seen, and the push.
 */
void ng_walk_start(ng_walk *walk, int leg, const double *command);

/*
 * Walk on for up to `ticks` ticks, or to the end. `data` holds the walk's state.
 *
 * noise: standard normal draws, one row of 2 (1 + NG_LEGS NG_LEG_JOINTS) numbers a tick: of
 * angles and of rates, pitch first; or NULL. records, states (time, qpos, qvel): a row a tick, or
 * NULL. Returns the number of ticks decided, the last one of an ended walk included.
 */
int ng_walk_run(const ng_scene *scene, ng_walk *walk, mjData *data, int ticks,
                const double *noise, ng_record *records, double *states);

/*
 * One tick without a step of MuJoCo: what is decided at a state, and the controls it asks for.
 * For hosts that step the plant themselves and set touch and floor of the walk; without noise.
 */
void ng_walk_tick(const ng_scene *scene, ng_walk *walk, const mjData *data, double *controls,
                  ng_record *record);

/* Tell MuJoCo where its errors go: the address of mju_user_error. Once, before any walk. */
void ng_walk_catch(void (**user_error)(const char *));

/* The error that ended a walk of this thread as NG_REFUSED. */
const char *ng_walk_error(void);

#endif
