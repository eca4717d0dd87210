"""The monitor in C: the certificate's own answer about each state, and no claim without a proof."""

import hashlib
import json
import shutil
import subprocess
from dataclasses import replace

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from neuralgaits.analysis.run import open_run
from neuralgaits.analysis.state_monitor import NO_NUMBER, CommandSpan
from neuralgaits.certificate.chart import Chart
from neuralgaits.certificate.levels.full_order.model import FullOrderModel
from neuralgaits.certificate.levels.walking_set.margins import barriers
from neuralgaits.certificate.run_certificate.proved_monitor import (
    monitor_of,
    proved_levels,
    spans,
    walking_set_of,
)
from neuralgaits.certificate.run_certificate.verified_summary import ProvedPart, read_certificate
from neuralgaits.errors import MismatchError, SpecError
from neuralgaits.export import build
from neuralgaits.export.monitor_check import (
    EDGES,
    SOURCES,
    c_answers,
    check_monitor,
    disagreements,
    distance,
    drawn_cases,
    python_answers,
)
from neuralgaits.export.monitor_source import monitor_files
from neuralgaits.export.source import gait_files
from neuralgaits.gait import ZeroDynamics
from neuralgaits.gait.commands import Pair
from neuralgaits.gait.policies.commanded_gait import CommandedGait
from neuralgaits.workflows import export as workflow
from neuralgaits.workflows.export import design_of, export_controller, with_monitor
from support import commanded_run, monitored
from support.shipped_run import SHIPPED

STATES = 4000
EDGE = 1e-12


@pytest.fixture(scope="module")
def made():
    """Run, constants of levels 4 and 5, and design; nobody changes them."""
    return monitored.made_up()


@pytest.fixture(scope="module")
def cases(made):
    return drawn_cases(made[2], STATES)


@pytest.fixture(scope="module")
def program(made, tmp_path_factory):
    return monitored.compiled(tmp_path_factory.mktemp("monitor"), made[2])


@pytest.fixture(scope="module")
def answers(made, cases, program):
    return c_answers(made[2].monitor, cases, program)


def test_the_set_of_level_2_is_the_tube(made, cases, answers):
    """Its answer in C is that of the gait's own phase and level, in and out and at the edges."""
    run, _, _ = made
    x = jnp.concatenate([cases.q, cases.dq], axis=1)
    _, z = jax.jit(jax.vmap(ZeroDynamics(run.robot, run.gait.policy).phi))(x)
    slacks = monitored.tube_margins(run.gait, monitored.WALKING, np.asarray(z))
    sure = ~monitored.close(slacks, EDGE)
    inside = monitored.none_negative(slacks)
    assert 0.2 < inside.mean() < 0.8 and sure.mean() > 0.9
    np.testing.assert_array_equal(answers.inside[sure, 0], inside[sure])
    # Fences alone are close where a state is inside.
    walls = np.stack([slacks["level-lower"], slacks["level-upper"]], axis=1)
    found, expected = answers.margin[inside & sure, 0], walls.min(1)[inside & sure]
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-13)


def test_the_set_of_levels_4_and_5_is_the_theorems(made, cases, answers):
    run, shape, design = made
    slacks = monitored.theorem_margins(run, shape, cases.q, cases.dq)
    sure = ~monitored.close(slacks, EDGE)
    inside = monitored.none_negative(slacks)
    assert 0.05 < inside.mean() < 0.8
    for level in (1, 2):
        np.testing.assert_array_equal(answers.inside[sure, level], inside[sure])
    # The name is that of the smallest: of the walls where no end is broken.
    names, units = design.monitor.sets[1].names, monitored.units_of(shape)
    walls = design.monitor.sets[1].walls
    scaled = {name: slacks[name] / units[name] for name in walls if name != "output-error"}
    bound = slacks["output-error"]
    for row in np.flatnonzero(inside & sure)[:200]:
        name = names[answers.nearest[row, 1]]
        others = min(one[row] for one in scaled.values())
        if name == "output-error":
            assert answers.margin[row, 1] <= others + EDGE and bound[row] >= 0.0
        else:
            assert abs(others - answers.margin[row, 1]) < 1e-9 and others == scaled[name][row]


def test_c_and_python_say_the_same(made, cases, answers):
    """Each answer and each name, but for margins within 1e-12 of an edge or of each other."""
    monitor = made[2].monitor
    expected = python_answers(monitor, cases)
    assert disagreements(monitor, answers, expected, EDGES["double"]) == 0
    assert distance(answers, expected) <= 1e-10
    # Every margin is the smallest somewhere, but for barriers that are never near.
    assert {monitor.sets[0].names[i] for i in answers.nearest[:, 0]} == set(monitor.sets[0].names)
    moved = answers._replace(nearest=answers.nearest * 0)
    assert disagreements(monitor, moved, expected, EDGES["double"]) > 100


def test_the_set_of_level_2_is_its_part_on_which_barriers_hold_if_that_is_all_that_is_proved(made):
    run, _, design = made
    one = walking_set_of(run, monitored.WALKING, tuple(barriers(run.spec)))
    assert one.names[-2:] == ("torso-lower", "torso-upper")
    cases = drawn_cases(design, 200)
    margins = one.margins(q=cases.q, dq=cases.dq)
    _, z = jax.jit(jax.vmap(run.zero_dynamics.phi))(jnp.concatenate([cases.q, cases.dq], axis=1))
    for k, barrier in enumerate(barriers(run.spec)):
        h = jax.jit(jax.vmap(lambda z, f=barrier.function: f(run.zero_dynamics.point(z))))(z)
        np.testing.assert_allclose(margins[:, 5 + k], h, rtol=0.0, atol=1e-12)
    margins[:, 5], margins[:, :5] = -0.5, 1.0
    found = one.membership(margins)
    assert not found.inside.any() and {one.names[i] for i in found.nearest} == {"torso-lower"}


def test_states_that_are_no_numbers_are_outside(made, cases, program):
    monitor = made[2].monitor
    spoilt = cases._replace(q=np.full_like(cases.q, np.nan)[:3], dq=cases.dq[:3])
    spoilt = spoilt._replace(before=cases.before[:3], after=cases.after[:3], step=cases.step[:3])
    found, expected = c_answers(monitor, spoilt, program), python_answers(monitor, spoilt)
    for one in (found, expected):
        assert not one.inside.any() and np.all(one.margin == NO_NUMBER)
    np.testing.assert_array_equal(found.nearest, expected.nearest)


def test_ticks_are_late_and_times_outside_add_up(made, cases, program):
    """1234 us is the hold in whole microseconds; the clock may wrap around."""
    inside = python_answers(made[2].monitor, cases).inside
    out = int(np.flatnonzero(inside[:, 0] & ~inside[:, 1])[0])
    within = int(np.flatnonzero(inside.all(axis=1))[0])
    gaps, start = [0, 1234, 1235, 1000, 900], 2**32 - 500
    times = [int(t) % 2**32 for t in start + np.cumsum(gaps)]
    rows = monitored.ticks(program, cases, [out, out, out, within, out], times)
    assert [r[0] for r in rows] == [str(gap) for gap in gaps]
    assert [r[1] for r in rows] == ["1", "1", "0", "1", "1"]
    assert all(r[2] == "1" for r in rows)
    levels = [np.array(r[3:-2]).reshape(3, 5) for r in rows]
    assert all(list(one[:, 0]) == ["2", "4", "5"] for one in levels)
    assert [list(one[:, 1]) for one in levels] == [
        ["1", f"{k == 3:d}", f"{k == 3:d}"] for k in range(5)
    ]
    assert all(one[0, 3] == one[0, 4] == "0" for one in levels)
    assert [one[2, 3] for one in levels] == ["0", "1234", "2469", "2469", "3369"]
    assert [one[2, 4] for one in levels] == ["0", "1234", "2469", "0", "900"]
    assert all(r[-2:] == ["a" * 64, "b" * 64] for r in rows)
    # A clock that went back is late, and adds nothing to the time outside.
    back = monitored.ticks(program, cases, [out, out], [5000, 4000])
    assert back[1][1] == "0" and np.array(back[1][3:-2]).reshape(3, 5)[2, 3] == "0"


MAIN = """
#include <stdio.h>
#include <stddef.h>
#include "monitor.h"

static void brake(const ng_monitor_answer *answer, ng_command *command, void *own)
{
    *(int *)own += 1;
    if (!answer->levels[0].inside) {
        command->torque[0][0] = NG(0.0);
    }
}

int main(void)
{
    ng_config config = ng_config_of(&ng_laws[NG_LAW_PD]);
    ng_state state;
    ng_command command = {0};
    ng_monitor monitor;
    ng_monitor_answer answer;
    int called = 0;
    (void)config;
    ng_start(&state, 0);
    ng_monitor_start(&monitor);
    command.torque[0][0] = NG(7.0);
    ng_monitor_step(&monitor, &state, 5u, &command, &answer);
    printf("%g %s %d\\n", (double)command.torque[0][0], answer.levels[0].name, called);
    monitor.fallback = brake;
    monitor.own = &called;
    ng_monitor_step(&monitor, &state, 1005u, &command, &answer);
    printf("%g %s %d\\n", (double)command.torque[0][0], answer.levels[0].name, called);
    command.fault = NG_FAULT_PITCH;
    ng_monitor_step(&monitor, &state, 2005u, &command, &answer);
    printf("%d %s %d\\n", answer.levels[2].inside, answer.levels[2].name, called);
    return 0;
}
"""


def test_a_fallback_is_called_at_every_tick_and_may_change_the_command(program, tmp_path):
    main, done = tmp_path / "main.c", tmp_path / "main"
    main.write_text(MAIN)
    folder = program.parent
    sources = [str(folder / name) for name in SOURCES]
    command = ["gcc", *build.STRICT, "-I", str(folder), str(main), *sources, "-o", str(done)]
    subprocess.run(command, check=True)
    said = subprocess.run([str(done)], capture_output=True, check=True).stdout.decode().splitlines()
    # At q = 0 the robot does not move, and is not in the tube.
    assert said[0].startswith("7 ") and said[0].endswith(" 0")
    assert said[1].startswith("0 ") and said[1].endswith(" 1")
    assert said[2] == "0 fault 2"


DEFECTS = {
    "a sign": ("margins[i] : -NG_NEVER", "-margins[i] : -NG_NEVER"),
    "ends that always count": ("i >= ends || ", "1 || "),
    "one margin too few": (
        "count = ends + ng_monitor_walls[set]",
        "count = ends + ng_monitor_walls[set] - 1",
    ),
    "the largest": ("margin < found.margin", "margin > found.margin"),
}


@pytest.mark.slow
@pytest.mark.parametrize("defect", DEFECTS)
def test_export_sees_another_answer(made, defect, tmp_path, monkeypatch):
    """However it is compiled."""
    monkeypatch.setattr(build, "PLAIN", ("-O0",))
    old, new = DEFECTS[defect]
    monitored.compiled(tmp_path, made[2])
    text = (tmp_path / "monitor.c").read_text()
    assert text.count(old) == 1
    (tmp_path / "monitor.c").write_text(text.replace(old, new))
    with pytest.raises(MismatchError, match="C and Python disagree"):
        check_monitor(made[2], tmp_path, ["gcc"], 500)


def test_single_precision_answers_alike(made, cases, tmp_path):
    monitor = made[2].monitor
    program = monitored.compiled(tmp_path, made[2], build.PRECISIONS["float"])
    expected = python_answers(monitor, cases)
    found = c_answers(monitor, cases, program)
    assert disagreements(monitor, found, expected, EDGES["float"]) == 0
    assert 0.0 < distance(found, expected) <= 1e-2


# Commands.

NARROW = (CommandSpan("speed", 0.605, 0.615, 0.004),)


@pytest.fixture(scope="module")
def family(tmp_path_factory):
    run = commanded_run.make(tmp_path_factory.mktemp("family") / "run")
    return run, monitored.with_commands(run, NARROW)


def test_commands_that_no_proof_is_about_are_not_admissible(family, tmp_path):
    """Out of the proved range before or after, or farther apart; the set is that of the pair."""
    run, design = family
    monitor, gait = design.monitor, run.trained
    assert isinstance(gait, CommandedGait)
    cases = drawn_cases(design, 512)
    pairs = [(0.61, 0.61), (0.6, 0.604), (0.605, 0.609), (0.605, 0.6091), (0.613, 0.6151)]
    pairs += [(0.61, np.nan)]
    before, after = np.array(pairs).T[..., None]
    asked = np.concatenate([np.repeat(before, 80, 0)[:480], cases.before[:32]])
    then = np.concatenate([np.repeat(after, 80, 0)[:480], cases.after[:32]])
    given = cases._replace(before=asked, after=then)
    program = monitored.compiled(tmp_path, design)
    found, expected = c_answers(monitor, given, program), python_answers(monitor, given)
    np.testing.assert_array_equal(found.admissible, expected.admissible)
    assert [bool(one) for one in found.admissible[:480:80]] == [True, False, True, *[False] * 3]
    # The set, on pairs that it is about.
    found, expected = c_answers(monitor, cases, program), python_answers(monitor, cases)
    assert disagreements(monitor, found, expected, EDGES["double"]) == 0
    policy = gait.policy

    @jax.jit
    def slacks(x, before, after):
        step = gait.of_pair(run.robot, Pair(before, after), exact=True)
        _, z = ZeroDynamics(run.robot, step.policy).phi(x)
        return step.phase(z[0]), step.level(z), z[1]

    x = np.concatenate([cases.q, cases.dq], axis=1)[:40]
    first, last = monitored.WALKING.ends
    for k in range(40):
        phase, level, forward = map(float, slacks(x[k], cases.before[k], cases.after[k]))
        slack = [phase - first, last - phase, forward, level, 1.0 - level]
        if min(map(abs, slack)) > 1e-9:
            assert found.inside[k, 0] == (min(slack) >= 0.0)
    assert policy.commands[0].name == "speed" and found.inside[:40].any()


def test_proved_ranges_may_be_narrower_than_the_gaits():
    chart = Chart.of([replace(commanded_run.SPEED, low=0.605, high=0.615, largest_change=0.004)])
    assert spans(chart, ["speed"]) == NARROW
    assert spans(Chart(), []) == ()


# Proofs.


def copy(tmp_path):
    return open_run(shutil.copytree(SHIPPED, tmp_path / "run"))


def missing(path):
    path.unlink()


def damaged(path):
    path.write_bytes(path.read_bytes()[:1000])


def forged(path):
    """A larger bound than was proved, on the first statement."""
    table = json.loads(path.read_text())
    bounds = table["statements"][0]["bounds"]
    bounds[next(iter(bounds))] *= 1.5
    path.write_text(json.dumps(table))


def wider(path):
    """A set that is longer than its boxes, and a summary that knows the file."""
    table = json.loads(path.read_text())
    table["theorems"][0]["parameters"]["start_strip"] = (0.09).hex()
    path.write_text(json.dumps(table))
    summary = path.with_name("summary.json")
    table = json.loads(summary.read_text())
    table["sha256"]["certificate/proof.json"] = hashlib.sha256(path.read_bytes()).hexdigest()
    summary.write_text(json.dumps(table))


@pytest.mark.parametrize("change", [missing, damaged, forged, wider])
def test_no_claim_without_the_runs_own_proof(change, tmp_path):
    run = copy(tmp_path)
    change(run.path / "certificate" / "proof.json")
    certificate = read_certificate(run.folder)
    (line,) = workflow.unproved_of_export(certificate)
    assert line.startswith("nothing is proved of this gait: certificate/")
    design, more = with_monitor(design_of(run, certificate), run, certificate)
    assert design.monitor is None and more == [] and monitor_files(design) == {}
    assert "monitor     none" in gait_files(design)["gait.h"]


def test_levels_that_are_not_proved_give_no_monitor(tmp_path):
    """Nor do conditions alone; the levels of a part of the commands do."""
    run = copy(tmp_path)
    certificate = read_certificate(run.folder)
    assert certificate.summary is not None and proved_levels(certificate) == (2, 3)
    alone = certificate._replace(summary=replace(certificate.summary, levels=()))
    design, lacking = with_monitor(design_of(run), run, alone)
    assert design.monitor is None
    assert lacking == ["no monitor is written: no level above 1 is proved of this gait"]
    part = ProvedPart(("speed from 0.6 to 0.7",), (), certificate.summary.levels[:1])
    assert proved_levels(alone._replace(part=part)) == (2,)


def test_a_barrier_without_a_form_in_c_leaves_no_monitor_and_a_line(tmp_path, monkeypatch):
    def refuse(*_):
        raise SpecError("cannot write the operation sqrt in C")

    run = copy(tmp_path)
    monkeypatch.setattr(workflow, "monitor_files", refuse)
    design, lacking = with_monitor(design_of(run), run, read_certificate(run.folder))
    assert design.monitor is None
    assert lacking == ["no monitor is written: cannot write the operation sqrt in C"]


@pytest.mark.slow
def test_a_run_that_is_proved_to_level_5_has_all_sets(certified_5, tmp_path):
    """States of the theorem's set are inside, its C agrees, and the hold is that of the proof."""
    run = certified_5
    certificate = read_certificate(run.folder)
    assert certificate.proof is not None
    monitor, theorems = monitor_of(run, certificate), certificate.proof.theorems
    shape = theorems.full
    assert monitor is not None and shape is not None and monitor.levels == (2, 4, 5)
    hold = theorems.parameters[5].hold
    assert monitor.hold_s == hold > 0.0 and monitor.hold_us == int(1e6 * hold)
    model = replace(
        FullOrderModel(run.robot, run.gait, run.spec, shape.bandwidth), weights=shape.weights
    )
    rng = np.random.default_rng(3)
    phase, level = rng.uniform(0.05, 0.95, 500), rng.uniform(0.3, 0.7, 500)
    bound = shape.least_radius + (shape.radius - shape.least_radius) * np.exp(
        -shape.shrink * phase**2
    )
    xi = rng.normal(size=(500, model.size))
    xi *= (bound * rng.uniform(0.9, 1.1, 500) / np.linalg.norm(xi, axis=1))[:, None]

    @jax.jit
    @jax.vmap
    def state(u, xi):
        point = model.point(u, xi)
        return point.q, point.dq, model.barriers(point.z)

    q, dq, h = map(np.asarray, state(np.stack([phase, level], axis=1), xi))
    slack = h - np.array([b.reading**2 / (4.0 * b.sigma) for b in shape.barriers])
    slack -= np.array([b.sigma for b in shape.barriers]) * np.sum(xi**2, axis=1)[:, None]
    within = (np.linalg.norm(xi, axis=1) <= bound) & np.all(slack >= 0.0, axis=1)
    found = monitor.set_of(5).membership(monitor.set_of(5).margins(q=q, dq=dq))
    assert 0.1 < within.mean() < 0.9
    np.testing.assert_array_equal(found.inside, within)
    design = replace(design_of(run, certificate), monitor=monitor)
    monitored.compiled(tmp_path, design)
    (double, single) = check_monitor(design, tmp_path, ["gcc"], 500)
    assert double.distance < single.distance and len(double.set_us) == 2


def test_a_proof_of_another_run_gives_no_monitor(tmp_path):
    run = copy(tmp_path)
    robot = run.path / "robot.xml"
    robot.write_text(robot.read_text() + "\n")
    assert monitor_of(run) is None


@pytest.mark.slow
def test_the_shipped_gait_has_a_monitor_of_level_2(tmp_path, monkeypatch):
    """Its files, its hashes, and no other change of the export than a line of the header."""
    run = copy(tmp_path)
    monkeypatch.setattr(build, "compilers", list)
    done = export_controller(run, tmp_path / "c").summary
    assert done.warnings == () and done["monitor"] == {"levels": [2], "states": 0, "builds": []}
    text = (tmp_path / "c" / "monitor_set.h").read_text()
    design = design_of(run)
    for digest in (design.origin.proof_sha256, design.origin.robot_sha256):
        assert f'_SHA256 "{digest}"' in text
    assert "NG_MONITOR_HOLD_US 0u" in text and "safe" not in text.lower()
    without, with_it = gait_files(design), gait_files(replace(design, monitor=monitor_of(run)))
    assert without["gait.c"] == with_it["gait.c"]
    lines = zip(*(files["gait.h"].splitlines() for files in (without, with_it)), strict=True)
    assert [(a, b) for a, b in lines if a != b] == [
        (" * monitor     none", " * monitor     monitor.h, of the sets of level 2")
    ]


def test_an_export_without_a_proof_has_no_file_of_a_monitor(tmp_path, monkeypatch):
    run = copy(tmp_path)
    shutil.rmtree(run.path / "certificate")
    monkeypatch.setattr(build, "compilers", list)
    done = export_controller(run, tmp_path / "c").summary
    assert "monitor" not in done and not any("monitor" in name for name in done.files)
