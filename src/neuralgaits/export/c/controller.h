/*
 * One control tick as a function: sensors in, joint torques and the next state out.
 *
 * The caller owns all memory; nothing here allocates or keeps a state of its own. Call ng_start
 * once, then ng_step once every NG_PERIOD. Joint orders, signs and limits: gait.h.
 */
#ifndef NG_CONTROLLER_H
#define NG_CONTROLLER_H

#include "gait.h"
#include "ng_math.h"

#ifndef NG_COMMANDS
#define NG_COMMANDS 0 /* a gait that is told nothing */
#endif
#ifndef NG_LEAN_COMMAND
#define NG_LEAN_COMMAND 0 /* or that is not told how far the torso's centre of mass is ahead */
#endif
#ifndef NG_SLOPE_COMMAND
#define NG_SLOPE_COMMAND 0 /* or how the ground under its next foothold lies */
#endif
#if NG_LEAN_COMMAND
/* Functions of the robot have the lean as an argument: the one that is believed. */
#define NG_BELIEVED(lean) lean,
#else
#define NG_BELIEVED(lean)
#endif

typedef struct ng_config ng_config;
typedef struct ng_desired ng_desired;
typedef struct ng_command ng_command;

/*
 * What a host may do in place of clipping: from the state and the law's torques in the command to
 * torques within limits. Returns whether any is at its limit.
 */
typedef int ng_apply_limits(const ng_config *config, const ng_desired *wanted, ng_command *command);

/*
 * Torque u0 and inertia M of the outputs as Chebyshev series of phase and level, each of which runs
 * from 0 to 1 over the gait's tube. Both level off where the series end.
 */
typedef struct {
    ng_real start, stride;   /* of z1 over a step [m] */
    ng_real margin[2];       /* of phase and level, around the tube */
    int fence_terms[2];      /* in phase and in level: 1 in level */
    int torque_terms[2];     /* in phase and in level, at most NG_SERIES */
    int inertia_terms[2];    /* at most as many */
    const ng_real *fences;   /* z2^2/2 by phase on the lower and upper fence [(kg m^2/s)^2] */
    const ng_real *torque;   /* by phase, level, joint [N m] */
    const ng_real *inertia;  /* by phase, level, joint, output [kg m^2] */
} ng_schedule;

#define NG_SERIES 32 /* most terms of a series in one direction */

/*
 * How torques follow from what the policy wants:
 *   -stiffness (q_a - y_d) - damping (dq_a - dy_d)
 * and, with a model, its torques of ddq_a = ddy_d - w^2 (q_a - y_d) - 2 w (dq_a - dy_d),
 * or, with a schedule, u0 - M (w^2 (q_a - y_d) + 2 w (dq_a - dy_d)).
 */
typedef struct ng_law {
    const char *name;
    ng_real stiffness[NG_ACTUATED]; /* stance leg first [N m/rad] */
    ng_real damping[NG_ACTUATED];   /* likewise [N m s/rad] */
    int model;          /* 0: no torques of the model, and no accelerations */
    ng_real bandwidth;  /* w: 0 leaves errors to stiffness and damping [rad/s] */
    int hold_ticks;     /* ticks between two questions to the policy */
    int measure_z2;     /* 0: the policy is told z2 = 0 */
    int uses_impact_consistent_rates; /* 1: at a touchdown rates are those of z2, not measured */
    ng_apply_limits *apply_limits;    /* in place of clipping, or 0 */
    const void *own;    /* what that knows */
    const ng_schedule *schedule;      /* in place of a model, or 0 */
} ng_law;

extern const ng_law ng_laws[NG_LAW_COUNT]; /* see NG_LAW_... in gait.h */

/* Why torques are zero. The first fault stays until ng_start. */
typedef enum {
    NG_NO_FAULT,
    NG_FAULT_NOT_FINITE,   /* a reading is NaN or infinite */
    NG_FAULT_PITCH,        /* torso tipped over, or not a possible pitch */
    NG_FAULT_ANGLE,        /* a joint angle far outside its range */
    NG_FAULT_RATE,         /* a joint or pitch rate no robot has */
    NG_FAULT_SPEED,        /* a hip speed no robot has */
    NG_FAULT_FORCE,        /* a ground force no foot feels */
    NG_FAULT_TIME,         /* readings too far apart, or not in order */
    NG_FAULT_LOST_CONTACT, /* both feet off the ground for too long */
    NG_FAULT_TORQUE        /* the law gave a torque that is not finite */
} ng_fault;

/*
 * What the sensors of the robot file's own joints say, in that file's signs and zeros. Leg 0 is the
 * first leg of the file; of a leg, joint 0 is the lowest one and the hip the last.
 */
typedef struct {
    uint32_t time_us;                       /* of the reading; may wrap around [us] */
    ng_real pitch;                          /* root hinge [rad] */
    ng_real dpitch;                         /* its rate [rad/s] */
    ng_real base_velocity[2];               /* of the root's pitch axis, (x, z) [m/s] */
    ng_real joints[NG_LEGS][NG_LEG_JOINTS]; /* [rad] */
    ng_real djoints[NG_LEGS][NG_LEG_JOINTS];/* [rad/s] */
    ng_real normal_force[NG_LEGS];          /* of the ground on each foot [N] */
} ng_encoders;

/* The same in the signs and zeros of the theory. */
typedef struct {
    uint32_t time_us;                       /* [us] */
    ng_real pitch;                          /* up-angle of the root link [rad] */
    ng_real dpitch;                         /* [rad/s] */
    ng_real angles[NG_LEGS][NG_LEG_JOINTS]; /* lowest joint first, hip last [rad] */
    ng_real rates[NG_LEGS][NG_LEG_JOINTS];  /* [rad/s] */
    ng_real hip_velocity[2];                /* in the world, (x, z) [m/s] */
    ng_real normal_force[NG_LEGS];          /* [N] */
} ng_measurement;

/* What the policy wants, held between two questions to it; actuated joints, stance leg first. */
struct ng_desired {
    ng_real y[NG_ACTUATED];     /* desired angles [rad] */
    ng_real dy[NG_ACTUATED];    /* their rates [rad/s] */
    ng_real slope[NG_ACTUATED]; /* d y / d z1; of laws with a model [rad/m] */
    ng_real drift[NG_ACTUATED]; /* desired accelerations at ddz1 = 0; likewise [rad/s^2] */
};

/* What may differ from one use of the same gait to the next. */
struct ng_config {
    const ng_law *law;
    ng_real torque_limit[NG_ACTUATED]; /* stance leg first [N m] */
    ng_real torque_rate;               /* largest change of a joint's torque [N m/s] */
    ng_real blend_s;                   /* time from holding the first posture to the gait [s] */
    ng_real hold_stiffness;            /* while blending [N m/rad] */
    ng_real hold_damping;              /* while blending [N m s/rad] */
    ng_real largest_pitch;             /* [rad] */
    ng_real angle_margin;              /* beyond the ranges of the joints [rad] */
    ng_real largest_rate;              /* [rad/s] */
    ng_real largest_speed;             /* [m/s] */
    ng_real largest_force;             /* [N] */
    ng_real contact_force;             /* a foot that feels less is off the ground [N] */
    ng_real airborne_s;                /* both feet off the ground [s] */
    uint32_t gap_us;                   /* between two readings [us] */
};

/* What is remembered from tick to tick. */
typedef struct {
    int leg;                                /* stance leg, 0 or 1 */
    ng_real since_touchdown;                /* NG_NEVER before the first [s] */
    int ticks_to_policy;                    /* until the policy is asked again */
    ng_desired held;                        /* its last answer */
    int running;                            /* 0 before the first reading */
    uint32_t last_us;                       /* time of the last reading [us] */
    ng_real elapsed;                        /* since the first reading, up to blend_s [s] */
    ng_real posture[NG_LEGS][NG_LEG_JOINTS];/* found at the first reading [rad] */
    ng_real torque[NG_LEGS][NG_LEG_JOINTS]; /* of the last tick [N m] */
    ng_real airborne;                       /* time since a foot felt the ground [s] */
    ng_real ankle;                          /* torque of a stance ankle at the last tick [N m] */
    ng_real shift[NG_ACTUATED];             /* added to what the policy wants [rad]; a host's */
    ng_real shift_rate[NG_ACTUATED];        /* its rate [rad/s] */
    ng_fault fault;
#if NG_COMMANDS
    ng_real requested[NG_COMMANDS];         /* for the steps to come, see ng_tell */
    ng_real before[NG_COMMANDS];            /* what the step before was told */
    ng_real after[NG_COMMANDS];             /* what this step is told */
    ng_real step[NG_STEP];                  /* what follows from both; computed at touchdowns */
#endif
} ng_state;

/* What a tick decided, and what it saw. After a fault only torque, leg and fault are set. */
struct ng_command {
    ng_real torque[NG_LEGS][NG_LEG_JOINTS]; /* for the joints [N m] */
    ng_real actuated[NG_ACTUATED];          /* what the law wants, within limits [N m] */
    ng_real q[NG_COORDINATES];              /* [rad] */
    ng_real dq[NG_COORDINATES];             /* [rad/s] */
    ng_real y_d[NG_ACTUATED];               /* [rad] */
    ng_real dy_d[NG_ACTUATED];              /* [rad/s] */
    ng_real ankle;                          /* of a stance ankle, forward; 0 on point feet [N m] */
    ng_real lean;                           /* that the model of this step has; 0 without [m] */
    ng_real z[2];                           /* hip ahead of the foot [m], momentum [kg m^2/s] */
    int leg;
    ng_real since_touchdown;                /* [s] */
    int touchdown;                          /* whether the stance leg has just changed */
    int saturated;                          /* whether any torque of the law was clipped */
    int relaxed[2];                         /* what a law that has `apply_limits` gave up */
    ng_fault fault;
};

#define NG_NEVER NG(1.0e30)

/* The robot's limits; no startup blending. */
ng_config ng_config_of(const ng_law *law);

/*
 * Before the first tick, standing on `leg`. Clears a fault. A gait with commands begins in the
 * middle of their ranges.
 */
void ng_start(ng_state *state, int leg);

#if NG_COMMANDS
/* The same at other commands, clamped to their ranges. */
void ng_start_at(ng_state *state, int leg, const ng_real requested[NG_COMMANDS]);

/*
 * What the operator requests for the steps to come, units and order as in ng_command_low; at any
 * time. A command outside its range is clamped; one that is no number leaves the last request; a
 * change that the gait cannot follow in one step is spread over several. Returns how many commands
 * were not taken as they were given.
 */
int ng_tell(ng_state *state, const ng_real requested[NG_COMMANDS]);
#endif

/* One tick. */
void ng_step(const ng_config *config, ng_state *state, const ng_measurement *reading,
             ng_command *command);

/* Whether a reading can be trusted: its fault, which the state does not keep. */
ng_fault ng_check(const ng_config *config, const ng_state *state, const ng_measurement *reading);

/* From the robot file's joints to the signs and zeros of the theory. */
void ng_measure(const ng_encoders *encoders, ng_measurement *reading);

/* Coordinates of the robot standing on `leg`; of rates, their rates. */
void ng_coordinates(ng_real pitch, const ng_real (*by_leg)[NG_LEG_JOINTS], int leg,
                    ng_real q[NG_COORDINATES]);

/* The inverse of its actuated part, with the value of a stance ankle, by leg. */
void ng_by_legs(const ng_real actuated[NG_ACTUATED], ng_real ankle, int leg,
                ng_real by_leg[NG_LEGS][NG_LEG_JOINTS]);

/* Motor commands in the order of the joints: torque over gear. */
void ng_drive(const ng_command *command, ng_real motors[NG_LEGS][NG_LEG_JOINTS]);

/* What a drive with a loop of its own is told: tau_ff + kp (q_des - q) + kd (dq_des - dq). */
typedef struct {
    ng_real q_des;  /* [rad] */
    ng_real dq_des; /* [rad/s] */
    ng_real kp;     /* [N m/rad] */
    ng_real kd;     /* [N m s/rad] */
    ng_real tau_ff; /* [N m] */
} ng_target;

/*
 * In place of ng_drive: what to tell such drives after a tick, in the order, signs and zeros of the
 * robot file's joints, torques of the joints. At the angles of the reading they then give exactly
 * the torques of the command. After a fault they only damp, with kd.
 */
void ng_impedance(const ng_measurement *reading, const ng_command *command, ng_real kp, ng_real kd,
                  ng_target targets[NG_LEGS][NG_LEG_JOINTS]);

/* The reason of a fault in words. */
const char *ng_fault_text(ng_fault fault);

/* Runs the table of gait_selftest.c. Returns 0, or the number of the first line that fails. */
int ng_selftest(void);

#endif
