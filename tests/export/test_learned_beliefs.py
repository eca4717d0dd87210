"""What is believed of lean and slope in C against Python: estimates and commands at random."""

import subprocess

import numpy as np

from neuralgaits.control import command_belief
from neuralgaits.control.command_belief import SETTLED, CommandEstimate
from neuralgaits.export import build, output_folder
from neuralgaits.export.source import gait_files
from neuralgaits.gait.commands import Command
from support.compiled import folder_with
from support.designs import LAWS, SPEED, commanded_design

ROWS = 300
LEAN, SLOPE = Command("lean", -0.02, 0.03, 0.0048), Command("slope", -0.07, 0.06, 0.02)
MAIN = """
#include <stdio.h>
#include "adapt.c"
int main(void)
{
    double row[6];
    while (fread(row, sizeof row, 1, stdin) == 1) {
        ng_adapt adapt = {0};
        ng_state state = {0};
        const ng_real first[NG_COMMANDS] = {NG(0.7), NG(0.0), NG(0.0)};
        ng_start_at(&state, 0, first);
        ng_adapt_start(&adapt, first);
        adapt.tilts = 1;
        adapt.believed = row[0];
        adapt.lean_steps = (int)row[2];
        if (can_be(1, row[1])) {
            take(&adapt.believed, &adapt.lean_steps, row[1], LEAN_JUMP, row[4] > 0.0);
        }
        take_slope(&adapt, row[3]);
        state.before[1] = row[4];
        state.after[1] = row[5];
        state.before[2] = state.after[2] = row[3];
        adapt.error = 0.05;
        ng_adapt_tell(&adapt, &state, first);
        int moving;
        /* The step of a fall shows nothing: its window is dropped. */
        const ng_measurement reading = {0};
        const ng_command fallen = {.fault = NG_FAULT_PITCH};
        adapt.since = 0.3;
        ng_adapt_step(&adapt, &state, &reading, &fallen, first);
        /* A step without a window shows nothing, and nothing that cannot be. */
        const ng_command ended = {.touchdown = 1};
        ng_real fast[NG_COMMANDS];
        const ng_real wish[NG_COMMANDS] = {row[1] < 0.0 ? NG(0.6) : NG(0.8), row[0], row[3]};
        ng_adapt_first(wish, fast);
        double out[12] = {adapt.believed, excess(&adapt, &state, lean_so_far(&adapt), &moving),
                               believes_anew(&adapt, &state), state.requested[0],
                               state.requested[1], state.requested[2], adapt.lean_steps,
                               adapt.since, 0.0, fast[0], fast[1], fast[2]};
        adapt.lean_doubted = 1;
        ng_adapt_step(&adapt, &state, &reading, &ended, first);
        out[8] = adapt.lean_doubted;
        fwrite(out, sizeof out, 1, stdout);
    }
    return 0;
}
"""


def expected_of(design, row):
    """What Python makes of it."""
    value, shown, steps, slope, before, after = row
    commands = (SPEED, LEAN, SLOPE)
    lean, ground = (command_belief.belief_for(commands, name) for name in ("lean", "slope"))
    assert lean is not None and ground is not None
    estimate = command_belief.learn(
        lean, CommandEstimate(value, int(steps)), shown, whole=before > 0.0
    )
    wanted = command_belief.believable(lean, estimate)
    next_lean = command_belief.next_belief(lean, estimate, after)
    missing = estimate.value - next_lean
    excess = command_belief.speed_by_lean(design.controller.robot) * missing
    tilted = command_belief.believable(ground, CommandEstimate(slope, 1))
    anew = abs(wanted - before) > SETTLED["lean"] or abs(tilted - slope) > SETTLED["slope"]
    gain = 0.3 if next_lean == wanted else 0.6
    told = np.array([0.6 if shown < 0.0 else 0.8, value, slope])
    fast = command_belief.first_commands(commands, told, ("speed", "lean"))
    speed = min(max(0.7 + gain * 0.05 - excess, SPEED.low), SPEED.high)
    learned = [estimate.value, excess, float(anew), speed, wanted, tilted, estimate.steps]
    return [*learned, -1.0, 0.0, *fast]


def test_c_believes_as_python_does(tmp_path):
    design = commanded_design("amber3m", {"pd": LAWS["pd"]}, (SPEED, LEAN, SLOPE))
    rng = np.random.default_rng(0)
    leans = rng.uniform(-0.03, 0.04, (2, ROWS))
    leans[1, ::2] = leans[0, ::2] + rng.uniform(-0.005, 0.005, ROWS // 2)
    # Some that cannot be.
    leans[1, ::5] = rng.choice([np.nan, np.inf, 0.081, -0.071, 0.079, -0.069], ROWS)[::5]
    near = np.clip(leans[0] + rng.normal(0.0, 0.02, (2, ROWS)), LEAN.low, LEAN.high)
    rows = np.column_stack(
        [*leans, rng.integers(0, 9, ROWS), rng.uniform(-0.08, 0.07, ROWS), *near]
    )
    files = gait_files(design) | output_folder.adaptation() | {"main.c": MAIN}
    folder = folder_with(tmp_path, files)
    flags = ("-O1", *build.PRECISIONS["double"])
    program = build.build("gcc", folder, "main", (*build.CORE, "main.c"), flags)
    done = subprocess.run([program], input=rows.tobytes(), capture_output=True, check=True)
    found = np.frombuffer(done.stdout).reshape(ROWS, -1)
    expected = np.array([expected_of(design, row) for row in rows])
    np.testing.assert_allclose(found, expected, rtol=1e-12, atol=1e-14)
    assert len(np.unique(expected[:, 9])) == 2
    # Both answers occur, and speeds inside of their range and at its ends.
    assert 0.1 < np.mean(expected[:, 2]) < 0.9 or np.ptp(expected[:, 2]) == 1.0
    assert np.ptp(expected[:, 3]) > 0.1 and np.any(np.abs(expected[:, 3] - 0.7) < 0.1)


SLOPES = """
#include <stdio.h>
#include "adapt.c"
int main(void)
{
    const ng_real first[NG_COMMANDS] = {NG(0.7), NG(0.0), NG(0.0)};
    double row[2];
    ng_adapt adapt;
    ng_adapt_start(&adapt, first);
    adapt.tilts = 1;
    while (fread(row, sizeof row, 1, stdin) == 1) {
        ng_state state = {0};
        if (can_be(2, row[0])) {
            take_slope(&adapt, row[0]);
        }
        state.before[2] = row[1];
        double out[4] = {adapt.slope, adapt.slope_steps, adapt.slope_pause,
                         believes_anew(&adapt, &state)};
        fwrite(out, sizeof out, 1, stdout);
    }
    return 0;
}
"""


def test_c_learns_slopes_that_change_as_python_does(tmp_path):
    """Slopes that stay for some steps, single ones that are wrong, and some that cannot be."""
    design = commanded_design("amber3m", {"pd": LAWS["pd"]}, (SPEED, LEAN, SLOPE))
    rng, rows = np.random.default_rng(1), 20 * ROWS
    slopes = np.repeat(rng.uniform(-0.06, 0.05, rows // 10), 10)
    shown = slopes + rng.normal(0.0, 2e-3, rows)
    wrong = rng.uniform(size=rows) < 0.1
    shown[wrong] = rng.uniform(-0.08, 0.08, rows)[wrong]
    shown[rng.uniform(size=rows) < 0.05] = np.nan
    # Beliefs of the steps that ended.
    before = slopes + rng.normal(0.0, 6e-3, rows)
    belief = command_belief.belief_for((SLOPE,), "slope")
    assert belief is not None
    estimate, expected = CommandEstimate(0.0), []
    for one, latched in zip(shown, before, strict=True):
        estimate = command_belief.learn(belief, estimate, one)
        lacking = abs(command_belief.believable(belief, estimate) - latched)
        anew = estimate.pause > 0 or lacking > SETTLED["slope"]
        expected.append([estimate.value, estimate.steps, estimate.pause, anew])
    expected = np.array(expected)
    files = gait_files(design) | output_folder.adaptation() | {"main.c": SLOPES}
    folder = folder_with(tmp_path, files)
    flags = ("-O1", *build.PRECISIONS["double"])
    program = build.build("gcc", folder, "main", (*build.CORE, "main.c"), flags)
    sent = np.column_stack([shown, before])
    done = subprocess.run([program], input=sent.tobytes(), capture_output=True, check=True)
    found = np.frombuffer(done.stdout).reshape(rows, -1)
    np.testing.assert_allclose(found, expected, rtol=1e-12, atol=1e-14)
    # Means begin anew, and errors wait for the pause alone, too.
    assert np.sum(np.diff(expected[:, 1]) < 0) > 5
    assert set(expected[:, 2]) == set(range(6)) and 0.1 < np.mean(expected[:, 3]) < 0.9
