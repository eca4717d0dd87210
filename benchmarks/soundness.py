"""Random points in random boxes: every output lies inside its bounds, in every arithmetic.

Two parts. The first compares conditions' own Python functions in float64, which share nothing with
the Program but its source, with Taylor models: a million points, for the default policy, a wide one
and a free one. Boxes lie in the tube and 3 % beyond, with widths from 1e-6 to 0.3 of it.

The second takes Programs of all levels from proof files: the search's Taylor models, the same
compiled, and the doubles and balls of `check-proof`, with and without symbols for remainders. A
value in float64 outside a bound counts if balls at the same point are certainly outside, too.

Asked: no value outside. BOXES=N sets the boxes of the second part (balls: a hundredth of them).
Other proof files may be named on the command line, in place of those that are made here.
"""

import shutil
import sys
import time
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any, NamedTuple

import jax
import numpy as np
from common import ROOT, show, trained, whole
from flint import arb
from threadpoolctl import threadpool_limits

import neuralgaits
from neuralgaits.analysis.run import Run
from neuralgaits.certificate.proof_file.reader import Claims, read_claims
from neuralgaits.certificate.traced import trace_spec
from neuralgaits.programs import POINT, Program, evaluate, fold
from neuralgaits.programs.algebras.ball import BallAlgebra
from neuralgaits.programs.algebras.double_algebra import DoubleAlgebra
from neuralgaits.programs.algebras.double_remainders import double_remainders
from neuralgaits.programs.algebras.taylor_algebra import TaylorAlgebra
from neuralgaits.programs.native.bounder import Bounder
from neuralgaits.programs.prune import prune, reading
from neuralgaits.programs.remainder_symbols import Symbols, count_of, numbered, values_with_symbols
from neuralgaits.workflows.certify import certify
from neuralgaits.workflows.check_proof import proof_file_at
from neuralgaits.workflows.train import train

BOXES, POINTS, BATCH = 5120, 196, 256
"""Random points in a box, beside its four corners."""
BEYOND, WIDTHS = 0.03, (1e-6, 0.3)
OF_PROGRAMS, IN_A_BOX, SHARE_OF_BALLS = 100_000, 50, 0.01
"""Boxes of a Program, points in a box, share of the boxes that are bounded in balls."""
HARDEST = 3
"""Statements with most leaves, whose Programs are bounded with symbols for remainders."""

Ranges = Mapping[str, tuple[np.ndarray, np.ndarray]]
"""Bounds below and above on each element, or on the smallest one, of outputs. [elements, B]."""
Bounds = Callable[[np.ndarray, np.ndarray], Ranges]


class Tally(NamedTuple):
    """Values that were looked at, those outside their bounds, and the share of finite bounds."""

    values: int
    outside: int
    finite: float


def random_boxes(draw: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """Centres and half widths, log-uniform in size. [BOXES, 2] each."""
    half = 0.5 * np.exp(draw.uniform(np.log(WIDTHS[0]), np.log(WIDTHS[1]), (BOXES, 2)))
    return draw.uniform(-BEYOND + half, 1.0 + BEYOND - half), half


def outside(run: Run, degree: int, seed: int = 0) -> tuple[int, int, float]:
    """Look at every element of every condition.

    Returns: points looked at, values outside their bounds, share of bounds that are finite.
    """
    program = trace_spec(run.spec, run.robot, run.gait)
    algebra, draw = TaylorAlgebra(degree), np.random.default_rng(seed)
    folded = fold(program, algebra)
    margins = jax.jit(jax.vmap(lambda u: run.spec.margins(run.gait, run.zero_dynamics, u)))
    corners = np.array([[-1, -1], [1, -1], [-1, 1], [1, 1]])
    points, wrong, finite = 0, 0, []
    for centre, half in zip(
        *(np.split(x, BOXES // BATCH) for x in random_boxes(draw)), strict=True
    ):
        with np.errstate(all="ignore"):
            models = evaluate(program, {"u": (centre, half)}, algebra, folded)
        inside = draw.uniform(-1.0, 1.0, (BATCH, POINTS, 2))
        share = np.concatenate([np.broadcast_to(corners, (BATCH, 4, 2)), inside], axis=1)
        u = (centre[:, None] + half[:, None] * share).reshape(-1, 2)
        points += len(u)
        for name, value in margins(u).items():
            values = np.asarray(value).reshape(BATCH, POINTS + 4, -1)
            low, high = (np.broadcast_to(x, (values.shape[2], BATCH)) for x in models[name].range())
            # Without a bound nothing is claimed, and nothing can be wrong.
            known = np.isfinite(low) & np.isfinite(high)
            good = (values >= low.T[:, None]) & (values <= high.T[:, None])
            wrong += int(np.sum(~good & known.T[:, None]))
            finite.append(known.mean())
    return points, wrong, float(np.mean(finite))


def arithmetics(program: Program, symbols: Symbols) -> dict[str, Bounds]:
    """Every arithmetic that bounds a Program; compiled code bounds smallest elements only."""
    box, count = program.inputs[0].name, count_of(program, symbols)
    names = [output.name for output in program.outputs]
    taylor, doubles = TaylorAlgebra(2, count), DoubleAlgebra.of(program, symbols)
    balls = BallAlgebra(2)
    algebras: list[Any] = [taylor, doubles, balls]
    with np.errstate(all="ignore"):
        folded = {algebra: fold(program, algebra) for algebra in algebras}
    compiled = Bounder.of(program, names, folded[taylor], symbols)

    def models(algebra: Any, boxes: Any) -> dict[str, Any]:
        with np.errstate(all="ignore"):
            return evaluate(program, {box: boxes}, algebra, folded[algebra], symbols)

    def of_taylor(low, high):
        centre = low + 0.5 * (high - low)
        half = np.maximum(high - centre, centre - low) * (1.0 + 2.0**-51)
        return {name: one.range() for name, one in models(taylor, (centre, half)).items()}

    def of_doubles(low, high):
        return {name: one.range() for name, one in models(doubles, (low, high)).items()}

    def of_balls(low, high):
        found = {name: one.range() for name, one in models(balls, (low, high)).items()}
        return {
            name: (_ends(ball, "lower", -np.inf), _ends(ball, "upper", np.inf))
            for name, ball in found.items()
        }

    def of_compiled(low, high):
        assert compiled is not None
        lower, upper = compiled.bounds(low, high)
        return {name: (lower[None, :, k], upper[None, :, k]) for k, name in enumerate(names)}

    made: dict[str, Bounds] = {"Taylor": of_taylor, "doubles": of_doubles, "balls": of_balls}
    return made | ({} if compiled is None else {"compiled": of_compiled})


def _ends(balls: np.ndarray, end: str, outward: float) -> np.ndarray:
    """Ends of balls, rounded outwards; NaN where there is no bound."""

    def one(ball: Any) -> float:
        found = float(getattr(ball, end)()) if ball.is_finite() else np.nan
        return float(np.nextafter(found, outward))

    return np.vectorize(one, otypes=[float])(balls)


def boxes_of(claims: Claims, draw: np.random.Generator, count: int):
    """Random boxes of a file's chart and a little beyond, small and large. [count, axes] each."""
    ends = np.array([(axis.low, axis.high) for axis in claims.chart.axes])
    size = ends[:, 1] - ends[:, 0]
    width = np.exp(draw.uniform(np.log(WIDTHS[0]), np.log(WIDTHS[1]), (count, len(size)))) * size
    low = draw.uniform(ends[:, 0] - BEYOND * size, ends[:, 1] + BEYOND * size - width)
    return low, low + width


def look(claims: Claims, program: Program, symbols: Symbols, boxes: int) -> dict[str, Tally]:
    """Compare all arithmetics with values at points."""
    found: dict[str, list[Tally]] = {}
    draw, made = np.random.default_rng(0), arithmetics(program, symbols)
    balls = max(int(boxes * SHARE_OF_BALLS), 1)
    for start in range(0, boxes, BATCH):
        low, high = boxes_of(claims, draw, min(BATCH, boxes - start))
        share = draw.uniform(size=(IN_A_BOX, *low.shape))
        # Some points are corners.
        share[:4] = np.round(share[:4])
        points = np.clip(low + (high - low) * share, low, high)
        inputs = {program.inputs[0].name: points.reshape(-1, low.shape[1])}
        for item in program.inputs[1:]:
            xi = draw.normal(size=(IN_A_BOX * len(low), int(np.prod(item.shape))))
            xi /= np.linalg.norm(xi, axis=1, keepdims=True)
            xi *= draw.uniform(size=(len(xi), 1)) ** 0.1 * (1.0 - 1e-12)
            inputs[item.name] = xi.reshape(len(xi), *item.shape)
        with np.errstate(all="ignore"):
            values = evaluate(program, inputs, POINT)
        for name, bounds in made.items():
            here = min(len(low), balls - start) if name == "balls" else len(low)
            if here > 0:
                ranges = bounds(low[:here], high[:here])
                found.setdefault(name, []).append(_tally(program, inputs, values, ranges, here))
    return {
        name: Tally(
            sum(one.values for one in all_),
            sum(one.outside for one in all_),
            float(np.mean([one.finite for one in all_])),
        )
        for name, all_ in found.items()
    }


def _tally(program: Program, inputs, values, ranges: Ranges, boxes: int) -> Tally:
    """Count the values of one batch that are outside their bounds, which balls confirm."""
    count, wrong, finite = 0, 0, []
    for name, (low, high) in ranges.items():
        rows = values[name].reshape(IN_A_BOX, -1, int(np.prod(values[name].shape[1:])))[:, :boxes]
        if low.shape[0] < rows.shape[2]:
            rows = rows.min(axis=2, keepdims=True)
        low, high = (np.broadcast_to(end, (rows.shape[2], boxes)).T for end in (low, high))
        known = np.isfinite(low) & np.isfinite(high)
        count += rows.size
        finite.append(known.mean())
        for place, box, element in np.argwhere(known & ((rows < low) | (rows > high))):
            point = {
                key: part[place * (len(part) // IN_A_BOX) + box] for key, part in inputs.items()
            }
            wrong += _certainly(
                program, point, name, element, low[box, element], high[box, element]
            )
    return Tally(count, wrong, float(np.mean(finite)))


def _certainly(program: Program, point: Any, name: str, element: int, low: Any, high: Any) -> bool:
    """Whether an output at a point is outside its bounds for sure."""
    if len(program.inputs) > 1 and name in reading(program, program.inputs[1].name):
        return True  # Balls know all of the unit ball only: the value in float64 has to do.
    box, *_ = (item.name for item in program.inputs)
    u = point[box][None]
    models: Any = evaluate(program, {box: (u, u)}, BallAlgebra(1))
    balls = models[name].range()
    if element >= len(balls):
        return True
    ball: Any = balls[element, 0]
    return bool(ball < arb(low)) or bool(ball > arb(high))


def proofs(named: list[str]) -> Iterator[tuple[str, Claims]]:
    """Proof files to look at: those named, or shipped ones and one each of level 5 and a cart."""
    if named:
        yield from ((name, read_claims(proof_file_at(name))) for name in named)
        return
    package = Path(neuralgaits.__file__).parent
    for name in ("demo_run", "demo_speed_run"):
        yield name, read_claims(proof_file_at(package / name))
    fifth = ROOT / "shipped-level-5"
    if not fifth.is_dir():
        shutil.copytree(package / "demo_run", fifth)
        certify(fifth, level=5, bandwidth=50.0)
    yield "level 5", read_claims(proof_file_at(fifth))
    cart = ROOT / "cartpole-0"
    if not (cart / "summary.json").is_file():
        train("cartpole", seed=0, out=cart, root=ROOT)
    if not (cart / "certificate").is_dir():
        certify(cart)
    yield "cart-pole", read_claims(proof_file_at(cart))


def of_programs(named: list[str]) -> None:
    """Print a line for each Program and arithmetic."""
    boxes = whole("BOXES", OF_PROGRAMS)
    for title, claims in proofs(named):
        hard = sorted(claims.statements, key=lambda one: -one.tree.count("-"))[:HARDEST]
        parts: list[tuple[str, Program, Symbols]] = [("all outputs", claims.program, {})]
        for one in hard:
            part = prune(claims.program, one.conditions)
            chosen = values_with_symbols(part, one.low, one.high, double_remainders)
            if chosen:
                label = f"{one.conditions[0]}, symbols"
                parts.append((label, part, numbered(part, chosen)))
        for label, program, symbols in parts:
            start = time.process_time()
            for name, tally in look(claims, program, symbols, boxes).items():
                row = f"outside, {title}, {label}: {name}"
                show(row, f"{tally.outside} of {tally.values}", f"0; {tally.finite:.3f} finite")
            show(f"processor time, {title}, {label}", f"{time.process_time() - start:.0f} s")


def of_policies() -> None:
    """Print one line a policy and degree."""
    runs = {
        "2-32-32-4, hybrid invariant": trained("amber3m", 0),
        "2-256-256-4, hybrid invariant": trained("amber3m", 0, hidden=(256, 256)),
        "2-64-64-4, free": trained("amber3m", 0, "walking-mlp"),
    }
    for name, run in runs.items():
        for degree in (1, 2):
            points, wrong, finite = outside(run, degree)
            found = f"{wrong} of {points} points"
            show(f"outside, {name}, degree {degree}", found, "0")
            show(f"finite bounds, {name}, degree {degree}", f"{100.0 * finite:.2f} %")


if __name__ == "__main__":
    with threadpool_limits(1):
        if not sys.argv[1:]:
            of_policies()
        of_programs(sys.argv[1:])
