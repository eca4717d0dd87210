/* Inputs and outputs of the Python controller, to be run on the target: see gait_selftest.h. */
#include "controller.h"

typedef struct {
    int law;                           /* place in ng_laws */
    int leg;                           /* stance leg before the tick */
    ng_encoders encoders;              /* of the first tick after ng_start */
    ng_fault fault;                    /* what is expected */
    ng_real y_d[NG_ACTUATED];          /* [rad] */
    ng_real dy_d[NG_ACTUATED];         /* [rad/s] */
    ng_real torque[NG_LEGS][NG_LEG_JOINTS]; /* [N m] */
#if NG_COMMANDS
    ng_real begun[NG_COMMANDS];        /* command that the tick begins with */
    ng_real told[NG_COMMANDS];         /* command told before it */
#endif
} ng_selftest_line;

#include "gait_selftest.h"

/* Share of the torque limit, and of 1 rad or 10 rad/s. */
#ifdef NG_FLOAT
#if NG_COMMANDS
#define TORQUE_SHARE NG(4.0e-4) /* the numbers of the step are rounded, too */
#else
#define TORQUE_SHARE NG(1.0e-4)
#endif
#define OUTPUT_SHARE NG(1.0e-5)
#else
#define TORQUE_SHARE NG(1.0e-9)
#define OUTPUT_SHARE NG(1.0e-11)
#endif

static int differs(ng_real found, ng_real expected, ng_real largest)
{
    return !(ng_abs(found - expected) <= largest);
}

static int fails(const ng_selftest_line *line)
{
    const ng_config config = ng_config_of(&ng_laws[line->law]);
    ng_state state;
    ng_measurement reading;
    ng_command command;
    int wrong = 0;
#if NG_COMMANDS
    ng_start_at(&state, line->leg, line->begun);
    ng_tell(&state, line->told);
#else
    ng_start(&state, line->leg);
#endif
    ng_measure(&line->encoders, &reading);
    ng_step(&config, &state, &reading, &command);
    wrong |= command.fault != line->fault;
    for (int i = 0; i < NG_ACTUATED; ++i) {
        wrong |= differs(command.y_d[i], line->y_d[i], OUTPUT_SHARE);
        wrong |= differs(command.dy_d[i], line->dy_d[i], NG(10.0) * OUTPUT_SHARE);
    }
    for (int leg = 0; leg < NG_LEGS; ++leg) {
        for (int i = 0; i < NG_LEG_JOINTS; ++i) {
            wrong |= differs(command.torque[leg][i], line->torque[leg][i],
                             TORQUE_SHARE * ng_torque_limit[0]);
        }
    }
    return wrong;
}

int ng_selftest(void)
{
    for (int i = 0; i < NG_SELFTEST_LINES; ++i) {
        if (fails(&ng_selftest_lines[i])) {
            return i + 1;
        }
    }
    return 0;
}
