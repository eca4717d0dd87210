"""Compare the bounds of a proof file with values of its Program at points.

A few hundred evaluations contradict a file whose bounds were made up. This takes a fraction of a
second and proves nothing; only `check` bounds the boxes again.
"""

import itertools

import numpy as np

from neuralgaits._types import Float
from neuralgaits.certificate.chart import Corner, required_boxes
from neuralgaits.certificate.proof_file.reader import FIBRE, Claims, Statement
from neuralgaits.programs import POINT, evaluate
from neuralgaits.programs.prune import prune


def first_broken_bound(claims: Claims) -> str | None:
    """Return a statement that one of the points breaks, as a sentence; None if there is none."""
    roots: dict[tuple[Corner, Corner], list[Statement]] = {}
    for statement in claims.statements:
        roots.setdefault((statement.low, statement.high), []).append(statement)
    for statements in roots.values():
        if broken := _broken_statement(claims, statements):
            return broken
    return None


def _broken_statement(claims: Claims, statements: list[Statement]) -> str | None:
    """Return a broken statement about one root box, in words; None if there is none."""
    program = prune(claims.program, {name for one in statements for name in one.conditions})
    points = _points(statements[0])
    if not len(points):
        return None
    inputs = {"u": points}
    if len(program.inputs) > 1:
        inputs[FIBRE] = _ball_points(len(points), program.inputs[1].shape[0])
    with np.errstate(all="ignore"):
        values = evaluate(program, inputs, POINT)
    # Error of evaluation in doubles allowed, relative to scale or value; gaits' Programs reach
    # 1e-10.
    rounding = 1e-7
    for one in statements:
        for name in one.conditions:
            scale, least = one.scales[name], one.bounds[name] * one.scales[name]
            smallest = values[name].reshape(len(points), -1).min(axis=1)
            slack = rounding * (scale + np.abs(least))
            # A value that is no number breaks a bound, too.
            if (wrong := ~(smallest >= least - slack)).any():
                worst = int(np.argmax(wrong))
                where = [float(f"{x:.6g}") for x in points[worst]]
                return (
                    f"{name} of region {one.region} is {smallest[worst]:.6g} at u = {where}, and "
                    f"at least {least:.6g} is stated"
                )
    return None


def _points(statement: Statement) -> Float[np.ndarray, "points n"]:
    """Return corners, middle and random points of a root box that a statement covers."""
    low, high = np.array(statement.low), np.array(statement.high)
    random = np.random.default_rng(0).random((256, len(low)))
    corners = itertools.islice(itertools.product((0.0, 1.0), repeat=len(low)), 64)
    shares = np.concatenate([np.array(list(corners)), np.full((1, len(low)), 0.5), random])
    # Where two axes have to be near each other, half of the points have the same value of both.
    for near in statement.coupled_axes:
        shares[::2, near.second] = shares[::2, near.first]
    points = np.clip(low + (high - low) * shares, low, high)
    return points[required_boxes(statement.coupled_axes, points, points)]


def _ball_points(count: int, size: int) -> Float[np.ndarray, "points size"]:
    """Return random points of the unit ball, every other one on its surface."""
    draw = np.random.default_rng(1)
    direction = draw.standard_normal((count, size))
    direction /= np.linalg.norm(direction, axis=1, keepdims=True)
    radius = draw.random((count, 1)) ** (1.0 / size)
    radius[::2] = 1.0
    return direction * radius * (1.0 - 1e-12)
