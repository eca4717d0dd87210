"""FMUs of a controller: walked in MuJoCo, compared with the C in them, and called wrongly."""

import math
import re
import subprocess
import zipfile
from pathlib import Path

import numpy as np
import pytest
from fmpy.fmi1 import FMICallException
from fmpy.validation import validate_fmu

from neuralgaits.export import build
from neuralgaits.export.fmu import fmu_sources
from neuralgaits.export.source import gait_files
from neuralgaits.simulation.setup.starts import full_states
from support.compiled import folder_with
from support.fmu_host import (
    VERSIONS,
    FmuInstance,
    FmuPlant,
    UnpackedFmu,
    library_of,
    made_fmu,
    walked,
)
from support.monitored import made_up

TWIN = Path(__file__).with_name("fmu_twin.c")
TICKS = 1100
STANDING = {"angle.knee_left": 0.3, "angle.hip_left": -0.2, "angle.knee_right": 0.5}
STANDING |= {"angle.hip_right": 0.3, "force.foot_left": 200.0}


@pytest.fixture(scope="module")
def walker():
    """The shipped run with a monitor of levels 2, 4 and 5, and a state to start from."""
    run, _, design = made_up()
    starts = full_states(run.zero_dynamics, run.gait, "centre", seed=0, episodes=1)
    return design, np.asarray(starts[0])


@pytest.fixture(scope="module")
def files(walker, tmp_path_factory):
    """An FMU of either version."""
    folders = {version: tmp_path_factory.mktemp("fmu") for version in VERSIONS}
    return {version: made_fmu(walker[0], version, folder) for version, folder in folders.items()}


@pytest.fixture(scope="module")
def fmus(files, tmp_path_factory):
    return {
        version: UnpackedFmu(path, tmp_path_factory.mktemp("unpacked"))
        for version, path in files.items()
    }


@pytest.fixture(params=VERSIONS)
def fmu(fmus, request):
    return fmus[request.param]


@pytest.fixture(scope="module")
def walks(fmus, walker):
    """Walks with measured rates and with estimated ones: steps, inputs, outputs."""
    found = {}
    for estimate in (False, True):
        with fmus["3.0"].instance(estimate=estimate, kp=200.0, kd=4.0) as one:
            found[estimate] = walked(one, FmuPlant(*walker), TICKS, rates=not estimate)
    return found


def test_the_fmus_are_valid(files):
    assert {version: validate_fmu(str(path)) for version, path in files.items()} == {
        "3.0": [],
        "2.0": [],
    }


def test_the_same_gait_gives_the_same_bytes(files, walker, tmp_path):
    again = made_fmu(walker[0], "3.0", tmp_path)
    assert again.read_bytes() == files["3.0"].read_bytes()


@pytest.mark.parametrize("estimate", [False, True])
def test_it_walks_in_mujoco(walks, estimate):
    steps, _, outputs = walks[estimate]
    assert steps >= 2
    assert {one["fault"] for one in outputs} == {0.0}
    assert {one["stance_leg"] for one in outputs} == {0.0, 1.0}
    inside = [one["monitor.level2.inside"] for one in outputs]
    assert 0.8 < np.mean(inside) < 1.0


@pytest.mark.parametrize("estimate", [False, True])
def test_its_ticks_are_those_of_the_c(walks, walker, estimate, tmp_path):
    design, (_, given, found) = walker[0], walks[estimate]
    folder = folder_with(tmp_path / "c", gait_files(design) | {TWIN.name: TWIN.read_text()})
    program = build.build("gcc", folder, "twin", (*build.CORE, TWIN.name), ("-O1",))
    legs = design.controller.robot.layout.leg_joints
    joints = [name for leg in legs for name in leg]
    columns = ["pitch", "pitch_rate", "velocity.x", "velocity.z"]
    columns += [f"force.{foot}" for foot in design.controller.robot.layout.feet]
    columns += [f"angle.{name}" for name in joints] + [f"rate.{name}" for name in joints]
    rows = [[row.get(name, 0.0) for name in columns] for row in given]
    data = np.concatenate([[0.0, float(estimate), 200.0, 4.0], np.ravel(rows)]).tobytes()
    done = subprocess.run([str(program)], input=data, capture_output=True, check=True)
    names = [f"motor.{name}" for name in joints]
    for name in joints:
        names += [f"target.{name}.{part}" for part in ("q_des", "dq_des", "kp", "kd", "tau_ff")]
    names += ["stance_leg", "fault"]
    expected = np.frombuffer(done.stdout).reshape(len(given), len(names))
    values = np.array([[row[name] for name in names] for row in found])
    assert len(given) >= 1000
    assert np.ptp(expected[:, :-1], axis=0).max() > 1.0
    np.testing.assert_allclose(values, expected, rtol=0.0, atol=1e-9)


def test_both_versions_give_the_same(fmus, walks):
    _, given, found = walks[True]
    with fmus["2.0"].instance(estimate=True, kp=200.0, kd=4.0) as one:
        for tick in range(200):
            one.set(given[tick])
            one.step(1e-3 * tick)
            assert one.outputs() == found[tick]


def test_torques_are_motor_commands_times_gears(walks, walker):
    layout = walker[0].controller.robot.layout
    for leg, joints in enumerate(layout.leg_joints):
        for i, name in enumerate(joints):
            gear = layout.gears[leg][i] * layout.leg_joint_signs[leg][i]
            for row in walks[False][2][::50]:
                assert row[f"torque.{name}"] == pytest.approx(gear * row[f"motor.{name}"])


def test_margins_have_the_names_of_the_description(fmus, walks, walker):
    monitor = walker[0].monitor
    for level in monitor.levels:
        text = fmus["3.0"].variables[f"monitor.level{level}.name"].description
        names = monitor.set_of(level).names
        assert all(f"{k}: {name}" in text for k, name in enumerate(names))
        for row in walks[False][2]:
            number, margin = (row[f"monitor.level{level}.{part}"] for part in ("name", "margin"))
            assert 0 <= number < len(names)
            assert (margin >= 0.0) == row[f"monitor.level{level}.inside"]


def test_two_instances_do_not_disturb_each_other(fmu, walks):
    _, given, _ = walks[True]

    def alone(first: int) -> list[dict[str, float]]:
        with fmu.instance() as one:
            return list(ticks(one, first))

    def ticks(one, first):
        for tick in range(60):
            one.set(given[first + tick])
            one.step(1e-3 * tick)
            yield one.outputs()

    with fmu.instance() as one, fmu.instance() as other:
        both = list(zip(ticks(one, 0), ticks(other, 300), strict=True))
    assert [a for a, _ in both] == alone(0)
    assert [b for _, b in both] == alone(300)
    assert alone(0) != alone(300)


def test_reset_and_saved_states_bring_back_what_was(fmu, walks):
    _, given, _ = walks[True]
    with fmu.instance(kp=50.0) as one:
        results = []
        for part in range(3):
            for tick in range(40):
                one.set(given[tick])
                one.step(1e-3 * tick)
                if part == 1 and tick == 19:
                    state = one.slave.getFMUState() if fmu.three else one.slave.getFMUstate()
            results.append(one.outputs())
            if part < 2:
                one.slave.reset()
                assert one.get("kp") == 100.0
                one.start(kp=50.0)
        assert results[0] == results[1] == results[2]
        (one.slave.setFMUState if fmu.three else one.slave.setFMUstate)(state)
        for tick in range(20, 40):
            one.set(given[tick])
            one.step(1e-3 * tick)
        assert one.outputs() == results[0]
        (one.slave.freeFMUState if fmu.three else one.slave.freeFMUstate)(state)


def refused(call, *arguments, **settings):
    with pytest.raises(FMICallException) as error:
        call(*arguments, **settings)
    return error.value.status


@pytest.mark.parametrize(
    ("time", "size", "message"),
    [
        (0.002, 1e-3, "expected a step from 0.003 s, found 0.002 s"),
        (0.004, 1e-3, "expected a step from 0.003 s, found 0.004 s"),
        (math.nan, 1e-3, "expected a step from 0.003 s, found nan s"),
        (0.003, 2e-3, "expected a size of 0.001 s, found 0.002 s"),
        (0.003, 0.0, "expected a size of 0.001 s, found 0 s"),
        (0.003, -1e-3, "expected a size of 0.001 s, found -0.001 s"),
        (0.003, math.inf, "expected a size of 0.001 s, found inf s"),
    ],
)
def test_other_steps_are_discarded_and_change_nothing(fmu, time, size, message):
    with fmu.instance(**STANDING) as one:
        for tick in range(3):
            one.step(1e-3 * tick)
        before = one.outputs()
        assert refused(one.step, time, size) == 2
        assert one.outputs() == before
        one.step(0.003 + 1e-12)
        assert one.outputs() != before
    assert [text for text in one.messages if message in text] == [f"step: {message}"]


def test_calls_out_of_order_are_errors(fmu):
    with fmu.instance() as one:
        one.slave.reset()
        assert refused(one.step, 0.0) == 3
        assert refused(one.slave.exitInitializationMode) == 3
        assert refused(one.slave.terminate) == 3
        one.start()
        assert refused(one.set, {"law": 1}) == 3
        one.set({"kp": 10.0, "pitch": 0.0})
        one.slave.terminate()
        assert refused(one.step, 0.0) == 3
        assert refused(one.set, {"pitch": 0.0}) == 3
    assert len(one.messages) == 6


@pytest.mark.parametrize(
    "values",
    [
        {"torque_limit": math.nan},
        {"blend": -1.0},
        {"kp": math.inf},
        {"law": 99},
        {"law": -1},
        {"first_leg": 2},
        {"stance_leg": 1},
        {"hip_ahead": 0.1},
    ],
)
def test_values_that_make_no_sense_are_errors(fmu, values):
    with fmu.instance() as one:
        one.slave.reset()
        (name,) = values
        before = one.get(name)
        assert refused(one.set, values) == 3
        assert one.get(name) == before
        one.start()
        one.step(0.0)
    assert len(one.messages) == 1 and one.messages[0].startswith("value reference")


def test_other_references_are_errors(fmu):
    with fmu.instance() as one:
        place = one.fmu.variables["law"].valueReference
        get, put = (
            (one.slave.getFloat64, one.slave.setFloat64)
            if fmu.three
            else (one.slave.getReal, one.slave.setReal)
        )
        for reference in (place, 100_000, 2**32 - 1):
            assert refused(get, [reference]) == 3
            assert refused(put, [reference], [0.0]) == 3


@pytest.mark.parametrize(
    ("values", "fault"),
    [({"pitch": math.nan}, 1), ({"angle.knee_left": math.inf}, 1), ({"pitch": 1.5}, 2)],
)
def test_bad_readings_are_a_fault_of_the_controller(fmu, values, fault):
    with fmu.instance(**STANDING, estimate=False, kd=7.0) as one:
        one.step(0.0)
        assert one.get("fault") == 0
        one.set(values)
        one.step(0.001)
        one.set(STANDING | {"pitch": 0.0})
        one.step(0.002)
        found = one.outputs()
    assert found["fault"] == fault
    assert {found[name] for name in found if name.startswith(("torque.", "motor."))} == {0.0}
    assert {found[name] for name in found if name.endswith(".kd")} == {7.0}
    assert found["monitor.level2.name"] == -1 and not found["monitor.level2.inside"]
    assert [text.split(":")[0] for text in one.messages] == ["fault at 0.001000 s"]


def test_parameters_do_what_they_say(fmu):
    def after(**parameters):
        with fmu.instance(**(STANDING | parameters)) as one:
            for tick in range(3):
                one.step(1e-3 * tick)
            found = one.outputs()
        torques = {name: value for name, value in found.items() if name.startswith("torque.")}
        return max(map(abs, torques.values())), torques, found

    largest, usual, whole = after()
    assert largest > 5.0
    assert after(torque_limit=2.0)[0] == 2.0
    assert after(blend=1.0)[0] < 0.1
    assert after(law=1)[1] != usual
    # A foot that is loaded becomes the stance foot at once.
    unloaded = {"force.foot_left": 0.0}
    assert after(**unloaded, first_leg=1)[2]["stance_leg"] == 1.0
    assert after(**unloaded)[2]["stance_leg"] == 0.0
    assert after(torque_limit=1e6)[2] == whole
    assert after(kp=1.0)[1] == usual
    assert after(kp=1.0)[2]["target.knee_left.tau_ff"] != whole["target.knee_left.tau_ff"]


def test_every_function_of_the_standard_is_there_and_harmless(fmus, tmp_path):
    headers = fmu_sources.headers()["fmi3Functions.h"]
    names = re.findall(r"FMI3_Export +\w+TYPE +(\w+);", headers)
    library = library_of(fmus["3.0"], tmp_path)
    assert len(names) == 75 and all(hasattr(library, name) for name in names)
    with fmus["3.0"].instance() as one:
        for name in names:
            quiet = name.startswith(("fmi3Instantiate", "fmi3GetVersion", "fmi3FreeInstance"))
            if not quiet:
                assert getattr(library, name)(None, *[0] * 8) == 3, name
        assert refused(one.slave.enterEventMode) == 3
    assert one.messages == ["fmi3EnterEventMode: not a function of this FMU"]


def test_another_token_gives_no_instance(fmus, walker):
    for one in fmus.values():
        token, one.described.guid = one.described.guid, "{0}"
        try:
            with pytest.raises(Exception, match="Failed to instantiate"):
                FmuInstance(one)
        finally:
            one.described.guid = token


def test_the_file_holds_what_the_standards_want(files, walker):
    for version, path in files.items():
        with zipfile.ZipFile(path) as opened:
            names = opened.namelist()
            described = opened.read("modelDescription.xml").decode()
        origin = walker[0].origin
        assert origin.robot_sha256 in described and origin.policy_sha256 in described
        assert not [name for name in names if re.search(r"fmi\d\w+\.h$", name)]
        assert ("sources/buildDescription.xml" in names) == (version == "3.0")
        headers = {Path(name).stem for name in names if name.endswith(".h")}
        own = {"gait", "controller", "estimator", "ng_math", "monitor", "monitor_set"}
        assert headers == own | {"fmu", "fmu_model"}
        assert sum(name.startswith("binaries/") for name in names) == 1
