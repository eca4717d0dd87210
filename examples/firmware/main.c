/*
 * A bare main loop around an exported controller: self-test, then a tick every NG_PERIOD.
 * No operating system, no heap; all memory stands below.
 */
#include "board.h"
#include "estimator.h"

#ifndef ESTIMATE
#define ESTIMATE 1 /* 0 for a board that measures rates and the velocity of the base */
#endif
#define BLEND_S NG(1.0) /* from holding the posture found to the gait [s] */
#define FIRST_SELFTEST_LINE 100

/* Standing on the board's leg, at the operator's commands if the gait takes some. */
static void start(ng_config *config, ng_state *state)
{
    *config = ng_config_of(&ng_laws[NG_LAW_PD]);
    config->blend_s = BLEND_S;
    const int leg = board_configure(config);
#if NG_COMMANDS
    ng_real requested[NG_COMMANDS];
    board_requested(requested);
    ng_start_at(state, leg, requested);
#else
    ng_start(state, leg);
#endif
}

static void walk(void)
{
    ng_config config;
    ng_state state;
    ng_estimator estimator;
    ng_encoders encoders;
    ng_measurement reading;
    ng_command command;
    ng_real motors[NG_LEGS][NG_LEG_JOINTS];
    start(&config, &state);
    ng_estimator_start(&estimator);
    while (board_enabled()) {
        if (!board_wait_for_tick()) {
            /* A late tick is one long gap between readings: the controller judges it. */
            board_report(NG_FAULT_TIME);
        }
        board_read(&encoders);
#if NG_COMMANDS
        ng_real requested[NG_COMMANDS];
        board_requested(requested);
        ng_tell(&state, requested);
#endif
        ng_measure(&encoders, &reading);
#if ESTIMATE
        ng_estimate(&estimator, &state, &reading);
#endif
        ng_step(&config, &state, &reading, &command);
        ng_drive(&command, motors);
        board_drive(motors);
        board_log(&state, &command);
        if (command.fault != NG_NO_FAULT) {
            board_report((int)command.fault);
        }
    }
}

int main(void)
{
    const int failed = ng_selftest();
    if (failed != 0) {
        board_report(FIRST_SELFTEST_LINE + failed);
        return 1;
    }
    for (;;) {
        if (board_enabled()) {
            board_report(NG_NO_FAULT);
            walk();
        }
    }
}
