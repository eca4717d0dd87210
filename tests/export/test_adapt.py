"""The adapted speed in C against Python: readings, touchdowns and commands at random."""

import subprocess
from typing import Any

import numpy as np
import pytest

from neuralgaits._quick_jit import quick_filter_jit
from neuralgaits.control import speed_adapter
from neuralgaits.control.measurement import Measurement, coordinates
from neuralgaits.control.speed_adapter import StepOdometer, hips_over_feet
from neuralgaits.export import build, output_folder
from neuralgaits.export.source import gait_files
from neuralgaits.workflows import export_formats
from neuralgaits.workflows.export_formats import controller_files
from support.compiled import folder_with
from support.designs import FOOTHOLDS, LAWS, SPEED, commanded_design, design_for

ROWS = 400
MAIN = """
#include <stdio.h>
#include "adapt.h"
int main(void)
{
    const ng_real first[NG_COMMANDS] = {NG(0.34), NG(0.7)};
    double row[6 + 2 * NG_LEG_JOINTS];
    ng_adapt adapt;
    ng_state state;
    ng_command command = {0};
    ng_start_at(&state, 0, first);
    ng_adapt_start(&adapt, first);
    while (fread(row, sizeof row, 1, stdin) == 1) {
        const double *at = row + 6;
        const ng_real told[NG_COMMANDS] = {NG(0.34), (ng_real)row[0]};
        ng_measurement reading = {0};
        adapt.active = (int)row[5];
        reading.time_us = (uint32_t)row[1];
        reading.pitch = (ng_real)row[2];
        for (int leg = 0; leg < NG_LEGS; ++leg) {
            for (int i = 0; i < NG_LEG_JOINTS; ++i) {
                reading.angles[leg][i] = (ng_real)*at++;
            }
        }
        ng_adapt_tell(&adapt, &state, told);
        /* As ng_step latches. */
        command.touchdown = (int)row[3];
        command.leg = (int)row[4];
        if (command.touchdown) {
            for (int i = 0; i < NG_COMMANDS; ++i) {
                state.before[i] = state.after[i];
                state.after[i] = ng_clamp(state.requested[i], state.after[i] - ng_command_change[i],
                                          state.after[i] + ng_command_change[i]);
            }
        }
        ng_adapt_step(&adapt, &state, &reading, &command, told);
        double out[6] = {(double)state.requested[1], (double)state.after[1],
                         (double)adapt.reference, (double)adapt.integral, (double)adapt.error,
                         adapt.measured ? (double)adapt.walked : -1.0};
        fwrite(out, sizeof out, 1, stdout);
    }
    return 0;
}
"""


@pytest.fixture(scope="module")
def told():
    """A gait that takes a step length before its speed."""
    return commanded_design("amber3m", {"pd": LAWS["pd"]}, (FOOTHOLDS[0], SPEED))


@pytest.fixture(scope="module")
def readings():
    """Rows of told speed, time [us], pitch, touchdown, leg, whether active, and angles by leg."""
    rng = np.random.default_rng(0)
    speeds = rng.uniform(0.5, 0.95, ROWS)
    speeds[rng.uniform(size=ROWS) < 0.05] = np.nan
    # The clock of a robot wraps around; two touchdowns at one time measure nothing.
    passed = rng.integers(200_000, 500_000, ROWS) * (rng.uniform(size=ROWS) > 0.05)
    time = (2**32 - 3_000_000 + np.cumsum(passed)) % 2**32
    down = rng.uniform(size=ROWS) < 0.6
    leg = np.cumsum(down) % 2
    active = rng.uniform(size=ROWS) < 0.9
    # The leg that has come down is in front, the other one behind.
    pitch, angles = 0.05 * rng.standard_normal(ROWS), rng.uniform(-0.1, 0.1, (ROWS, 2, 2))
    rows = np.arange(ROWS)
    angles[rows, leg, 1] -= 0.2
    angles[rows, 1 - leg, 1] += 0.2
    angles = angles.reshape(ROWS, 4)
    return np.column_stack([speeds, time, pitch, down, leg, active, angles])


def expected_of(design, rows):
    """What Python makes of them."""
    robot, adapter = design.controller.robot, speed_adapter.adapter_for(design.commands)
    assert adapter is not None
    standing = quick_filter_jit(lambda one, leg: coordinates(robot, one, leg)[0])
    state, odometer = speed_adapter.start(adapter, 0.7), StepOdometer()
    requested = before = after = 0.7
    last_us, passed_us, walked, found = rows[0, 1], 0.0, None, []
    for speed, now_us, pitch, down, leg, active, *angles in rows:
        wish = speed_adapter.command_for(adapter, state, speed) if active else speed
        requested = requested if np.isnan(wish) else min(max(wish, adapter.low), adapter.high)
        passed_us, last_us = passed_us + (now_us - last_us) % 2**32, now_us
        if down:
            low, high = after - adapter.change, after + adapter.change
            before, after = after, min(max(requested, low), high)
            zero, by_leg = np.zeros(()), np.reshape(angles, (2, 2))
            seen = Measurement(
                zero, np.asarray(pitch), zero, by_leg, by_leg, np.zeros(2), np.zeros(2)
            )
            hips = hips_over_feet(robot, np.asarray(standing(seen, np.asarray(leg, np.int32))))
            odometer, walked = odometer.touch_down(1e-6 * passed_us, *hips)
            state = speed_adapter.advance(adapter, state, speed, before, after, walked)
        found.append([requested, after, *state, -1.0 if walked is None else walked])
    return np.array(found)


@pytest.mark.parametrize(("precision", "apart"), [("double", 1e-12), ("float", 2e-4)])
def test_c_adapts_as_python_does(told, readings, precision, apart, tmp_path):
    folder = folder_with(tmp_path, gait_files(told) | output_folder.adaptation() | {"main.c": MAIN})
    sources, flags = (*build.CORE, "adapt.c", "main.c"), ("-O1", *build.PRECISIONS[precision])
    program = build.build("gcc", folder, "main", sources, flags)
    done = subprocess.run([program], input=readings.tobytes(), capture_output=True, check=True)
    found = np.frombuffer(done.stdout).reshape(ROWS, -1)
    expected = expected_of(told, readings)
    assert np.max(np.abs(found - expected)) <= apart * np.max(np.abs(expected))
    assert np.ptp(expected[:, 3]) > 0.1 and (expected[:, 5] == -1.0).any()


def test_the_files_are_inspected_as_those_of_a_robot(told, tmp_path):
    """No memory that outlives a call, and no library."""
    folder = folder_with(tmp_path, gait_files(told) | output_folder.adaptation())
    found = build.inspect("gcc", folder, build.PLAIN, (*build.CORE, "adapt.c"))
    assert found.static_bytes == 0 and found.foreign == ()


def test_only_gaits_with_a_commanded_speed_have_them(told, monkeypatch):
    for name, files in (("selftest_file", ""), ("gait_files", {})):
        monkeypatch.setattr(export_formats, name, lambda *_, files=files: files)
    nobodys: Any = None
    assert {"adapt.h", "adapt.c"} <= set(controller_files(told, nobodys))
    for other in (
        commanded_design("amber3m", {"pd": LAWS["pd"]}, FOOTHOLDS),
        design_for("amber3m", {"pd": LAWS["pd"]}),
    ):
        assert "adapt.c" not in controller_files(other, nobodys)
