/*
 * From switched on to walking and back: damp, stand, walk, stop, each with its posture, its time-out
 * and its way out. It calls the controller of controller.h and like it keeps no memory of its own.
 *
 *   damp --> stand --> walk --> stop --> stand
 *
 * From each of them a fault, a time-out or the operator leads to damp. Call ng_supervisor_start
 * once, then ng_supervise once every NG_PERIOD in place of ng_step.
 */
#ifndef NG_SUPERVISOR_H
#define NG_SUPERVISOR_H

#include "controller.h"

/* What the robot does. */
typedef enum {
    NG_DAMP,  /* joints only damp: it may be carried, or sinks to the floor */
    NG_STAND, /* moves to a posture on two feet and holds it */
    NG_WALK,  /* leans forward until it tips over the front foot, then walks */
    NG_STOP   /* ends its step far ahead, then holds a posture on two feet */
} ng_mode;

/* What the operator wants. */
typedef enum { NG_REQUEST_DAMP, NG_REQUEST_STAND, NG_REQUEST_WALK } ng_request;

/* Why the mode has changed. */
typedef enum {
    NG_NO_CHANGE,
    NG_AS_REQUESTED,
    NG_FROM_MID_STEP,  /* to walk: the robot was on the gait already */
    NG_TIPS_FORWARD,   /* to walk or stop: the robot tips over its front foot */
    NG_SETTLED,        /* to stand: the walk has ended on two feet */
    NG_TOO_LATE,       /* not there in time: to damp, or from a walk that does not begin to stand */
    NG_TIPPED_OVER,    /* to damp: the centre of mass has left the feet */
    NG_BY_FAULT,       /* to damp, until ng_supervisor_start */
    NG_FEET_HELD       /* to damp: friction or a motor's limit keeps the feet where they are */
} ng_reason;

/* What the operator's request waits for. */
typedef enum {
    NG_NOTHING,
    NG_FOR_DAMP,      /* the operator has to request damp first: something went wrong before */
    NG_FOR_LEGS,      /* its legs have no posture on two feet: see NG_HAS_STANDING */
    NG_FOR_STANDING,  /* no posture is held yet */
    NG_FOR_TWO_FEET,  /* a foot does not feel the floor */
    NG_FOR_POSTURE,   /* a joint is too far from the posture */
    NG_FOR_REST       /* a joint or the robot moves */
} ng_waiting;

/* What may differ from one robot to the next. */
typedef struct {
    ng_config walk;           /* of the gait and of faults */
    ng_real kp[NG_LEG_JOINTS];/* of joints that hold a posture, and of drives [N m/rad] */
    ng_real kd[NG_LEG_JOINTS];/* likewise; alone while damping [N m s/rad] */
    ng_real joint_rate;       /* fastest joint on the way to a posture [rad/s] */
    ng_real near_posture;     /* a joint there is no further from it [rad] */
    ng_real at_rest;          /* a joint, or a robot, at rest turns no faster [rad/s] */
    ng_real rest_s;           /* time in which that shows in the pitch [s] */
    ng_real stand_timeout_s;  /* to hold the posture [s] */
    ng_real feet_held;        /* feet that come together by less in a try are held [m] */
    ng_real lean_s;           /* from standing to where the first step begins [s] */
    ng_real lean_timeout_s;   /* to tip over the front foot [s] */
    ng_real first_momentum;   /* about the front foot, beyond what just tips over it, with which
                                 the first step begins [kg m^2/s] */
    ng_real fade_s;           /* from the first posture to the gait's outputs [s] */
    ng_real near_gait;        /* outputs of a robot on the gait are no further off [rad] */
    ng_real step_timeout_s;   /* to a touchdown [s] */
    ng_real brake_from;       /* phase of a step from which its foot goes further ahead */
    ng_real brake_to;         /* phase at which it is there */
    int brakes;               /* most steps that do so */
    ng_real over_foot;        /* a centre of mass this far outside of the feet has tipped over [m] */
    ng_real settle_s;         /* shortest time of a move to a posture [s] */
    ng_real balance;          /* how far the centre of mass goes against its own motion after a
                                 walk: share of where it is going to */
    ng_real balance_rate;     /* its fastest change, in ways from one end to the other [1/s] */
    ng_real balance_s;        /* how long it does so, and how long that takes to fade [s] */
    ng_real stop_timeout_s;   /* to stand [s] */
} ng_supervisor_config;

/* What is remembered from tick to tick. */
typedef struct {
    ng_state state;                  /* of the controller, and for ng_estimate */
    ng_mode mode;
    int part;                        /* of the mode: see supervisor.c */
    ng_real elapsed;                 /* in this part [s] */
    ng_real in_mode;                 /* in this mode [s] */
    ng_real in_step;                 /* since a touchdown, or since the walk began [s] */
    ng_real from[NG_COORDINATES];    /* posture at its beginning, front leg in stance [rad] */
    ng_real move_s;                  /* from there to the posture of the mode [s] */
    ng_real place;                   /* between both ends of ng_wide_path */
    ng_real lead[NG_ACTUATED];       /* outputs ahead of the gait's, which fade [rad] */
    ng_real lead_rate[NG_ACTUATED];  /* at the beginning [rad/s] */
    ng_real pitch;                   /* followed slowly [rad] */
    ng_real still_s;                 /* for which the robot has not left it [s] */
    int steps_to_brake;              /* touchdowns before the step that brakes */
    int braked;                      /* steps that did */
    int knot;                        /* of ng_stand_path, to which the robot moves */
    ng_real apart;                   /* feet after the last try to stand; 0 before the first [m] */
    int refused;                     /* until the operator requests damp */
    ng_real given[NG_LEGS][NG_LEG_JOINTS];     /* torques of the last tick [N m] */
    ng_target targets[NG_LEGS][NG_LEG_JOINTS]; /* likewise */
} ng_supervisor;

/* What a tick has decided. */
typedef struct {
    ng_mode mode;
    ng_mode before;                  /* mode of the tick before */
    ng_reason reason;                /* NG_NO_CHANGE unless the mode has changed */
    ng_waiting waiting;              /* what the request waits for */
    ng_fault fault;                  /* stays until ng_supervisor_start */
    int fault_is_new;                /* 1 once */
    ng_command command;              /* torques in the theory's order, for ng_drive */
} ng_supervision;

/* Defaults that fit the gait. */
ng_supervisor_config ng_supervisor_config_of(const ng_law *law);

/* Before the first tick, damping. Clears a fault. */
void ng_supervisor_start(ng_supervisor *supervisor);

/*
 * One tick: torques in `decided->command`, for ng_drive, and targets of drives with a loop of their
 * own in `supervisor->targets`, in the robot file's order and signs. At the angles of the reading
 * these give the same torques.
 */
void ng_supervise(const ng_supervisor_config *config, ng_supervisor *supervisor,
                  const ng_measurement *reading, ng_request request, ng_supervision *decided);

const char *ng_mode_text(ng_mode mode);
const char *ng_reason_text(ng_reason reason);
const char *ng_waiting_text(ng_waiting waiting);

#endif
