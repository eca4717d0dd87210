"""A million random points in random boxes: every condition lies inside its Taylor bounds.

Boxes lie in the tube and 3 % beyond, with widths from 1e-6 to 0.3 of it. Values come from the
conditions' own Python functions in float64, which share nothing with the Program but its source.

Asked: no value outside, for the default policy, a wide one and a free one.
"""

import jax
import numpy as np
from common import show, trained
from threadpoolctl import threadpool_limits

from neuralgaits.analysis.run import Run
from neuralgaits.certificate.traced import trace_spec
from neuralgaits.programs import evaluate, fold
from neuralgaits.programs.algebras.taylor_algebra import TaylorAlgebra

BOXES, POINTS, BATCH = 5120, 196, 256
"""Random points in a box, beside its four corners."""
BEYOND, WIDTHS = 0.03, (1e-6, 0.3)


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


def main() -> None:
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
        main()
