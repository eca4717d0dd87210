"""Specs: what is refused, what is found by name, and what a user may add."""

from dataclasses import replace
from functools import partial
from typing import Any

import jax
import numpy as np
import pytest

from neuralgaits.barriers import Barrier, Box, GaitSpec, Pointwise, specs
from neuralgaits.barriers import functions as f
from neuralgaits.barriers.description import describe_quantity
from neuralgaits.barriers.walking import LANDING, LIFT_OFF
from neuralgaits.errors import InputError, SpecError
from neuralgaits.gait import HybridInvariantPolicy, MLPPolicy
from neuralgaits.gait.commands import Command
from neuralgaits.gait.gaits import Gait
from neuralgaits.robots import load_robot
from neuralgaits.robots.mjcf.loader import robot_from_text
from support.random_biped import random_biped

OWN = """
from neuralgaits.barriers import Pointwise, functions, specs

def stiff(p):
    return functions.hip_height(p) - 0.75

def own(robot):
    return specs.walking(robot).with_conditions(Pointwise("hip", "tube", 0.1, stiff))

def nil(robot):
    specs.walking(robot)

number = 3
"""


def plain(name="extra", region="tube", scale=1.0):
    return Pointwise(name, region, scale, f.hip_height)


@pytest.fixture(scope="module")
def legs():
    return robot_from_text(random_biped(7, 2, torso=False), "legs")


@pytest.mark.parametrize(
    ("condition", "message"),
    [
        (plain("knee"), r"condition names must differ, found \['knee'\].*`.without\(.knee.\)`"),
        (
            plain(region="stance"),
            "condition 'extra': unknown region 'stance'; .* are tube, lift-off",
        ),
        (plain(scale=0.0), "condition 'extra': expected scale > 0, found 0.0"),
        (plain(scale=-1.0), "expected scale > 0"),
        (plain(scale=float("nan")), "expected scale > 0"),
        (plain("set/inertia"), "'set/inertia', which has a slash: .* premises .*; rename it"),
        (plain("hip/high"), "has a slash"),
        (plain("knee\x1b[2J"), r"'knee\\x1b\[2J', which has characters that cannot be printed"),
        (plain("knee\u202e"), "cannot be printed"),
        (plain(""), "which is empty"),
        (plain(" knee"), "begins or ends with a space"),
    ],
)
def test_a_bad_condition_is_refused(spec, condition, message):
    with pytest.raises(SpecError, match=message) as refusal:
        spec.with_conditions(condition)
    assert "\n" not in str(refusal.value)


def test_a_region_without_samples_is_refused(spec):
    regions = {**spec.regions, "middle": (Box((0.4, 0.0), (0.6, 1.0)),)}
    with pytest.raises(SpecError, match=r"recipe.samples has no entry for \['middle'\]"):
        replace(spec, regions=regions, conditions=(plain(region="middle"),))


@pytest.mark.parametrize("robot", [None, "amber3m", 3])
def test_a_spec_is_of_a_robot_and_of_nothing_else(robot, amber):
    made = {
        "walking": (),
        "flat_footed": (),
        "rugged": (),
        "paper": (),
        "paper_walks": (),
        "authors": (),
        "hzd": (5,),
        "at_speed": (0.6,),
        "commanded": ((),),
        "robust": ({"mass": 0.02},),
    }
    makers = [partial(getattr(specs, name), robot, *more) for name, more in made.items()]
    makers += [partial(specs.walking, robot=robot), partial(specs.load, "walking", robot)]
    for make in makers:
        with pytest.raises(InputError, match=f"^robot: expected a PlanarBiped, found {robot!r}: l"):
            make()
    assert specs.walking(robot=amber, policy="mlp").name == "walking-mlp"
    nothing: Any = ()
    with pytest.raises(TypeError, match=r"walking\(\) missing 1 required .*'robot'"):
        specs.walking(*nothing)


def test_a_spec_without_regions_is_told_what_one_is(spec):
    with pytest.raises(SpecError, match=r"at least one region, found none: .*regions=\{.tube.: "):
        replace(spec, regions={}, recipe=replace(spec.recipe, samples={}))


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"overshoot": (0.1,)}, r"overshoot: expected two numbers, .*found \(0\.1,\): give both"),
        ({"overshoot": (0.1, 0.1, 0.1)}, "overshoot: expected two numbers"),
        ({"overshoot": 0.1}, "overshoot: expected two numbers.*found 0.1"),
        ({"overshoot": ("a", True)}, "overshoot: expected two numbers"),
        ({"milestones": 0.5}, "milestones: expected shares .*found 0.5: .*None for a cosine"),
        ({"milestones": (0.1, 40)}, "milestones: expected shares of the steps between 0 and 1"),
        ({"milestones": (0.1, (0.4, 0.8))}, "milestones: expected shares"),
        ({"milestones": (float("nan"),)}, "milestones: expected shares"),
    ],
)
def test_a_recipe_of_odd_lengths_is_refused(spec, changed, message):
    with pytest.raises(SpecError, match=f"^recipe.{message}") as refusal:
        replace(spec.recipe, **changed)
    assert "\n" not in str(refusal.value)


def test_a_recipe_may_have_lists_and_a_rate_that_never_drops(spec):
    recipe = replace(spec.recipe, overshoot=[0, 0.03], milestones=[])
    assert (recipe.overshoot, recipe.milestones) == ([0, 0.03], [])


def test_conditions_come_and_go(spec):
    more = spec.with_conditions(plain())
    assert [c.name for c in more.conditions][-1] == "extra"
    assert more.without("extra") == spec
    with pytest.raises(SpecError, match=r"has no conditions \['extre'\]; did you mean extra\?"):
        more.without("extre")
    with pytest.raises(SpecError, match=r"has no conditions \['lean'\]"):
        spec.without("lean")


@pytest.mark.parametrize("name", specs.BUILT_IN)
def test_built_in_specs_load_by_name(amber, name):
    spec = specs.load(name, load_robot("amber3m-feet") if "flat" in name else amber)
    assert spec.name == name
    assert specs.source_path(name).is_file()


@pytest.mark.parametrize(
    ("name", "message"),
    [
        (
            "runing",
            "expected one of walking, walking-mlp, walking-flat-feet, rugged, paper, "
            "paper-walks, authors, or FILE.py:NAME",
        ),
        ("walkin", "unknown spec 'walkin': did you mean walking. expected one of"),
        (
            "spec.py",
            r"unknown spec 'spec\.py': .*found no name, and no such file: name a file that",
        ),
        ("own.py", r"unknown spec 'own\.py': .* as in own\.py:own$"),
        (
            "two.py",
            r"found no name, and no function of one robot in it: write a function robot -> ",
        ),
        ("missing.py:own", "spec file missing.py: no such file"),
        ("own.py:nothing", "own.py defines no 'nothing'"),
        ("own.py:number", "expected a GaitSpec, found int: name a GaitSpec of own.py, or write a"),
        ("own.py:nil", "a GaitSpec, found NoneType: let nil return one, as in `return specs.walk"),
        ("broken.py:own", r"broken\.py:1: ZeroDivisionError: division by zero"),
        ("typo.py:own", r"typo\.py:1: SyntaxError"),
    ],
)
def test_a_spec_that_is_not_there_is_refused(amber, tmp_path, monkeypatch, name, message):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "own.py").write_text(OWN)
    (tmp_path / "broken.py").write_text("own = 1 / 0\n")
    (tmp_path / "typo.py").write_text("def own(robot:\n")
    (tmp_path / "two.py").write_text("def helper(a, b): ...\ndef other(a, *, b): ...\nn = 3\n")
    with pytest.raises(SpecError, match=message) as refusal:
        specs.load(name, amber)
    assert "\n" not in str(refusal.value)


def test_a_function_that_raises_is_refused(amber, tmp_path):
    path = tmp_path / "own.py"
    path.write_text("def own(robot):\n    return robot.wings\n")
    with pytest.raises(SpecError, match=r"own\.py:2: a PlanarBiped has no 'wings'") as refusal:
        specs.load(f"{path}:own", amber)
    assert "\n" not in str(refusal.value)


def test_a_spec_of_ones_own(amber, gait, zd, tmp_path):
    """With a condition the package does not have; a ready GaitSpec works as well."""
    path = tmp_path / "own.py"
    path.write_text(
        OWN + "\nfrom neuralgaits import load_robot\nready = own(load_robot('amber3m'))\n"
    )

    def both(own):
        point = zd.point(gait.z(np.array([0.5, 0.5])))
        return own.margins(point, gait), f.hip_height(point)

    for attribute in ("own", "ready"):
        spec = specs.load(f"{path}:{attribute}", amber)
        assert isinstance(spec, GaitSpec)
        own = next(c for c in spec.conditions if c.name == "hip")
        margin, height = jax.jit(lambda own=own: both(own))()
        assert float(margin) == pytest.approx(float(height) - 0.75)
    assert specs.source_path(f"{path}:own") == path


@pytest.mark.parametrize("name", ["paper", "paper-walks", "authors"])
def test_specs_for_five_links_say_so(legs, name):
    with pytest.raises(SpecError, match="five links with a torso; 'legs' has 4 links: use --spec"):
        specs.load(name, legs)


def test_rugged_asks_for_more(amber, gait, zd):
    """In mid-step and at the guard: of three conditions more, of the others the same."""
    rugged, plain = specs.rugged(amber), specs.at_speed(amber, 1.06)

    @jax.jit
    @jax.vmap
    def both(u):
        return rugged.margins(gait, zd, u), plain.margins(gait, zd, u)

    more, less = both(np.array([[0.5, 0.5], [1.0, 0.5]]))
    harder = {n for n in less if np.max(np.asarray(less[n]) - np.asarray(more[n])) > 0}
    assert harder == {"foot-clears", "guard-transversal", "tube-width"}
    assert set(more) == set(less)
    with pytest.raises(SpecError, match="found 'rugged'"):
        specs.load("rugged", amber, speed=0.8)


def test_a_foot_that_is_told_heights_is_asked_to_clear_the_edges_of_stairs(amber):
    """A flight has an edge half-way between footholds, half its rise above the line of these."""
    run, rise, clear = 0.35, 0.06, 0.0045
    told = Command("step_height", -0.02, rise)

    def arc_of(spec):
        (asked,) = (c.function for c in spec.conditions if c.name == "foot-clears")
        return describe_quantity(asked)["clearance"]

    arc = arc_of(specs.commanded(amber, (told,)))
    # From one foothold behind the standing foot to one ahead of it, as fast as the hip.
    phase = np.linspace(LIFT_OFF, LANDING, 1001)
    x = run * (2.0 * phase - 1.0)
    for up in (rise, -rise):
        stairs, line = up * np.floor(x / run + 0.5), up * x / run
        assert np.all(line + 4.0 * phase * (1.0 - phase) * arc >= stairs + clear)
    level = arc_of(specs.walking(amber))
    assert level < arc
    for low in (Command("step_length", 0.3, 0.4), Command("step_height", -0.02, 0.02)):
        assert arc_of(specs.commanded(amber, (low,))) == level


def test_an_unknown_policy_is_refused(amber):
    with pytest.raises(SpecError, match="expected policy hybrid-invariant or mlp, found 'bezier'"):
        specs.walking(amber, "bezier")  # pyright: ignore[reportArgumentType]


def test_a_biped_without_a_torso_has_no_torso_conditions(legs, spec):
    names = {c.name for c in specs.walking(legs).conditions}
    assert {c.name for c in spec.conditions} - names >= {"torso-lower", "torso-upper"}


def test_the_free_policy_learns_what_the_other_has(amber, spec):
    """Four more conditions, all else alike."""
    free = specs.walking(amber, "mlp")
    more = [c.name for c in free.conditions][len(spec.conditions) :]
    assert more == ["foot-on-guard", "output-match", "rate-match", "reset-hip"]
    assert free.recipe.posture_steps > 0


def test_random_starts_have_a_network_of_full_size(spec):
    key = jax.random.key(4)
    small, full = (spec.new_gait(key, init, (8,)).policy for init in ("posture", "random"))
    assert isinstance(small, HybridInvariantPolicy) and isinstance(full, HybridInvariantPolicy)
    small, full = small.network, full.network
    np.testing.assert_allclose(full.weights[-1], 10.0 * small.weights[-1], rtol=1e-14)
    np.testing.assert_array_equal(full.weights[0], small.weights[0])


def test_one_condition_more_than_table_1(amber):
    """Of the code, in Table 1's own region."""
    table, walks, code = (specs.load(n, amber) for n in ("paper", "paper-walks", "authors"))
    *same, more = walks.conditions
    assert [c.name for c in same] == [c.name for c in table.conditions]
    assert walks.regions == table.regions and walks.recipe == table.recipe
    (theirs,) = (c for c in code.conditions if c.name == more.name)
    assert replace(theirs, region=more.region) == more
    assert walks.weights == {**table.weights, more.name: code.weights[more.name]}


def test_the_paper_says_what_table_1_says(amber):
    """Bounds and gains, read back from the margins at one point."""
    spec = specs.paper(amber)
    by_name = {c.name: c for c in spec.conditions}
    assert [c.alpha for c in spec.conditions if isinstance(c, Barrier)] == [10, 10, 50, 50, 1, 1]
    assert by_name["symmetry"].absolute_loss and by_name["foot-on-guard"].absolute_loss
    gait = spec.new_gait(jax.random.key(0), "posture", (4,))
    assert isinstance(gait, Gait) and isinstance(gait.policy, MLPPolicy)
    assert gait.policy.network.activation == "relu"
    low, high = (np.asarray(gait.z(np.array([1.0, level]))) for level in (0.0, 1.0))
    for z, energy in ((low, 0.0), (high, 1.0)):  # |z2| = m h sqrt(E + (g / h) z1^2).
        assert z[0] == pytest.approx(0.2)
        speed = np.sqrt(energy + 9.81 / 0.9 * 0.2**2)
        assert z[1] == pytest.approx(float(amber.mass) * 0.9 * speed, rel=1e-12)
    (guard,) = spec.regions["guard"]
    assert float(gait.z(np.array(guard.low))[0]) == pytest.approx(0.19)


@pytest.mark.parametrize("content", [b"\xff\xfe", b"x = 1\x00", b"x = '\xa9'", b"x = ("])
def test_a_file_that_is_no_text_is_named(tmp_path, legs, content):
    file = tmp_path / "mine.py"
    file.write_bytes(content)
    with pytest.raises(SpecError, match=r"mine\.py.*mend it"):
        specs.load(f"{file}:brisk", legs)
