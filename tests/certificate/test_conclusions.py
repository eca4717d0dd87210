"""The closing arithmetic of levels 2 and 3, and what happens without a premise."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.polynomial.chebyshev import chebval
from scipy.integrate import quad

from neuralgaits.certificate.levels.levels import conclude
from neuralgaits.certificate.levels.orbit.conclude import attraction
from neuralgaits.certificate.levels.orbit.theorem import OrbitConstants, orbit_premises
from neuralgaits.certificate.levels.walking_set.conclude import walking
from neuralgaits.certificate.levels.walking_set.theorem import (
    WalkingSetConstants,
    safe_premises,
    strips,
    walking_premises,
)
from neuralgaits.certificate.proof_file.theorem_tables import Theorems

SHAPE = WalkingSetConstants(
    1e-3, 2e-3, 0.1, 0.8, (0.0, 0.0), ("torso",), ("torso", "force", "foot")
)
ORBIT = OrbitConstants(
    attraction="contraction",
    guard_from=0.9985,
    guard_to=1.001,
    lower=(90.0, 10.0),
    upper=(91.0, 10.0),
    expansion=(0.05, -0.3, 0.02),
    slowest=(-0.1, -0.3, 0.01),
    fastest=(0.0, -0.3, 0.03),
)
BOXES = [
    ("torso", (0.0, 0.0), (1.0, 1.0)),
    ("force", (0.2, 0.0), (1.0, 1.0)),
    ("foot", (1.0, 0.0), (1.0, 1.0)),
    ("width", (0.0, 0.0), (1.0, 0.0)),
]
SETS = [*walking_premises(SHAPE), *safe_premises(SHAPE), *orbit_premises(SHAPE, ORBIT)]
CONSTANTS = {
    "set/reset-phase": -5e-4,
    "orbit/gain": -0.8,
    "orbit/width": -0.2,
    "orbit/reset-gain-low": 0.7,
    "orbit/reset-gain-high": -0.75,
}
BOUNDS = (
    {(output, low, high): CONSTANTS.get(output, 0.25) for output, low, high, _ in SETS}
    | {box: 0.0 for box in BOXES}
    | {box: 0.0 for box in strips(SHAPE, BOXES)}
)


def test_strips_of_the_carried_conditions():
    assert sorted(strips(SHAPE, BOXES)) == [
        ("foot", (1.0 - 2e-3, 0.0), (1.0 + 2e-3, 1.0)),
        ("force", (1.0, 0.0), (1.0 + 2e-3, 1.0)),
        ("torso", (-1e-3, 0.0), (0.0, 1.0)),
        ("torso", (1.0, 0.0), (1.0 + 2e-3, 1.0)),
    ]
    start = ("foot", (0.0, 0.2), (0.0, 1.0))
    assert list(strips(SHAPE, [start])) == [("foot", (-1e-3, 0.2), (1e-3, 1.0))]


@pytest.mark.parametrize("name", ["force", "torso", "flies"])
def test_what_is_carried_along_has_statements(name):
    boxes = [box for box in BOXES if box[0] != name]
    shape = replace(SHAPE, carried=(*SHAPE.carried, name))
    answer = walking(shape, boxes, BOUNDS)
    assert (answer.verdict, answer.reason) == ("undecided", f"there is no statement about {name}")


def test_with_all_premises_both_levels_follow():
    second, third = conclude({2: SHAPE, 3: ORBIT}, BOXES, BOUNDS)
    assert (second.verdict, third.verdict) == ("proved", "proved")
    assert second.figures["step_time_at_most_s"] == pytest.approx(1.003 / 0.25)
    assert any("width" in line for line in second.words if "regions only" in line)


@pytest.mark.parametrize("key", sorted(BOUNDS), ids=str)
def test_no_premise_is_idle(key):
    for worse in (None, -5.0, float("nan")):
        bounds = {k: v for k, v in BOUNDS.items() if k != key}
        if worse is not None:
            bounds[key] = worse
        answers = conclude({2: SHAPE, 3: ORBIT}, BOXES, bounds)
        if key[0].startswith("set/value"):
            # Without it T is only as large as where the barrier functions are not negative.
            assert all(answer.verdict == "proved" for answer in answers)
            assert "not negative" in answers[0].words[0]
        elif key[0] == "orbit/width" and worse == -5.0:
            assert answers[1].figures["z2_width_at_most"] == 5.0  # It is a figure, no more.
        else:
            assert "undecided" in {answer.verdict for answer in answers}


@pytest.mark.parametrize("output", ["set/forward", "set/fence-lower", "set/reset-level"])
def test_a_margin_of_zero_is_not_inside(output):
    bounds = {k: 0.0 if k[0] == output else v for k, v in BOUNDS.items()}
    assert walking(SHAPE, BOXES, bounds).verdict == "undecided"


@pytest.mark.parametrize(
    "change",
    [
        {"start_strip": 0.2},
        {"start_strip": -1e-3},
        {"guard_strip": 0.0},
        {"risen": 0.85},
        {"falling": 0.9985},
    ],
)
def test_sets_of_another_shape_are_not_accepted(change):
    shape = replace(SHAPE, **change)
    premises = [*walking_premises(shape), *safe_premises(shape)]
    bounds = {(output, low, high): CONSTANTS.get(output, 0.25) for output, low, high, _ in premises}
    bounds |= {box: 0.0 for box in BOXES} | {box: 0.0 for box in strips(shape, BOXES)}
    assert walking(shape, BOXES, bounds).verdict == "undecided"


def test_figures_of_the_orbit_against_quadrature():
    found = attraction(SHAPE, ORBIT, BOUNDS).figures

    def integral(series):
        return quad(lambda phase: chebval(2.0 * phase - 1.0, series), 0.0, 1.0)[0]

    exact = 0.8 * np.exp(integral(ORBIT.expansion))
    assert exact * (1.0 - 1e-12) <= found["contraction_at_most"] <= exact * np.exp(3e-3 * 2.0)
    low, high = (
        g * np.exp(integral(s))
        for g, s in zip((0.7, 0.75), (ORBIT.slowest, ORBIT.fastest), strict=True)
    )
    assert low * np.exp(-3e-3 * 2.0) <= found["multiplier_at_least"] <= low * (1.0 + 1e-12)
    assert high * (1.0 - 1e-12) <= found["multiplier_at_most"] <= high * np.exp(3e-3 * 2.0)
    assert found["z2_at_mid_step_at_least"] == pytest.approx(np.sqrt(2 * 90.0))
    assert found["z2_at_mid_step_at_least"] <= np.sqrt(2 * 90.0)


def test_contraction_alone_needs_no_thin_tube():
    alone = OrbitConstants("contraction alone", expansion=ORBIT.expansion)
    needed = {(output, low, high) for output, low, high, _ in orbit_premises(SHAPE, alone)}
    assert {output for output, *_ in needed} == {"orbit/expansion", "orbit/gain"}
    thin = {key for key in BOUNDS if key[0].startswith("orbit/")} - needed
    bounds = {key: bound for key, bound in BOUNDS.items() if key not in thin}
    found = conclude({2: SHAPE, 3: alone}, BOXES, bounds)[1]
    whole = attraction(SHAPE, ORBIT, BOUNDS).figures["contraction_at_most"]
    assert found.verdict == "proved" and "multiplier_at_most" not in found.figures
    # Series of the thin tube enlarge what the strips may add.
    assert whole * np.exp(-3e-3) <= found.figures["contraction_at_most"] <= whole
    for key in needed:
        for worse in (None, -1.5, float("nan")):
            less = {k: v for k, v in bounds.items() if k != key}
            less |= {} if worse is None else {key: worse}
            assert conclude({2: SHAPE, 3: alone}, BOXES, less)[1].verdict == "undecided"
    # Series of a tube that nothing is proved of, or none at all.
    for wrong in (replace(alone, lower=(1.0,)), replace(alone, expansion=())):
        assert attraction(SHAPE, wrong, bounds).verdict == "undecided"
    told = replace(SHAPE, told=("speed",))
    assert attraction(told, alone, bounds).verdict == "undecided"


def test_a_floor_asks_how_far_the_foot_is_from_the_line():
    alone = OrbitConstants("contraction alone", expansion=ORBIT.expansion)
    for floor, verdict in ((0.24, "proved"), (0.25, "undecided"), (-0.1, "undecided")):
        shape = replace(SHAPE, floor=floor)
        second, third = conclude({2: shape, 3: alone}, BOXES, BOUNDS)
        assert (second.verdict, third.verdict) == (verdict, verdict)
    second, third = conclude({2: replace(SHAPE, floor=0.24), 3: alone}, BOXES, BOUNDS)
    assert "each foothold up to 0.24 m higher or lower than meant" in second.words[1]
    assert "footholds lie equally high" in third.words[0]
    for low, high in (((0.1, 0.0), (0.8, 1.0)), ((0.998, 0.0), (0.998, 1.0))):
        less = BOUNDS | {("set/foot-above", low, high): 0.2}
        assert conclude({2: replace(SHAPE, floor=0.24)}, BOXES, less)[0].verdict == "undecided"
    # One orbit is that of a floor as meant.
    assert attraction(replace(SHAPE, floor=0.1), ORBIT, BOUNDS).verdict == "undecided"


def test_a_thin_tube_that_is_upside_down_has_no_width():
    orbit = replace(ORBIT, lower=ORBIT.upper, upper=ORBIT.lower)
    assert attraction(SHAPE, orbit, BOUNDS).reason == "the thin tube is upside down"


@pytest.mark.parametrize(
    "change",
    [{"gain": -1.05}, {"fastest": (0.4,)}, {"reset-gain-low": -0.1}, {"expansion": (0.3,)}],
)
def test_without_contraction_nothing_is_concluded(change):
    ((name, value),) = change.items()
    if isinstance(value, tuple):
        orbit, bounds = replace(ORBIT, **change), BOUNDS
    else:
        changed = {k: value for k in BOUNDS if k[0] == f"orbit/{name}"}
        orbit, bounds = ORBIT, {**BOUNDS, **changed}
    answer = attraction(SHAPE, orbit, bounds)
    assert answer.verdict == "undecided"
    assert answer.reason


def test_theorems_survive_the_file_and_nothing_else_is_read():
    theorems = Theorems.of(SHAPE, ORBIT, claimed=(2, 3))
    assert Theorems.read(theorems.tables()) == theorems
    assert Theorems.read(Theorems.of(SHAPE).tables()) == Theorems.of(SHAPE)
    second, third = theorems.tables()
    broken = [
        [third],
        [second, second],
        [second | {"level": True}],
        [second | {"claimed": 1}],
        [{**second, "parameters": {}}],
        [{**second, "parameters": second["parameters"] | {"more": "0x1p0"}}],
        [{**second, "parameters": second["parameters"] | {"risen": "inf"}}],
        [{**second, "parameters": second["parameters"] | {"risen": 0.1}}],
        [{**second, "parameters": second["parameters"] | {"disturbance": ["0x1p0"]}}],
        ["level 2"],
    ]
    for tables in broken:
        with pytest.raises(ValueError, match=r"."):
            Theorems.read(tables)


def nested(**changes):
    orbit = replace(ORBIT, attraction="nested tubes", **changes)
    bounds = {(o, low, high): CONSTANTS.get(o, 0.25) for o, low, high, _ in SETS}
    for output, low, high, _ in orbit_premises(SHAPE, orbit):
        bounds[output, low, high] = CONSTANTS.get(output, 0.25)
    return orbit, bounds


def test_nested_tubes_attract_although_the_return_map_is_not_shown_to_contract():
    orbit, bounds = nested(expansion=(0.5,))
    found = attraction(SHAPE, orbit, bounds)
    assert found.verdict == "proved"
    # Gain of the reset times the ratio of the thin tube's widths before and after it.
    before, after = (
        chebval(2.0 * phase - 1.0, ORBIT.upper) - chebval(2.0 * phase - 1.0, ORBIT.lower)
        for phase in (1.0 - SHAPE.guard_strip, SHAPE.start_strip)
    )
    shrink = found.figures["tubes_shrink_by_at_most"]
    assert 0.8 * before / after <= shrink <= 0.8 * before / after * np.exp(2 * 3e-3 * 0.5 * 1.01)
    assert attraction(SHAPE, replace(orbit, attraction="contraction"), bounds).verdict != "proved"


@pytest.mark.parametrize("output", ["orbit/nested-above", "orbit/nested-below", "orbit/gain"])
def test_nested_tubes_need_every_premise(output):
    orbit, bounds = nested()
    kept = {key: value for key, value in bounds.items() if key[0] != output}
    assert attraction(SHAPE, orbit, kept).verdict == "undecided"
    zero = {key: 0.0 if key[0] == output else value for key, value in bounds.items()}
    expected = "proved" if output == "orbit/gain" else "undecided"
    assert attraction(SHAPE, orbit, zero).verdict == expected


def test_tubes_that_widen_at_the_impact_attract_nothing():
    orbit, bounds = nested(upper=(0.92, 0.11), lower=(0.9, 0.1))
    assert attraction(SHAPE, orbit, bounds).verdict == "undecided"
