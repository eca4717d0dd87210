"""The supervisor in exported C, at random readings and requests: limits, ways, faults, targets."""

import subprocess
from pathlib import Path

import numpy as np
import pytest

from neuralgaits.export import build
from neuralgaits.export.source import gait_files
from neuralgaits.robots import load_robot
from neuralgaits.robots.dynamics import centre_of_mass as centre_of_mass_in_jax
from neuralgaits.robots.dynamics import hip_position, swing_foot
from neuralgaits.robots.standing import centre_of_mass, standing_postures
from support.compiled import folder_with
from support.designs import LAWS, commanded_design, design_for

MAIN = Path(__file__).with_name("supervisor_main.c")
READINGS = MAIN.with_name("supervisor_readings.h")
DESIGNS = {
    "amber3m": lambda: design_for("amber3m", {"pd": LAWS["pd"]}),
    "amber3m-feet": lambda: design_for("amber3m-feet", {"pd": LAWS["pd"]}),
    "commanded": lambda: commanded_design("amber3m", {"pd": LAWS["pd"]}),
}


@pytest.fixture(scope="module", params=DESIGNS)
def folder(request, tmp_path_factory):
    files = gait_files(DESIGNS[request.param]())
    files |= {file.name: file.read_text() for file in (MAIN, READINGS)}
    return folder_with(tmp_path_factory.mktemp("supervisor"), files)


@pytest.mark.parametrize("precision", build.PRECISIONS)
def test_limits_ways_and_targets_hold_at_random_readings(folder, precision):
    sources = (*build.CORE, "supervisor.c", MAIN.name)
    flags = ("-O1", "-Wno-double-promotion", *build.PRECISIONS[precision])
    program = build.build("gcc", folder, f"supervisor-{precision}", sources, flags)
    done = subprocess.run([str(program)], capture_output=True, check=True, text=True)
    *modes, faults, wrong, over, faster, apart, damping = map(float, done.stdout.split())
    assert min(modes) > 100 and faults >= 10
    assert wrong == 0
    near = 1e-9 if precision == "double" else 2e-3
    assert over <= 1.0 + 1e-6 and faster <= 1.0 + 1e-5
    assert max(apart, damping) < near


def test_it_calls_no_library_and_keeps_no_memory(folder):
    sources = (*build.CORE, "supervisor.c")
    found = build.inspect("gcc", folder, build.PLAIN, sources)
    assert found.foreign == () and found.static_bytes == 0


@pytest.mark.parametrize("name", ["amber3m", "amber3m-paper", "amber3m-feet", "rabbit"])
def test_postures_stand_on_two_feet(name):
    """Feet level and as far apart as they shall be, the centre of mass between them."""
    robot = load_robot(name)
    found = standing_postures(robot)
    assert found is not None
    length = robot.leg_length
    for postures, spacing in ((found.path, 0.4), (found.wide, 0.5)):
        for q in postures:
            np.testing.assert_allclose(swing_foot(robot, q), [-spacing * length, 0.0], atol=1e-8)
            np.testing.assert_allclose(
                centre_of_mass(robot, q), centre_of_mass_in_jax(robot, q), atol=1e-12
            )
            assert -spacing * length < centre_of_mass(robot, q)[0] <= 1e-8
            assert 0.8 < hip_position(robot, q)[1] / length < 0.95
            assert np.all((q[1:] >= robot.joint_lower) & (q[1:] <= robot.joint_upper))
    # The step that brakes ends with the same feet, seen from the other one.
    ahead = np.asarray(swing_foot(robot, found.braking))
    np.testing.assert_allclose(ahead, [0.5 * length, 0.0], atol=1e-8)
