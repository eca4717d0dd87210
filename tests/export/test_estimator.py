"""The estimator in C against Python: readings of a robot that changes its stance leg."""

import subprocess

import jax
import numpy as np
import pytest

from neuralgaits._quick_jit import quick_filter_jit
from neuralgaits.control.estimator import estimate, start
from neuralgaits.control.estimator_poles import Estimator
from neuralgaits.control.measurement import Measurement
from neuralgaits.control.touchdown import StanceState
from neuralgaits.export import build
from neuralgaits.export.source import gait_files
from support.compiled import folder_with

TICKS, STEP_TICKS = 240, 60
MAIN = """
#include <stdio.h>
#include "estimator.h"
int main(void)
{
    ng_estimator estimator;
    ng_state state = {0};
    double row[2 + 6 + 4 * NG_LEG_JOINTS];
    ng_estimator_start(&estimator);
    while (fread(row, sizeof row, 1, stdin) == 1) {
        ng_measurement reading = {0};
        const double *at = row + 8;
        state.leg = (int)row[0];
        state.since_touchdown = (ng_real)row[1];
        reading.pitch = (ng_real)row[2];
        reading.dpitch = (ng_real)row[3];
        reading.hip_velocity[0] = (ng_real)row[4];
        reading.hip_velocity[1] = (ng_real)row[5];
        for (int leg = 0; leg < NG_LEGS; ++leg) {
            for (int i = 0; i < NG_LEG_JOINTS; ++i) {
                reading.angles[leg][i] = (ng_real)*at++;
            }
        }
        for (int leg = 0; leg < NG_LEGS; ++leg) {
            for (int i = 0; i < NG_LEG_JOINTS; ++i) {
                reading.rates[leg][i] = (ng_real)*at++;
            }
        }
        ng_estimate(&estimator, &state, &reading);
        double out[4] = {(double)reading.pitch, (double)reading.dpitch,
                         (double)reading.hip_velocity[0], (double)reading.hip_velocity[1]};
        fwrite(out, sizeof out, 1, stdout);
        for (int leg = 0; leg < NG_LEGS; ++leg) {
            for (int i = 0; i < NG_LEG_JOINTS; ++i) {
                double pair[2] = {(double)reading.angles[leg][i], (double)reading.rates[leg][i]};
                fwrite(pair, sizeof pair, 1, stdout);
            }
        }
    }
    return 0;
}
"""


@pytest.fixture(scope="module")
def readings():
    """Joints that swing by 0.3 rad three times a second, encoders of 14 bits; leg and time."""
    time = 1e-3 * np.arange(TICKS)
    phases = np.arange(4).reshape(2, 2)
    swing = 6.0 * np.pi * time[:, None, None] + phases
    step = 2.0 * np.pi / 2**14
    angles = step * np.round(0.3 * np.sin(swing) / step)
    rates = 0.3 * 6.0 * np.pi * np.cos(swing)
    draws = np.random.default_rng(0).standard_normal(TICKS)
    pitch = 1.6 + 0.05 * np.sin(5.0 * time) + 1e-3 * draws
    zero = np.zeros((TICKS, 2))
    velocity = np.tile([0.7, 0.0], (TICKS, 1))
    seen = Measurement(time, pitch, 0.25 * np.cos(5.0 * time), angles, rates, velocity, zero)
    ticks = np.arange(TICKS)
    return seen, StanceState((ticks // STEP_TICKS) % 2, 1e-3 * (ticks % STEP_TICKS))


@pytest.fixture(scope="module")
def expected(design, readings):
    """What Python makes of them."""
    robot, period = design.controller.robot, design.controller.period_s

    @quick_filter_jit
    def run(readings):
        def tick(known, now):
            reading, standing = now
            after = estimate(Estimator(), robot, known, reading, standing, period)
            return after, after.estimate

        return jax.lax.scan(tick, start(robot), readings)[1]

    return jax.tree.map(np.asarray, run(readings))


@pytest.mark.parametrize(("precision", "apart"), [("double", 1e-12), ("float", 2e-4)])
def test_c_estimates_what_python_does(design, readings, expected, precision, apart, tmp_path):
    """Rates in single precision are off by what an angle's last bit is in a millisecond."""
    files = gait_files(design) | {"main.c": MAIN}
    folder, defines = folder_with(tmp_path, files), build.PRECISIONS[precision]
    program = build.build("gcc", folder, "main", (*build.CORE, "main.c"), ("-O1", *defines))
    seen, standing = readings
    head = [standing.leg, standing.since_touchdown, seen.pitch, seen.dpitch]
    parts = [*(np.reshape(part, (TICKS, 1)) for part in head), seen.hip_velocity, seen.normal_force]
    parts += [np.reshape(part, (TICKS, -1)) for part in (seen.angles, seen.rates)]
    rows = np.concatenate(parts, axis=1)
    done = subprocess.run([str(program)], input=rows.tobytes(), capture_output=True, check=True)
    found = np.frombuffer(done.stdout).reshape(TICKS, -1)
    pairs = np.stack([expected.angles, expected.rates], axis=-1).reshape(TICKS, -1)
    ours = [expected.pitch[:, None], expected.dpitch[:, None], expected.hip_velocity, pairs]
    difference = np.abs(found - np.concatenate(ours, axis=1))
    assert 0.0 < np.max(difference) <= apart * max(1.0, np.max(np.abs(pairs)))
