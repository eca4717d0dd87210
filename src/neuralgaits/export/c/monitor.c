/* See monitor.h. The margins are functions of monitor_set.c, written from Programs. */
#include "monitor.h"

#include <stddef.h>

/* The smallest margin of a set; margins of a step's ends count where they are negative. */
static ng_membership smallest(int set, const ng_real margins[NG_MONITOR_MARGINS])
{
    const int ends = ng_monitor_ends[set], count = ends + ng_monitor_walls[set];
    ng_membership found = {0, 0, NG(0.0), "", 0u, 0u};
    int first = 1;
    for (int i = 0; i < count; ++i) {
        const ng_real margin = margins[i] > -NG_NEVER ? margins[i] : -NG_NEVER;
        if ((i >= ends || margin < NG(0.0)) && (first || margin < found.margin)) {
            found.margin = margin;
            found.name = ng_monitor_names[set][i];
            first = 0;
        }
    }
    found.inside = found.margin >= NG(0.0);
    return found;
}

/* The same answer for each level of a set; margins are computed once for neighbours. */
static void memberships(const ng_state *state, const ng_command *command, int from, int to,
                        ng_membership *found)
{
    ng_real margins[NG_MONITOR_MARGINS];
    for (int k = from; k < to; ++k) {
        const int set = ng_monitor_set_of[k];
        if (command->fault != NG_NO_FAULT) {
            const ng_membership none = {0, 0, -NG_NEVER, "fault", 0u, 0u};
            found[k - from] = none;
        } else if (k > from && ng_monitor_set_of[k - 1] == set) {
            found[k - from] = found[k - 1 - from];
        } else {
            ng_monitor_margins(set, state, command, margins);
            found[k - from] = smallest(set, margins);
        }
        found[k - from].level = ng_monitor_level[k];
    }
}

ng_membership ng_monitor_membership(int k, const ng_state *state, const ng_command *command)
{
    ng_membership found;
    memberships(state, command, k, k + 1, &found);
    return found;
}

int ng_monitor_admissible(const ng_state *state)
{
    int inside = 1;
#if NG_COMMANDS
    for (int i = 0; i < NG_COMMANDS; ++i) {
        const ng_real last = state->before[i], now = state->after[i];
        const ng_real low = ng_monitor_low[i], high = ng_monitor_high[i];
        const ng_real change = ng_monitor_change[i];
        inside &= last >= low && last <= high && now >= low && now <= high;
        inside &= now >= last - change && now <= last + change;
    }
#else
    (void)state;
#endif
    return inside;
}

void ng_monitor_start(ng_monitor *monitor)
{
    const ng_monitor fresh = {0};
    *monitor = fresh;
}

void ng_monitor_step(ng_monitor *monitor, const ng_state *state, uint32_t time_us,
                     ng_command *command, ng_monitor_answer *answer)
{
    const uint32_t gap = monitor->running ? time_us - monitor->last_us : 0u;
    const uint32_t passed = gap < 0x80000000u ? gap : 0u; /* a clock that went back */
    memberships(state, command, 0, NG_MONITOR_LEVELS, answer->levels);
    for (int k = 0; k < NG_MONITOR_LEVELS; ++k) {
        ng_membership *one = &answer->levels[k];
        monitor->outside_us[k] += one->inside ? 0u : passed;
        monitor->stretch_us[k] = one->inside ? 0u : monitor->stretch_us[k] + passed;
        one->outside_us = monitor->outside_us[k];
        one->stretch_us = monitor->stretch_us[k];
    }
    answer->admissible = ng_monitor_admissible(state);
    answer->in_time = NG_MONITOR_HOLD_US == 0u ? -1 : gap <= NG_MONITOR_HOLD_US;
    answer->gap_us = gap;
    answer->proof_sha256 = NG_MONITOR_PROOF_SHA256;
    answer->robot_sha256 = NG_MONITOR_ROBOT_SHA256;
    monitor->running = 1;
    monitor->last_us = time_us;
    if (monitor->fallback != NULL) {
        monitor->fallback(answer, command, monitor->own);
    }
}
