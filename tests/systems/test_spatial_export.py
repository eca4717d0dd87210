"""The biped's controller in C gives MuJoCo the torques that Python's gives, on either foot."""

import ctypes

import jax
import numpy as np
import pytest

from neuralgaits._compiler import Compiler, SharedLibrary
from neuralgaits.cli.main import main
from neuralgaits.simulation.setup.command_schedule import CommandSchedule
from neuralgaits.systems.controller_selftest import TESTED
from neuralgaits.systems.family_run import open_family_run
from neuralgaits.systems.walker3d.spatial_plant import SpatialPlants
from neuralgaits.systems.walker3d.spatial_system import SYSTEM
from neuralgaits.systems.walker3d.spatial_walks import LANDING, law_of_gait, starts_of
from neuralgaits.systems.walker3d.step_commands import StepCommands

pytestmark = pytest.mark.slow
STEPS, LIMIT_NM = 3, 80.0
Six, Three = 6 * ctypes.c_double, 3 * ctypes.c_double


class Reading(ctypes.Structure):
    """`ng_walker3d_reading`."""

    _fields_ = [
        *((name, ctypes.c_double) for name in ("roll", "pitch", "roll_rate", "pitch_rate")),
        ("joints", Six),
        ("rates", Six),
        ("velocity", Three),
        ("velocity_known", ctypes.c_int),
        ("contact", 2 * ctypes.c_int),
    ]


class Tick(ctypes.Structure):
    """`ng_walker3d`."""

    _fields_ = [("left", ctypes.c_int), ("phase", ctypes.c_double), ("z", 4 * ctypes.c_double)]


class ToldTick(Tick):
    """The same of a gait that is told its speed."""

    _fields_ = [("requested", ctypes.c_double), ("told", 2 * ctypes.c_double)]


@pytest.fixture(scope="module")
def run(spatial_run):
    return open_family_run(SYSTEM, spatial_run)


@pytest.fixture(scope="module")
def told_run(speed_run):
    return open_family_run(SYSTEM, speed_run)


def exported_to(folder, run):
    assert main(["export", str(run.path), "--out", str(folder)]) in (0, 3)
    return folder


def built(folder, place):
    """Compile what was exported."""
    compiler = Compiler.for_c()
    if compiler is None:
        pytest.skip("no C compiler")
    files = {path.name: path.read_text() for path in folder.iterdir()}
    sources = tuple(name for name in files if name.endswith(".c"))
    flags = ("-std=c99", "-O1", "-fPIC", "-shared")
    made = SharedLibrary("walker3d", files, sources, flags)
    return ctypes.CDLL(str(compiler.compile(made, place)))


@pytest.fixture(scope="module")
def exported(run, tmp_path_factory):
    """The folder that `export` writes."""
    return exported_to(tmp_path_factory.mktemp("c") / "walker3d", run)


@pytest.fixture(scope="module")
def library(exported, tmp_path_factory):
    return built(exported, tmp_path_factory.mktemp("built"))


@pytest.fixture(scope="module")
def told_library(told_run, tmp_path_factory):
    folder = exported_to(tmp_path_factory.mktemp("told") / "walker3d", told_run)
    return built(folder, tmp_path_factory.mktemp("built-told"))


def reading_of(plants):
    """What a robot's own sensors say, which do not know on which foot it stands."""
    (world,) = plants.worlds
    feet, radius = plants.robot.tree.feet, plants.model.geom_size[plants.robot.tree.feet[0], 0]
    q, dq = world.qpos, world.qvel
    touching = [int(world.geom_xpos[foot, 2] <= radius) for foot in feet]
    contact = (2 * ctypes.c_int)(*touching)
    return Reading(*q[3:5], *dq[3:5], Six(*q[5:]), Six(*dq[5:]), Three(*dq[:3]), 1, contact)


def largest_difference(run, library, tick, commands, after_step):
    """Walk some steps; return the largest difference of torques from Python's, and of phases.

    At the very ends of a step, where outputs bend within 1e-7 of it, rounding of the phase counts
    ten million times: such a tick counts a thousandth.
    """
    gait, torques, off, phases = run.controller, Six(), [], []
    law = law_of_gait(run.data, gait, "pd")
    place = jax.jit(lambda pair, z: gait.step(pair).policy.phase(z))
    first = jax.tree.map(np.asarray, gait.step(commands.pairs[0]))
    plants = SpatialPlants.started(run.data, first, starts_of(first, 2, 3)[1:])
    taken, phase = 0, 0.0
    while taken < STEPS and len(off) < 3000:
        touch = plants.landed()[0] and phase > LANDING
        plants.left ^= touch
        taken += touch
        commands.latch(np.array([touch]))
        now = jax.tree.map(np.asarray, law(plants.measured(), commands.pairs))
        phase = float(place(commands.pairs[0], now.z[0]))
        reading = reading_of(plants)
        assert library.ng_walker3d_tick(ctypes.byref(tick), ctypes.byref(reading), torques) == 0
        assert bool(tick.left) is bool(plants.left[0])
        if touch:
            after_step(taken)
        plants.drive(0, plants.own(now.torques)[0], np.zeros(2))
        bends = min(abs(phase), abs(phase - 1.0)) < 1e-6
        off.append((1e-3 if bends else 1.0) * (plants.worlds[0].ctrl - np.array(torques)))
        phases.append(phase - tick.phase)
    assert taken == STEPS
    return np.abs(off).max(), np.abs(phases).max()


def test_the_tick_is_pythons_over_a_walk(run, library):
    tick = Tick()
    library.ng_walker3d_start(ctypes.byref(tick), 0)
    off, phases = largest_difference(run, library, tick, StepCommands(None, 1), lambda _: None)
    assert off < 1e-9 * LIMIT_NM
    assert phases < 1e-12


def test_the_tick_of_a_gait_that_is_told_speeds_is_pythons(told_run, told_library):
    """Requests beyond a step's change, beyond the range, and back: both sides latch the same."""
    command = told_run.config.command
    requests = [0.66, 9.0, 0.651, 0.651]
    told = CommandSchedule((command,), np.array([0.655]), np.array(requests)[:, None])
    tick, seen = ToldTick(), []
    memory = ctypes.byref(tick)

    def tell(speed):
        return told_library.ng_walker3d_tell(memory, ctypes.c_double(speed))

    told_library.ng_walker3d_start_at(memory, 0, ctypes.c_double(0.655))
    assert tell(requests[0]) == 0

    def after_step(taken):
        seen.append(tuple(tick.told))
        assert tell(requests[taken]) == (0 if requests[taken] <= command.high else 1)

    off, phases = largest_difference(
        told_run, told_library, tick, StepCommands(told, 1), after_step
    )
    assert off < 1e-9 * LIMIT_NM
    assert phases < 1e-12
    np.testing.assert_allclose(seen, [(0.655, 0.658), (0.658, 0.661), (0.661, 0.658)])


def test_speeds_that_no_gait_is_told_are_clamped_or_ignored(told_run, told_library):
    command, tick = told_run.config.command, ToldTick()
    memory = ctypes.byref(tick)
    told_library.ng_walker3d_start(memory, 1)
    assert (tick.left, tick.requested, *tick.told) == (1, *3 * (command.middle,))
    for speed, held in ((0.1, command.low), (np.inf, command.high), (np.nan, command.high)):
        assert told_library.ng_walker3d_tell(memory, ctypes.c_double(speed)) == 1
        assert tick.requested == held
    assert tuple(tick.told) == 2 * (command.middle,)
    told_library.ng_walker3d_start_at(memory, 0, ctypes.c_double(0.1))
    assert (tick.left, *tick.told) == (0, *2 * (command.low,))


def test_a_state_without_a_pose_has_no_torques_and_torques_have_limits(run, library):
    tick, torques = Tick(), Six()
    library.ng_walker3d_start(ctypes.byref(tick), 0)
    plants = SpatialPlants.started(run.data, run.controller, starts_of(run.controller, 1, 0))
    reading = reading_of(plants)
    reading.joints[5] += 0.5
    assert library.ng_walker3d_tick(ctypes.byref(tick), ctypes.byref(reading), torques) == 0
    assert np.abs(np.array(torques)).max() == LIMIT_NM
    reading.rates[1] = np.nan
    assert library.ng_walker3d_tick(ctypes.byref(tick), ctypes.byref(reading), torques) == 1
    assert np.abs(np.array(torques)).max() == 0.0


def test_a_resting_foot_tells_the_velocity(run, library):
    """On the zero dynamics the stance foot rests: measured or not, torques are the same."""
    plants = SpatialPlants.started(run.data, run.controller, starts_of(run.controller, 1, 0))
    found = []
    for known in (1, 0):
        tick, torques, reading = Tick(), Six(), reading_of(plants)
        library.ng_walker3d_start(ctypes.byref(tick), 0)
        reading.velocity_known = known
        if not known:
            reading.velocity = Three(9.0, 9.0, 9.0)
        library.ng_walker3d_tick(ctypes.byref(tick), ctypes.byref(reading), torques)
        found.append(np.array(torques))
    np.testing.assert_allclose(found[1], found[0], atol=1e-9)


def test_the_table_is_what_c_computes(exported, library):
    assert library.ng_walker3d_law_selftest() == 0
    table = (exported / "walker3d_selftest.c").read_text()
    assert table.count("    {NG(") == 2 * TESTED
