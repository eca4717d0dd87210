"""FMUs with the supervisor: they stand, walk and stop in MuJoCo, tick for tick as the C does."""

from dataclasses import replace

import numpy as np
import pytest
from fmpy.fmi1 import FMICallException
from fmpy.validation import validate_fmu

from neuralgaits.errors import InputError
from neuralgaits.export.fmu.fmu_variables import variables_of
from neuralgaits.export.supervisor_codes import Mode, Reason, Request, Waiting
from neuralgaits.robots.standing import standing_postures
from neuralgaits.simulation.supervised.supervisor_library import SupervisorTick, supervisor_library
from neuralgaits.workflows import demo
from neuralgaits.workflows.export import export_controller
from support.designs import LAWS, commanded_design
from support.fmu_host import VERSIONS, FmuPlant, UnpackedFmu, made_fmu, walked
from support.monitored import made_up

TICKS = 4800
REQUESTS = [
    Request.DAMP if tick < 10 else Request.WALK if tick < 1900 else Request.STAND
    for tick in range(TICKS)
]


@pytest.fixture(scope="module")
def design():
    """The shipped run with a monitor of levels 2, 4 and 5, and the supervisor."""
    return replace(made_up()[2], supervised=True)


@pytest.fixture(scope="module")
def fmus(design, tmp_path_factory):
    """An FMU of either version."""
    folder = tmp_path_factory.mktemp("fmu")
    made = {}
    for version in VERSIONS:
        path = made_fmu(design, version, folder)
        assert validate_fmu(str(path)) == []
        made[version] = UnpackedFmu(path, folder / version)
    return made


@pytest.fixture(scope="module")
def walk(fmus, design):
    """Steps, inputs and outputs of a robot that stands, walks and stops."""
    postures = standing_postures(design.controller.robot)
    assert postures is not None
    q = postures.path[0]
    plant = FmuPlant(design, np.concatenate([q, np.zeros_like(q)]))
    with fmus["3.0"].instance() as one:
        return walked(one, plant, TICKS, rates=False, requests=REQUESTS)


def test_it_stands_walks_and_stops_in_mujoco(walk):
    steps, _, outputs = walk
    assert steps >= 2
    modes = [Mode(one["mode"]) for one in outputs]
    order = [mode for mode, before in zip(modes, [None, *modes], strict=False) if mode != before]
    assert order == [Mode.DAMP, Mode.STAND, Mode.WALK, Mode.STOP, Mode.STAND]
    assert {one["fault"] for one in outputs} == {0.0}
    # The reason of the last change stays; what a request waits for is of its tick.
    assert Reason(outputs[-1]["reason"]) == Reason.SETTLED
    assert Waiting(outputs[20]["waiting"]) == Waiting.FOR_STANDING
    assert Waiting(outputs[-1]["waiting"]) == Waiting.NOTHING


def test_the_monitor_is_about_walking_alone(walk):
    _, _, outputs = walk
    walking = [one for one in outputs if one["mode"] == Mode.WALK]
    others = [one for one in outputs if one["mode"] != Mode.WALK]
    assert any(one["monitor.level2.inside"] for one in walking)
    assert not any(one["monitor.level2.inside"] or one["monitor.admissible"] for one in others)
    assert {one["monitor.level2.name"] for one in others} == {-1.0}
    assert {one["monitor.level2.outside"] for one in others} == {0.0}


def test_its_ticks_are_those_of_the_c(walk, design):
    _, given, found = walk
    layout = design.controller.robot.layout
    joints = [name for leg in layout.leg_joints for name in leg]
    columns = ["pitch", "pitch_rate", "velocity.x", "velocity.z"]
    columns += [f"force.{foot}" for foot in layout.feet]
    columns += [f"angle.{name}" for name in joints] + [f"rate.{name}" for name in joints]
    controller = SupervisorTick(supervisor_library(design), (2, len(joints) // 2))
    controller.start(estimate=True)
    parts = ("q_des", "dq_des", "kp", "kd", "tau_ff")
    for tick, (row, out) in enumerate(zip(given, found, strict=True)):
        sensors = np.array([row.get(name, 0.0) for name in columns])
        controller.tick(1000 * tick, sensors, REQUESTS[tick])
        targets = [[out[f"target.{name}.{part}"] for part in parts] for name in joints]
        np.testing.assert_allclose(controller.targets.reshape(-1, 5), targets, rtol=0, atol=1e-9)
        torques = [out[f"torque.{name}"] for name in joints]
        np.testing.assert_allclose(controller.torques.reshape(-1), torques, rtol=0, atol=1e-9)
        mode, reason, waiting, fault, _, leg, touchdown = controller.decided[:7]
        now = (mode, waiting, fault, leg, touchdown)
        names = ("mode", "waiting", "fault", "stance_leg", "touchdown")
        assert now == tuple(out[name] for name in names)
        assert reason in (Reason.NO_CHANGE, out["reason"])


def test_both_versions_give_the_same(fmus, walk):
    _, given, found = walk
    with fmus["2.0"].instance() as one:
        for tick in range(100):
            one.set(given[tick])
            one.step(1e-3 * tick)
            assert one.outputs() == found[tick]


@pytest.mark.parametrize("version", VERSIONS)
def test_a_fault_damps_until_reset_and_other_requests_are_errors(fmus, walk, version):
    _, given, _ = walk
    with fmus[version].instance() as one:
        for tick in range(40):
            one.set(given[tick])
            one.step(1e-3 * tick)
        with pytest.raises(FMICallException):
            one.set({"request": 3})
        assert one.get("request") == Request.WALK
        one.set({"angle.knee_left": 5.0})
        one.step(0.04)
        out = one.outputs()
        assert (out["mode"], out["reason"]) == (Mode.DAMP, Reason.BY_FAULT) and out["fault"] > 0
        assert {out[name] for name in out if name.endswith((".kp", ".tau_ff"))} == {0.0}
        assert min(out[name] for name in out if name.endswith(".kd")) > 0.0
        assert "joints damp until reset" in one.messages[-1]
        one.slave.reset()
        one.start()
        one.set(given[10])
        one.step(0.0)
        assert one.get("mode") == Mode.STAND


def test_a_gait_with_commands_is_told_them(tmp_path):
    design = replace(commanded_design("amber3m", {"pd": LAWS["pd"]}), supervised=True)
    fmu = UnpackedFmu(made_fmu(design, "3.0", tmp_path), tmp_path / "unpacked")
    with fmu.instance() as one:
        one.step(0.0)
        assert one.get("mode") == Mode.DAMP and one.get("fault") == 0


def test_variables_of_the_supervisor_are_there_with_it_alone(design):
    own = {"request", "mode", "reason", "waiting"}
    plain = {"kp", "kd", "blend", "first_leg"}
    names = {one.name for one in variables_of(design)}
    others = {one.name for one in variables_of(replace(design, supervised=False))}
    assert names - others == own and others - names == plain


@pytest.mark.parametrize("format", ["c", "onnx"])
def test_a_format_without_a_choice_refuses_the_flag(tmp_path, format):
    with pytest.raises(InputError, match=r"--supervisor: expected --format fmu or fmu2 or ros2"):
        export_controller(demo.FOLDER, tmp_path / "out", format=format, supervisor=True)
    assert not (tmp_path / "out").exists()
