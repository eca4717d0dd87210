"""Bounds of Programs in doubles, several boxes and threads at once, against Arb."""

import json
import re

import numpy as np
import pytest
from flint import arb, ctx

from neuralgaits.programs import evaluate
from neuralgaits.programs.algebras.ball import BallAlgebra
from support.checker_case import bounds
from support.program_case import bowl, file_of, halved, random_program

EXACT = 200
"""Bits of values that stand for exact ones."""


@pytest.fixture
def exact():
    """Arb in so many bits that nothing a double can tell is rounded."""
    precision, ctx.prec = ctx.prec, EXACT
    yield
    ctx.prec = precision


def _drawn(draw, axes: int, number: int) -> tuple[np.ndarray, np.ndarray]:
    """Boxes of widths from 1 down to 1e-9, some of them without width along some axes."""
    size = 10.0 ** draw.uniform(-9.0, 0.0, size=(number, 1)) * draw.uniform(
        0.1, 1.0, (number, axes)
    )
    size[::3] *= draw.integers(2, size=(len(size[::3]), axes))
    low = draw.uniform(-1.0, 1.0, size=(number, axes))
    return low, low + size


@pytest.mark.parametrize("axes", [2, 4, 6])
@pytest.mark.parametrize("seed", [11, 12])
def test_no_exact_value_lies_outside(proofcheck, tmp_path, exact, axes, seed):
    """Values at random points and corners, known to 200 bits: no slack is given."""
    draw = np.random.default_rng([axes, seed])
    program, path = random_program(axes, seed), tmp_path / "proof.json"
    path.write_text(json.dumps(file_of(program, {"margin 0": 0.0})))
    low, high = _drawn(draw, axes, 24)
    found = bounds(proofcheck, path, low, high, "--program")
    compared = 0
    for box, enclosed in enumerate(found):
        shares = np.concatenate([draw.uniform(size=(4, axes)), draw.integers(2, size=(4, axes))])
        # Rounding does not lead out of the box: it is monotone, and ends are ends.
        u = np.clip(low[box] + shares * (high[box] - low[box]), low[box], high[box])
        values = evaluate(program, {"u": (u, u)}, BallAlgebra(1))
        for name, ranges in enclosed.items():
            if ranges is None:
                continue
            for (least, most), row in zip(ranges, values[name].constant, strict=True):
                for value in row:
                    compared += 1
                    assert not value < arb(least), (box, name, least, value)
                    assert not value > arb(most), (box, name, most, value)
    assert compared > 24 * 8 * 9 * 4 * 0.7


@pytest.mark.parametrize("axes", [2, 4, 6])
def test_bounds_are_as_narrow_as_those_in_balls(proofcheck, tmp_path, axes):
    """Narrow boxes: what both lose is of third order, and rounding is a few of the last digits."""
    draw = np.random.default_rng(axes)
    program, path = random_program(axes, 5), tmp_path / "proof.json"
    path.write_text(json.dumps(file_of(program, {"margin 0": 0.0})))
    low = draw.uniform(-0.5, 0.5, size=(12, axes))
    high = low + 10.0 ** draw.uniform(-6.0, -2.0, size=(12, 1))
    found = bounds(proofcheck, path, low, high, "--program")
    balls = evaluate(program, {"u": (low, high)}, BallAlgebra(2))
    compared = 0
    for name, model in balls.items():
        for box, row in enumerate(model.range().T):
            ranges = found[box][name]
            if ranges is None:
                continue
            for (least, most), value in zip(ranges, row, strict=True):
                compared += 1
                width = 2.0 * float(value.rad())
                assert most - least <= 1.03 * width + 1e-12 * (1.0 + abs(most)), (box, name)
    assert compared > 12 * 9 * 4 * 0.7


def _without_times(text: str) -> str:
    return re.sub(r"[0-9.]+ s\b", "s", text)


@pytest.mark.parametrize(
    ("least", "depth", "bound", "expected"),
    [(0.1, 0.0, 0.09, 0), (0.1, 0.0, 0.1000001, 1), (0.1, 1e3, 0.05, None)],
    ids=["true", "false", "dented"],
)
def test_answers_do_not_depend_on_threads(proofcheck, tmp_path, least, depth, bound, expected):
    path = tmp_path / "proof.json"
    path.write_text(json.dumps(file_of(bowl(4, least, depth), {"margin": bound}, halved(4, 12))))
    answers = [proofcheck("--program", *more, path) for more in ((), (), ("--one-thread",))]
    codes, texts = {a.returncode for a in answers}, {_without_times(a.stdout) for a in answers}
    assert len(codes) == len(texts) == 1, texts
    assert codes == {expected} if expected is not None else codes <= {1, 3}
