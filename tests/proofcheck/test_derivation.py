"""What the checker derives from link data is what the conditions' Python functions compute.

The two share no formula: positions, momenta and forces there are sums over links, derivatives
are forward duals over the box's polynomials.
"""

import itertools

import numpy as np
import pytest

from neuralgaits.barriers.commanded_spec import commands_of
from support.checker_case import Case, SetCase, ToldCase, bounds

CASES = {
    "amber3m": Case("amber3m"),
    "torso": Case("torso-2", "softplus"),
    "legs": Case("legs-3"),
    "learned": Case("amber3m", learned=True),
    "feet": Case("amber3m-feet"),
    "learned feet": Case("amber3m-feet", learned=True),
    "learned sets": SetCase("torso-2", learned=True, disturbance=(0.02, 0.3)),
    "speed": ToldCase("amber3m", commands=commands_of(speed=(0.55, 0.9))),
    "footholds": ToldCase(
        "amber3m",
        "softplus",
        commands=commands_of(step_length=(0.3, 0.33), step_height=(-0.01, 0.01)),
    ),
    "slope": ToldCase("rabbit", commands=commands_of(slope=(-0.08, 0.08))),
    "belief": ToldCase("amber3m", commands=commands_of(lean=(-0.01, 0.01))),
    "sets": SetCase("legs-2", disturbance=(0.02, 0.3), attraction="nested tubes"),
}
TIGHT = {"legs": 1e-6, "learned": 1e-8, "speed": 1e-4, "footholds": 1e-3, "slope": 1e-4}
TIGHT |= {"feet": 1e-8, "learned feet": 1e-6, "belief": 1e-4}
"""Width of an enclosure at a point; 1e-9 elsewhere. Elimination in six unknowns costs digits, and
so do models with coefficients in doubles, which add to each operation what rounding may do."""
POINTS, BOXES, SAMPLES = 12, 12, 40


@pytest.fixture(scope="module", params=CASES)
def case(request):
    return CASES[request.param]


@pytest.fixture
def tight(request):
    return TIGHT.get(request.node.callspec.params["case"], 1e-9)


@pytest.fixture(scope="module")
def file(case, tmp_path_factory):
    return case.write(tmp_path_factory.mktemp("case") / "proof.json")


def test_values_at_points(proofcheck, case, file, tight):
    u = case.drawn(np.random.default_rng(1).uniform(size=(POINTS, case.chart.size)))
    found = bounds(proofcheck, file, u, u)
    expected = case.values(u)
    assert set(found[0]) == set(expected) >= {c.name for c in case.spec.conditions}
    for name, values in expected.items():
        enclosed = np.stack([one[name] for one in found])
        scale = np.maximum(1.0, np.abs(values))
        assert np.all(enclosed[..., 1] - enclosed[..., 0] <= tight * scale), name
        middle = 0.5 * (enclosed[..., 0] + enclosed[..., 1])
        np.testing.assert_allclose(middle / scale, values / scale, atol=1e-9, rtol=0, err_msg=name)


def test_boxes_contain_their_points(proofcheck, case, file):
    draw = np.random.default_rng(2)
    axes = case.chart.size
    size = 0.5 ** draw.uniform(2.0, 9.0, size=(BOXES, 1)) * np.ones(axes)
    low = draw.uniform(size=(BOXES, axes)) * (1.0 - size)
    found = bounds(proofcheck, file, case.drawn(low), case.drawn(low + size))
    bounded = 0
    for box, enclosed in enumerate(found):
        corners = np.array(list(itertools.product((0, 1), repeat=axes)))
        inside = np.concatenate([corners, draw.uniform(size=(SAMPLES, axes))])
        values = case.values(case.drawn(low[box] + size[box] * inside))
        for name, ranges in enclosed.items():
            if ranges is None:
                continue
            bounded += 1
            slack = 1e-9 * np.maximum(1.0, np.max(np.abs(values[name])))
            assert np.all(values[name] >= ranges[:, 0] - slack), name
            assert np.all(values[name] <= ranges[:, 1] + slack), name
    assert bounded > 0.7 * BOXES * len(found[0])


def test_bounds_are_of_second_order(proofcheck, case, file, tight):
    """What bounds exceed the values by shrinks with the square of the box's size or faster."""
    more = case.chart.size - 2
    centre, sizes, excess = np.array([[0.45, 0.55, *[0.4] * more]]), (0.01, 0.0025), []
    lines = np.linspace(-0.5, 0.5, 15 if not more else 5 if more == 2 else 3)
    grid = np.stack(np.meshgrid(*[lines] * (2 + more)), axis=-1).reshape(-1, 2 + more)
    for size in sizes:
        low, high = case.drawn(centre - size / 2), case.drawn(centre + size / 2)
        (found,) = bounds(proofcheck, file, low, high)
        values = case.values(case.drawn(centre + size * grid))
        excess.append(
            {name: np.max(values[name].min(axis=0) - found[name][:, 0]) for name in values}
        )
    for name, wide in excess[0].items():
        # A quarter of the size: 16 times less or, where a margin is monotone, 64.
        assert excess[1][name] <= wide / 15.0 + tight, name
