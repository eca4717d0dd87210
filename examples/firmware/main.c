/*
 * A bare main loop around an exported controller: self-test, then a tick every NG_PERIOD. The
 * supervisor stands the robot up, walks, stops, and damps it after a fault.
 * No operating system, no heap; all memory stands below.
 */
#include "board.h"
#include "estimator.h"

#ifndef ESTIMATE
#define ESTIMATE 1 /* 0 for a board that measures rates and the velocity of the base */
#endif
#ifndef DRIVES
#define DRIVES 0 /* 1 for drives that close a loop of their own */
#endif
#ifndef ADAPT
#define ADAPT 0 /* 1 to adapt the commanded speed, for a gait that takes one */
#endif
#if ADAPT
#include "adapt.h"
#endif

static void send(ng_supervisor *supervisor, const ng_supervision *decided)
{
#if DRIVES
    board_aim(supervisor->targets);
#else
    ng_real motors[NG_LEGS][NG_LEG_JOINTS];
    ng_drive(&decided->command, motors);
    board_drive(motors);
#endif
    board_log(supervisor, decided);
    if (decided->reason != NG_NO_CHANGE || decided->fault_is_new) {
        board_changed(decided);
    }
}

static void run(void)
{
    ng_supervisor_config config = ng_supervisor_config_of(&ng_laws[NG_LAW_DEFAULT]);
    ng_supervisor supervisor;
    ng_supervision decided;
    ng_estimator estimator;
    ng_encoders encoders;
    ng_measurement reading;
    board_configure(&config);
    ng_supervisor_start(&supervisor);
    ng_estimator_start(&estimator);
#if NG_COMMANDS
    ng_real requested[NG_COMMANDS];
    board_requested(requested);
    ng_start_at(&supervisor.state, 0, requested);
#endif
#if ADAPT
    ng_adapt adapt;
    ng_real first[NG_COMMANDS];
    ng_adapt_first(requested, first);
    ng_start_at(&supervisor.state, 0, first);
    ng_adapt_start(&adapt, first);
#endif
    while (board_enabled()) {
        /* A late tick is one long gap between readings: the controller judges it. All ticks run
         * here: an interrupt sets a flag that ends this wait, and calls nothing of the gait. */
        (void)board_wait_for_tick();
        board_read(&encoders);
#if NG_COMMANDS
        board_requested(requested);
#if ADAPT
        ng_adapt_tell(&adapt, &supervisor.state, requested);
#else
        ng_tell(&supervisor.state, requested);
#endif
#endif
        ng_measure(&encoders, &reading);
#if ESTIMATE
        ng_estimate(&estimator, &supervisor.state, &reading);
#endif
        ng_supervise(&config, &supervisor, &reading, board_request(), &decided);
#if ADAPT
        ng_adapt_step(&adapt, &supervisor.state, &reading, &decided.command, requested);
        if (decided.mode == NG_DAMP || decided.mode == NG_STAND) {
            adapt.begun = 0; /* the next touchdown ends no step */
        }
#endif
        send(&supervisor, &decided);
    }
}

int main(void)
{
    const int failed = ng_selftest();
    if (failed != 0) {
        board_failed(failed);
        return 1;
    }
    for (;;) {
        if (board_enabled()) {
            run();
        }
    }
}
