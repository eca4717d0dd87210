"""A gait walks in MuJoCo on raw readings, in the motors' order; under a wrong file it does not."""

import ctypes
import subprocess
from dataclasses import replace

import mujoco
import numpy as np
import pytest

from neuralgaits.analysis.run import open_run
from neuralgaits.deployment.board_map import BoardMap, JointReadings
from neuralgaits.deployment.deployment_file import DeploymentFile
from neuralgaits.export import build
from neuralgaits.export.board_source import BOARD_SOURCES, board_files
from neuralgaits.export.source import gait_files
from neuralgaits.robots.mjcf_state import StateMap
from neuralgaits.simulation.setup.starts import full_states
from neuralgaits.workflows.export import design_of
from support.compiled import folder_with
from support.deployments import drawn, plain
from support.shipped_run import SHIPPED

pytestmark = pytest.mark.slow
TICKS = 3000


@pytest.fixture(scope="module")
def run():
    return open_run(SHIPPED)


@pytest.fixture(scope="module")
def design(run):
    return design_of(run)


@pytest.fixture(scope="module")
def hardware(run):
    """Motors, signs, zeros and gears of their own; ranges and limits of the robot file."""
    usual = plain(run.robot)
    mixed = drawn(run.robot, 8)
    joints = tuple(
        replace(one, motor=other.motor, sign=other.sign, zero_rad=other.zero_rad, gear=other.gear)
        for one, other in zip(usual.joints, mixed.joints, strict=True)
    )
    return replace(mixed, joints=joints)


def _firmware(folder, here, design, file: DeploymentFile) -> ctypes.CDLL:
    """The controller with the map of a file, as a library."""
    source = (here / "board_walk.c").read_text()
    files = gait_files(design) | board_files(replace(design, deployment=file))
    place = folder_with(folder, files | {"board_walk.c": source})
    sources = [str(place / one) for one in (*build.CORE, *BOARD_SOURCES, "board_walk.c")]
    flags = [*build.STRICT, "-O1", "-shared", "-fPIC", "-I", str(place)]
    subprocess.run(["gcc", *flags, *sources, "-o", str(place / "firmware.so")], check=True)
    return ctypes.CDLL(str(place / "firmware.so"))


def _contacts(model, data, feet) -> np.ndarray:
    """Normal forces on the feet."""
    force, found = np.zeros(6), np.zeros(2)
    for k in range(data.ncon):
        for foot, geom in enumerate(feet):
            if geom in data.contact[k].geom:
                mujoco.mj_contactForce(model, data, k, force)
                found[foot] += force[0]
    return found


def _walk(run, hardware: DeploymentFile, firmware: ctypes.CDLL) -> tuple[int, int, float]:
    """Walk on hardware of this kind. Returns: touchdowns, ticks without a fault, forward way."""
    layout = run.robot.layout
    model = mujoco.MjModel.from_xml_string(layout.xml)
    model.opt.timestep = 5e-4
    data, places = mujoco.MjData(model), StateMap.build(model, layout)
    board, feet = BoardMap.of(hardware, layout), [model.geom(name).id for name in layout.feet]
    x = full_states(run.zero_dynamics, run.gait, "centre", seed=0, episodes=1)[0]
    height = (0.0, float(run.robot.foot_radius))
    data.qpos[:], data.qvel[:] = places.to_mjcf(x[: run.robot.n], x[run.robot.n :], 0, height)
    mujoco.mj_forward(model, data)
    start, still = data.qpos[places.root[0]], np.zeros((2, 2))
    readings = (ctypes.c_double * (board.motors + 1 + board.channels))()
    answer = (ctypes.c_double * (board.motors + 2))()
    firmware.begin(0)
    touchdowns = 0
    for tick in range(TICKS):
        q, pitch = data.qpos[places.joints], data.qpos[places.root[2]]
        seen = JointReadings(q, still, pitch, 0.0, _contacts(model, data, feet))
        raw = board.board_readings(seen)
        readings[:] = [*raw.position, raw.pitch, *raw.contact]
        firmware.tick(ctypes.c_uint32(1000 * (tick + 1)), readings, answer)
        *motors, touchdown, fault = answer
        if fault:
            break
        touchdowns += int(touchdown)
        # The drives turn the joints as the hardware is built.
        torque = board.sign * board.gear * np.array(motors)[board.motor]
        gears = np.array(layout.leg_joint_signs) * np.array(layout.gears)
        data.ctrl[places.actuators] = torque / gears
        mujoco.mj_step(model, data, 2)
    return touchdowns, tick + 1, float(data.qpos[places.root[0]] - start)


def test_the_gait_walks_on_raw_readings(run, design, hardware, tmp_path, request):
    here = request.path.parent
    right = _firmware(tmp_path / "right", here, design, hardware)
    touchdowns, ticks, way = _walk(run, hardware, right)
    assert ticks == TICKS and touchdowns >= 4 and way > 1.0
    joints = list(hardware.joints)
    joints[1] = replace(joints[1], sign=-joints[1].sign)
    wrong = _firmware(tmp_path / "wrong", here, design, replace(hardware, joints=tuple(joints)))
    stumbled, _, reached = _walk(run, hardware, wrong)
    assert stumbled < touchdowns and reached < 0.5 * way
