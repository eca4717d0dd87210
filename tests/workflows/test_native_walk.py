"""Compiled walks: tick by tick those of the loop in JAX; and where none can be made."""

import ctypes
import shutil
import subprocess
import sys
from dataclasses import fields
from pathlib import Path

import equinox as eqx
import jax
import mujoco
import numpy as np
import pytest

from neuralgaits._compiler import Compiler
from neuralgaits.analysis.run import open_run
from neuralgaits.cli.main import main
from neuralgaits.control import AbstractLaw, Controller, Pd, ScheduledPd
from neuralgaits.control.controlled_gait import ControlledGait, law_for
from neuralgaits.control.law_by_name import law_named
from neuralgaits.errors import InputError, NonFiniteError
from neuralgaits.robots import load_robot
from neuralgaits.runs import from_json
from neuralgaits.simulation import native_walk
from neuralgaits.simulation.live import LiveWalk
from neuralgaits.simulation.metrics import hip_speed_error
from neuralgaits.simulation.native import compiled_walk as native_library
from neuralgaits.simulation.native import loop as native
from neuralgaits.simulation.native.native_scene import scene_of
from neuralgaits.simulation.native.struct_layout import address
from neuralgaits.simulation.native_walk import (
    SOURCES,
    _design,
    engine_of,
    engine_of_run,
    sources,
)
from neuralgaits.simulation.setup.disturbance import PlantChanges, parse
from neuralgaits.simulation.setup.plant import build
from neuralgaits.simulation.setup.push import Push
from neuralgaits.simulation.setup.sensing import sensed
from neuralgaits.simulation.setup.starts import full_states, momentum_range
from neuralgaits.simulation.ticks import lockstep
from neuralgaits.simulation.ticks.falls import Ending
from neuralgaits.simulation.walk import plant_states, walk
from neuralgaits.workflows.simulate import simulate
from support.shipped_run import SHIPPED

RELATIVE = 1e-9
"""How far the two may be apart over three steps, in units of the largest value of a signal."""
PLANTS = {
    "as modelled": "",
    "uneven": "floor_height=0.01,slope_deg=2",
    "noisy": "encoder_noise=0.002,rate_noise=0.02",
    "coarse, late and weak": "encoder_step=0.001,delay_ms=3,torque_limit=30,friction=0.4",
    "estimated": "estimator=1,encoder_step=4e-4,pitch_noise=1e-3,pitch_offset=2e-3,delay_ms=2",
    "drives": "drive_stiffness=300,drive_damping=5,torque_limit=30,delay_ms=1,encoder_step=0.001",
    "fast drives": "drive_stiffness=300,drive_damping=5,drive_rate=5000,encoder_step=0.001",
    "another robot": "mass_scale=1.1,torso_shift_m=0.02,joint_friction=0.5",
}
WALKS = [
    *(("pd", plant) for plant in PLANTS),
    *(("fblin", plant) for plant in ("as modelled", "noisy", "coarse, late and weak", "drives")),
    ("paper", "uneven"),
    ("clf-qp", "coarse, late and weak"),
    ("scheduled-pd", "as modelled"),
    (ScheduledPd(bandwidth=30.0, predicts_rates=True), "coarse, late and weak"),
]


def test_each_disturbance_is_in_a_plant_that_is_compared():
    """A compiled walk ignores in silence what it was not given."""
    named = {one.split("=")[0] for plant in PLANTS.values() for one in plant.split(",") if one}
    assert named == {one.name for one in fields(PlantChanges)}


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    folder = tmp_path_factory.mktemp("native") / "run"
    shutil.copytree(SHIPPED, folder)
    return open_run(folder)


@pytest.fixture(scope="module")
def library(run):
    found = engine_of_run(run, "native")
    assert found.library is not None and found.note is None
    return found.library


def walked(
    run, *, episodes=2, start="region", seed=3, controller: str | AbstractLaw = "pd", **settings
):
    starts = full_states(run.zero_dynamics, run.gait, start, seed=seed, episodes=episodes)
    return walk(
        run.robot,
        run.gait.policy,
        starts,
        controller=law_for(controller, run.robot, run.gait),
        z2_range=momentum_range(run.gait),
        seed=seed,
        **settings,
    )


def apart(tree, other):
    """Largest difference of two trees of arrays, leaf by leaf in units of the leaf's size."""
    worst = 0.0
    for one, two in zip(jax.tree.leaves(tree), jax.tree.leaves(other), strict=True):
        one, two = np.asarray(one, dtype=float), np.asarray(two, dtype=float)
        assert one.shape == two.shape
        known = np.isfinite(one)
        np.testing.assert_array_equal(one[~known], two[~known])
        if known.any():
            size = max(1e-6, float(np.abs(one[known]).max()))
            worst = max(worst, float(np.abs(one[known] - two[known]).max()) / size)
    return worst


@pytest.mark.parametrize(("law", "plant"), WALKS)
def test_every_tick_is_that_of_the_reference(run, library, law, plant):
    """Records, states, floors and figures over three steps, with a push in their middle."""
    settings = {"disturbance": parse(PLANTS[plant]), "push": 3.0, "steps": 3, "controller": law}
    settings |= {"record": True, "longest": 700}
    one, two = walked(run, **settings), walked(run, library=library, **settings)
    assert (one.engine, two.engine) == ("jax", "native")
    a, b = one.episodes, two.episodes
    assert a.endings == b.endings and a.plant_steps == b.plant_steps
    assert len(b.records) == 2 and len(b.records[0].time) == 700
    for ours, theirs in ((a.record, b.record), (a.records, b.records), (a.states, b.states)):
        assert apart(ours, theirs) <= RELATIVE
    np.testing.assert_array_equal(a.floors, b.floors)
    assert apart(a.gauge, b.gauge) <= RELATIVE


def test_estimates_are_near_what_mujoco_does(run, library):
    """Touchdowns included; with exact sensors closer, with a torso that is read askew less so."""
    errors = []
    for sensing in ("bits=32,pitch_noise=0,delay_ms=0", "bits=14", "pitch_offset=0.01"):
        disturbance = sensed(PlantChanges(), f"encoders,{sensing}")
        found = walked(run, library=library, steps=12, disturbance=disturbance)
        assert found.episodes.endings == [Ending.WALKED] * 2
        errors.append(hip_speed_error(found))
    assert 0.0 < errors[0] <= 0.006 < errors[1] <= 0.012 < errors[2] <= 0.03
    assert hip_speed_error(walked(run, library=library, steps=1)) is None


@pytest.mark.slow
def test_every_kind_of_end_is_that_of_the_reference(run, library):
    """Pushed so hard that some fall, each at its own time; two at a time, as all walks here."""
    ends, disturbance = set(), parse("friction=0.5,delay_ms=2")
    for push in (-6.0, -30.0, -60.0):
        settings = {"steps": 5, "push": push, "disturbance": disturbance}
        one = walked(run, **settings).episodes
        two = walked(run, library=library, **settings).episodes
        assert one.endings == two.endings
        np.testing.assert_array_equal(one.gauge.steps, two.gauge.steps)
        ends |= set(one.endings)
    assert Ending.WALKED in ends and len(ends) > 1


def test_a_start_that_no_number_holds_is_not_walked_on(run, library):
    """Rates that overflow, and rates that MuJoCo refuses, upon which it begins anew by itself."""
    policy, settings = run.gait.policy, {"z2_range": momentum_range(run.gait), "steps": 2}
    for rate in (1e200, 1e12, -1e12, 1e6):
        start = full_states(run.zero_dynamics, run.gait, "centre", seed=0, episodes=2).copy()
        start[:, run.robot.n :] = rate
        one = walk(run.robot, policy, start, **settings).episodes
        two = walk(run.robot, policy, start, library=library, **settings).episodes
        assert one.endings == two.endings and one.endings[0].fell
        assert one.plant_steps == two.plant_steps


def test_another_plant_with_other_signs_and_gains(run, library):
    """The controller's robot is not the plant's; gains are numbers of the scene, not of the C."""
    plant = load_robot("amber3m-tail")
    law = Pd(stiffness=(1200.0,), damping=(40.0,), hold_ticks=3)
    settings = {"plant": plant, "controller": law, "steps": 2, "record": True}
    one, two = walked(run, **settings), walked(run, library=library, **settings)
    assert two.engine == "native"
    assert apart(one.episodes.record, two.episodes.record) <= RELATIVE


def test_threads_and_company_change_nothing(run, library):
    settings = {"steps": 4, "disturbance": parse(PLANTS["noisy"] + ",floor_height=0.005")}
    settings |= {"z2_range": momentum_range(run.gait), "seed": 3, "library": library}
    starts = full_states(run.zero_dynamics, run.gait, "region", seed=3, episodes=5)

    def of(starts, threads):
        policy = run.gait.policy
        return walk(run.robot, policy, starts, threads=threads, **settings).episodes

    many, again, alone = of(starts, 3), of(starts, 1), of(starts[:1], 1)
    assert apart(many.gauge, again.gauge) == 0.0
    first = jax.tree.map(lambda leaf: leaf[:1], many.gauge)
    assert apart(first, alone.gauge) == 0.0


def test_floors_of_a_long_walk_are_those_of_the_reference(run, library, monkeypatch):
    """Drawn in blocks, however many steps were asked for."""
    monkeypatch.setattr(native, "_CHUNK", 700)
    monkeypatch.setattr(native, "_TOUCHDOWNS", 3)
    settings = {"disturbance": parse("floor_height=0.003"), "record": True}
    one, two = (
        walked(run, steps=7, library=given, **settings).episodes for given in (None, library)
    )
    np.testing.assert_array_equal(one.floors, two.floors)
    assert len(np.unique(one.floors)) > 2
    falling = parse("floor_height=0.003,friction=0.0")
    assert walked(run, steps=10**6, library=library, disturbance=falling).episodes.endings[0].fell


def test_what_needs_python_in_a_tick_walks_in_jax(run, library, monkeypatch):
    class Own(Pd):
        """A law that no C is written for."""

    ticks = []
    watched = walked(run, steps=1, library=library, watch=lambda *_: ticks.append(1))
    assert watched.engine == "jax" and ticks
    assert walked(run, steps=1, library=library, controller=Own()).engine == "jax"
    policies = [run.gait.policy] * 2
    starts = full_states(run.zero_dynamics, run.gait, "region", seed=0, episodes=2)

    class Begun(Exception):
        """The loop in JAX; that it walks several policies is tested in simulation/test_walk.py."""

    def begin(*_, **__):
        raise Begun

    monkeypatch.setattr(lockstep, "run", begin)
    with pytest.raises(Begun):
        walk(run.robot, policies, starts, steps=1, library=library)


def test_an_error_of_mujoco_ends_the_walk_and_not_the_process(run, library, monkeypatch):
    engine = ctypes.CDLL(str(native_library.mujoco_library()))
    monkeypatch.setattr(library, "mj_step", address(engine.mju_error))
    with pytest.raises(NonFiniteError, match="MuJoCo gave up in episode 0"):
        walked(run, steps=1, library=library)


def test_the_summary_says_what_walked(run, capfd):
    chosen, found = simulate(run, steps=1, engine="jax"), simulate(run, steps=1)
    for done, engine in ((chosen.summary, "jax"), (found.summary, "native")):
        assert (done["engine"], done["engine_note"]) == (engine, None)
    assert main(["simulate", str(run.path), "--engine", "native", "--steps", "1", "--json"]) == 0
    assert from_json(capfd.readouterr().out.encode())["engine"] == "native"
    with pytest.raises(InputError, match="expected one of native, jax, found 'fast'"):
        simulate(run, steps=1, engine="fast")  # pyright: ignore[reportArgumentType]


@pytest.fixture
def quickly_made(monkeypatch):
    """Compiled without optimising: these tests are about where libraries are kept."""
    flags = tuple("-O0" if flag.startswith("-O") else flag for flag in native_walk.FLAGS)
    monkeypatch.setattr(native_walk, "FLAGS", flags)


@pytest.fixture
def cache(quickly_made, tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    return tmp_path / "neuralgaits" / "walks"


@pytest.mark.parametrize(
    ("environment", "why"),
    [
        ({"PATH": "", "CC": ""}, "there is no C compiler: install gcc or clang"),
        ({"CC": "no-such-compiler"}, "no-such-compiler does not run"),
        ({"CC": sys.executable}, "fails ("),
        ({"CC": "true"}, "true fails"),
    ],
)
def test_without_a_compiler_that_works_the_walk_goes_on_in_jax(
    run, cache, monkeypatch, capfd, environment, why
):
    for name, value in environment.items():
        monkeypatch.setenv(name, value)
    found = engine_of_run(run)
    assert found.library is None
    assert found.note is not None and why in found.note and "\n" not in found.note
    with pytest.raises(InputError, match="--engine native: expected a compiled walk, but"):
        engine_of_run(run, "native")
    assert engine_of_run(run, "jax").note is None
    assert main(["simulate", str(run.path), "--steps", "1", "--engine", "native"]) == 2
    assert "--engine native: expected a compiled walk, but" in capfd.readouterr().err
    assert not cache.exists() or not list(cache.iterdir())


def test_the_command_line_says_why_it_is_slow(run, cache, monkeypatch, capfd):
    monkeypatch.setenv("CC", "no-such-compiler")
    assert main(["simulate", str(run.path), "--steps", "1"]) == 0
    why = "walking with JAX, many times slower, because no-such-compiler does not run"
    assert why in capfd.readouterr().err
    assert main(["simulate", str(run.path), "--steps", "1", "--json"]) == 0
    said = capfd.readouterr()
    told = from_json(said.out.encode())
    assert told["engine"] == "jax" and why in told["engine_note"] and said.err == ""


def test_a_cache_that_cannot_be_written_costs_a_compilation(
    run, quickly_made, tmp_path, monkeypatch
):
    (tmp_path / "file").touch()
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "file"))
    found = engine_of_run(run)
    assert found.library is not None
    assert found.note is not None and "cannot be written (Not a directory)" in found.note
    assert walked(run, steps=1, library=found.library).engine == "native"


def test_a_library_is_made_once_and_a_damaged_one_again(run, cache):
    first = engine_of_run(run).library
    assert first is not None
    (kept,) = cache.iterdir()
    made = kept.stat().st_mtime_ns
    assert engine_of_run(run, "native").library is not None
    assert kept.stat().st_mtime_ns == made
    # A file that is loaded is exchanged, not written to.
    kept.unlink()
    kept.write_bytes(b"no library")
    found = engine_of_run(run, "native").library
    assert found is not None and walked(run, steps=1, library=found).engine == "native"


def test_a_policy_is_part_of_what_is_compiled(run, cache):
    engine_of_run(run, "native")
    engine_of(ControlledGait(run.robot, other_gait(run), momentum_range(run.gait)), "native")
    assert len(list(cache.iterdir())) == 2


def test_gaits_that_are_not_kept_are_two_all_the_same(run, quickly_made, tmp_path, monkeypatch):
    """What is loaded under a name is not loaded again: without a cache, each has its own."""
    (tmp_path / "file").touch()
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "file"))
    starts = full_states(run.zero_dynamics, run.gait, "centre", seed=0, episodes=2)
    torques = []
    for gait in (run.gait, other_gait(run)):
        z2_range = momentum_range(gait)
        library = engine_of(ControlledGait(run.robot, gait, z2_range), "native").library
        one, two = (
            walk(
                run.robot,
                gait.policy,
                starts,
                steps=1,
                record=True,
                z2_range=z2_range,
                library=given,
            ).episodes.record
            for given in (library, None)
        )
        assert one is not None and apart(one, two) <= RELATIVE
        torques.append(one.result.torque[0])
    assert np.abs(torques[0] - torques[1]).max() > 1e-3


def test_the_library_of_another_gait_is_refused(run, library):
    starts = full_states(run.zero_dynamics, run.gait, "centre", seed=0, episodes=2)
    whole = momentum_range(run.gait)
    for policy, z2_range in ((other_gait(run).policy, whole), (run.gait.policy, (1.0, 2.0))):
        with pytest.raises(InputError, match="expected the compiled walk of this controller"):
            walk(run.robot, policy, starts, steps=1, library=library, z2_range=z2_range)


def other_gait(run):
    """The run's gait with another policy."""
    scaled = jax.tree.map(
        lambda leaf: leaf * 1.001 if eqx.is_inexact_array(leaf) else leaf, run.gait.policy
    )
    return eqx.tree_at(lambda gait: gait.policy, run.gait, scaled)


def test_a_live_walk_is_that_of_the_reference(run, library):
    """Pushed, tilted, loaded and put elsewhere while it walks, as a live page does it."""
    start = full_states(run.zero_dynamics, run.gait, "region", seed=0, episodes=2)
    controller = ControlledGait(run.robot, run.gait, momentum_range(run.gait)).under("pd")
    one, two = (LiveWalk(controller, start[0], library=given) for given in (None, library))
    lives = one, two
    happenings = {
        100: lambda live: live.push(np.array([4.0, 1.0])),
        300: lambda live: live.disturb(slope_deg=1.0, mass_scale=1.05),
        700: lambda live: live.disturb(torque_limit=25.0, friction=0.4),
        900: lambda live: live.place(start[1]),
        1300: lambda live: live.push(np.array([-90.0, 0.0])),
    }
    for number in range(2500):
        for live in lives:
            happenings.get(number, lambda _: None)(live)
        assert len({live.tick() for live in lives}) == 1
        assert one.ending == two.ending
        assert one.outcome is not None and two.outcome is not None
        np.testing.assert_array_equal(one.outcome.steps, two.outcome.steps)
        assert apart(one.data.qpos, two.data.qpos) <= 1e-7
        if number in (1, 650, 1250):
            assert apart(one.record, two.record) <= 1e-7
            assert apart(one.outcome, two.outcome) <= 1e-7
            for live in lives:
                assert live.record is not None and live.measured is not None
                result = live.record.result
                parts = result.q, result.dq, result.z, result.commands
                for ours, theirs in zip(live.measured, parts, strict=True):
                    np.testing.assert_array_equal(ours, np.asarray(theirs)[0])
    assert lives[0].ending.fell


@pytest.mark.parametrize("law", ["pd", "clf-qp"])
def test_nothing_is_read_or_written_that_is_not_ours(run, library, tmp_path, law):
    """The loop as a program of its own, under the sanitizers of addresses and of behaviour."""
    compiler = Compiler.for_c()
    assert compiler is not None
    plant = build(run.robot, parse(f"{PLANTS['uneven']},{PLANTS['noisy']},delay_ms=2"))
    starts = full_states(run.zero_dynamics, run.gait, "region", seed=0, episodes=3)
    limits = {"z2_range": momentum_range(run.gait), "period_s": 1e-3}
    controller = Controller.init(run.robot, run.gait.policy, law_named(law), **limits)
    scene = scene_of(library, plant, controller, 7, Push(5.0, 7, 0, 3))
    scene.uneven = 1
    mujoco.mj_saveModel(plant.model, str(tmp_path / "model.mjb"))
    (tmp_path / "scene").write_bytes(bytes(scene))
    (tmp_path / "starts").write_bytes(plant_states(plant, starts).tobytes())
    for name, text in sources(
        _design(ControlledGait(run.robot, run.gait, limits["z2_range"]))
    ).items():
        (tmp_path / name).write_text(text)
    folder, loaded = Path(mujoco.__file__).parent, native_library.mujoco_library()
    flags = ["-fsanitize=address,undefined", "-fno-sanitize-recover=all", "-Wall", "-Wextra"]
    files = [str(tmp_path / name) for name in SOURCES]
    files += [str(Path(__file__).parent / "walk_main.c"), "-o", str(tmp_path / "walk_main")]
    linked = ["-I", str(tmp_path), "-isystem", str(folder / "include")]
    linked += [str(loaded), f"-Wl,-rpath,{folder}", "-lm"]
    compiler.run(["-std=gnu99", "-O0", "-g1", "-Werror", *flags, *files, *linked])
    done = subprocess.run(
        [str(tmp_path / name) for name in ("walk_main", "model.mjb", "scene", "starts")] + ["3"],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr[-2000:]
    assert done.stdout.split("\n")[:3] == [f"{int(Ending.WALKED)} 7"] * 3
