"""The checker's own elementary functions against Arb at 200 bits."""

import numpy as np
import pytest
from flint import arb, ctx

DRAW = np.random.default_rng(3)
SMALL = np.concatenate([[0.0, 1e-300, -1e-17, 0.5, -0.5], DRAW.uniform(-3.0, 3.0, 150)])
WIDE = np.concatenate([SMALL, DRAW.uniform(-40.0, 40.0, 150), [250.0, -250.0, 299.9, 301.0]])
ANGLES = np.concatenate([WIDE, np.arange(-8, 9) * np.pi / 4, [1e4, -1e5, 999999.0]])
POSITIVE = np.concatenate([[1.0, 2.0, 1e-200, 1e200], DRAW.uniform(0.0, 10.0, 100)])

CASES = {
    "exp": (np.concatenate([WIDE, [-690.0, 690.0]]), lambda x: x.exp()),
    "tanh": (WIDE, lambda x: x.tanh()),
    "logistic": (WIDE, lambda x: 1 / (1 + (-x).exp())),
    "softplus": (WIDE, lambda x: (1 + x.exp()).log()),
    "log1p": (DRAW.uniform(0.0, 1.0, 100), lambda x: x.log1p()),
    "sin": (ANGLES, lambda x: x.sin()),
    "cos": (ANGLES, lambda x: x.cos()),
    "sqrt": (POSITIVE, lambda x: x.sqrt()),
    "logit": (DRAW.uniform(0.001, 0.999, 100), lambda x: (x / (1 - x)).log()),
    "arctan": (WIDE, lambda x: x.atan()),
    "inverse": (np.concatenate([POSITIVE, -POSITIVE]), lambda x: 1 / x),
}


@pytest.mark.parametrize("name", CASES)
def test_enclosures_hold_and_are_tight(proofcheck, name):
    points, function = CASES[name]
    answer = proofcheck("--functions", text="".join(f"{name} {float(x).hex()}\n" for x in points))
    assert answer.returncode == 0, answer.stderr
    lines = answer.stdout.split("\n")[:-1]
    assert len(lines) == len(points)
    precision, ctx.prec = ctx.prec, 600
    try:
        for x, line in zip(points, lines, strict=True):
            low, high = (float.fromhex(word) for word in line.split())
            true = function(arb(float(x)))
            assert not (true < arb(low) or true > arb(high)), (name, x)
            # Reducing an argument costs digits in proportion to it.
            reduced = max(1.0, abs(float(x))) if name in ("exp", "sin", "cos") else 1.0
            reduced *= 2.0 if name == "arctan" else 1.0
            assert high - low <= 3e-15 * max(1.0, abs(high)) * reduced, (name, x)
    finally:
        ctx.prec = precision


@pytest.mark.parametrize(
    ("name", "x"),
    [
        ("exp", 701.0),
        ("sqrt", -1.0),
        ("sqrt", 0.0),
        ("inverse", 0.0),
        ("log1p", 2.0),
        ("logit", 1.0),
    ],
)
def test_no_bound_where_there_is_none(proofcheck, name, x):
    answer = proofcheck("--functions", text=f"{name} {x.hex()}\n")
    assert (answer.returncode, answer.stdout.count("\n")) == (3, 1)
    assert answer.stdout.startswith("undecided")
