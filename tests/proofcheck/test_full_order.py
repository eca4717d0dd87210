"""Level 4 by the C++ checker: its premises are what their Python functions compute."""

import json

import numpy as np
import pytest

from support.checker_case import FullCase, bounds

CASES = ("amber3m", "torso-2", "legs-2")
POINTS, BOXES, SAMPLES = 6, 6, 40


def in_the_ball(draw, count: int, size: int) -> np.ndarray:
    """Points of the unit ball, half of them on its surface."""
    found = draw.normal(size=(count, size))
    found /= np.linalg.norm(found, axis=1, keepdims=True)
    return found * np.where(np.arange(count) % 2, draw.uniform(size=count), 1.0)[:, None]


@pytest.mark.parametrize("name", CASES)
def test_values_where_outputs_are_nearly_zero(proofcheck, tmp_path, name):
    """A ball of 1e-7 rad: what is left of its enclosure is slopes that the premises bound."""
    case = FullCase(name)
    file = case.write(tmp_path / "proof.json")
    u = np.random.default_rng(1).uniform((0.0, 0.2), (1.0, 0.8), size=(POINTS, 2))
    found, expected = bounds(proofcheck, file, u, u), case.values(u)
    assert set(found[0]) == set(expected) and len(expected) > 40
    for output, values in expected.items():
        enclosed = np.stack([one[output] for one in found])
        scale = np.maximum(1.0, np.abs(values))
        middle = 0.5 * (enclosed[..., 0] + enclosed[..., 1])
        np.testing.assert_allclose(
            middle / scale, values / scale, atol=1e-5, rtol=0, err_msg=output
        )
        assert np.all(enclosed[..., 1] - enclosed[..., 0] <= 1e-3 * scale), output


@pytest.mark.parametrize("name", CASES)
def test_boxes_contain_their_points_for_all_of_the_ball(proofcheck, tmp_path, name):
    case, draw = FullCase(name, radius=3e-3), np.random.default_rng(2)
    file = case.write(tmp_path / "proof.json")
    size = 0.5 ** draw.uniform(5.0, 9.0, size=(BOXES, 1)) * np.ones(2)
    low = draw.uniform(size=(BOXES, 2)) * (1.0 - size)
    bounded = total = 0
    for box, enclosed in enumerate(bounds(proofcheck, file, low, low + size)):
        u = low[box] + size[box] * draw.uniform(size=(SAMPLES, 2))
        values = case.values(u, in_the_ball(draw, SAMPLES, case.full_model.size))
        for output, ranges in enclosed.items():
            total += 1
            if ranges is None:
                continue
            bounded += 1
            value = values[output]
            slack = 1e-9 * np.maximum(1.0, np.max(np.abs(value)))
            assert np.all(ranges[:, 0] - slack <= value.min(axis=0)), output
            assert np.all(value.max(axis=0) <= ranges[:, 1] + slack), output
    assert bounded > 0.8 * total


def test_both_ways_enclose_the_same(proofcheck, tmp_path):
    """By its own formulas and by the Program in the file, on one box."""
    file = FullCase("amber3m", radius=1e-3).write(tmp_path / "proof.json")
    low = np.array([[0.4, 0.45]])
    (own,), (programs,) = (
        bounds(proofcheck, file, low, low + 0.01, *options) for options in ((), ("--program",))
    )
    assert set(own) == set(programs)
    for output, ranges in own.items():
        other = programs[output]
        assert np.all(ranges[:, 0] <= other[:, 1]) and np.all(other[:, 0] <= ranges[:, 1]), output


def test_a_residual_and_another_size_of_xi_are_rejected(proofcheck, tmp_path):
    case = FullCase("amber3m")
    table = json.loads(json.dumps(case.table))
    zero = {"shape": [2], "values": ["0x0p+0"] * 2}
    layer = {"shape": [2, 2], "values": ["0x0p+0"] * 4}
    arrays = {"scale": zero, "shift": zero, "bound": zero}
    arrays |= {"network.weights[0]": layer, "network.biases[0]": zero}
    table["model"]["residuals"] = {"flow": {"layers": 1, "arrays": arrays}, "reset": None}
    path = tmp_path / "proof.json"
    path.write_text(json.dumps(table))
    answer = proofcheck(path)
    assert answer.returncode == 1 and "residuals" in answer.stdout
