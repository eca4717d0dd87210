"""Find bounds on the effect of other robots by evaluating points. Nothing here is trusted."""

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from neuralgaits._digits import at_most
from neuralgaits._types import Float
from neuralgaits.certificate.level_target import grid
from neuralgaits.certificate.levels.disturbed.find_state import ABOVE, DIGITS, axes_of_errors
from neuralgaits.certificate.levels.disturbed.model_margins import contact_taken
from neuralgaits.certificate.levels.disturbed.model_theorem import MODEL_LENGTHS
from neuralgaits.certificate.levels.disturbed.theorem import DisturbedConstants
from neuralgaits.certificate.levels.full_order.samples import SampleEvaluators, Samples, sphere
from neuralgaits.certificate.levels.full_order.theorem import FullOrderConstants
from neuralgaits.robots.mjcf.link_shares import largest_shares

ROOM, ROOM_OF_ERRORS = 1.04, 1.3
"""Bounds as multiples of the largest values seen."""
ROOMS_OF_SLOPES = 1.25, 1.6, 1.1, 1.8, 1.1
ROOMS_OF_PUSHES = 1.45, 2.2, 1.1, 2.2, 1.1
ROOMS_OF_FEEDS = 1.45, 1.6, 1.1, 1.8, 1.1
ROOMS_OF_IMPACT_SLOPES = 3.3, 11.6, 1.15, 4.4, 1.2
"""The same of each number of a list: so wide are enclosures on boxes of 1/800 of the tube."""


def model_bounds(
    evaluators: SampleEvaluators,
    full: FullOrderConstants,
    u: Float[np.ndarray, "k 2"],
    box: tuple[float, float, float] | None,
) -> dict[str, Any]:
    """Return the constants of errors of the model in a set, in its norm, but for their peaks.

    Args:
        evaluators: functions that evaluate the gait, in the set's norm.
        full: the set.
        u: points of the tube. [k, 2]
        box: errors of masses [1], centres of mass [m] and inertias [1]; None for the file's robot.
    """
    if box is None:
        return {}
    assert evaluators.model is not None and evaluators.landed is not None
    strip = grid(np.linspace(full.guard_from, full.ends[1], 3), np.linspace(0.0, 1.0, 9))
    bound = full.least_radius + (full.radius - full.least_radius) * np.exp(
        -full.shrink * u[:, :1] ** 2
    )
    seen = _seen(evaluators.model, u, bound, evaluators.size)
    landed = _seen(evaluators.landed, strip, full.guard_radius, evaluators.size)
    types = seen["momentum"].shape[1] // 5
    off = np.repeat(largest_shares(box), types)
    axes = _axes(seen, landed, off)
    metric = _metric(evaluators, full)
    seen, landed = _in_metric(seen, metric), _in_metric(landed, metric)

    def bound_of(samples: Samples, name: str, room: float, scaled: int | None = None) -> float:
        values = samples[name]
        if scaled is not None:
            shape = [1] * values.ndim
            shape[scaled] = len(axes)
            values = values * axes.reshape(shape)
        size = np.sqrt((values**2).reshape(len(values), -1).sum(axis=1).max())
        return float(at_most(room * float(size), DIGITS))

    moves = {"acceleration": 2, "output": 2, "momentum": 1, "growth": 2, "contact": 2}
    fed = {"acceleration": 2, "output": 2, "momentum": 1, "pace": 1, "contact": 2}
    impacts = {"rates": 2, "output": 2, "momentum": 1, "pace": 1, "impulse": 2}
    still, at_rest = _first(seen, len(u)), _first(landed, len(strip))

    def bounds(
        samples: Samples, kind: str, names: Mapping[str, int], rooms: tuple[float, ...]
    ) -> tuple[float, ...]:
        pairs = zip(names.items(), rooms, strict=True)
        return tuple(bound_of(samples, name + kind, room, k) for (name, k), room in pairs)

    slopes = ROOM * np.abs(seen["barriers"]).max(axis=0)
    return {
        "model_box": tuple(map(float, box)),
        "model_axes": tuple(axes.tolist()),
        "model_metric": tuple(float(x) for i, row in enumerate(metric) for x in row[i:]),
        "model_moves": bounds(still, "", moves, (ROOM,) * 5),
        "model_moves_slope": bounds(seen, "/slope", moves, ROOMS_OF_SLOPES),
        "model_pushes": bounds(seen, "/push", moves, ROOMS_OF_PUSHES),
        "model_feeds": bounds(seen, "/fed", fed, ROOMS_OF_FEEDS),
        "model_errors": tuple(
            bound_of(seen, name, ROOM_OF_ERRORS) for name in ("error", "error/push", "force")
        ),
        "model_slopes": tuple(float(at_most(float(slope), DIGITS)) for slope in slopes),
        "model_curvature": tuple(
            bound_of(seen, name, 1.3) for name in ("curvature/mixed", "curvature")
        ),
        "model_impacts": bounds(at_rest, "", impacts, (ROOM,) * 5),
        "model_impacts_slope": bounds(landed, "/slope", impacts, ROOMS_OF_IMPACT_SLOPES),
        "model_impulses": (
            bound_of(landed, "force", ROOM_OF_ERRORS),
            bound_of(landed, "impulse/fed", ROOM_OF_ERRORS, 2),
        ),
    }


def _first(samples: Samples, count: int) -> Samples:
    """Return the first samples, whose outputs are zero."""
    return {name: values[:count] for name, values in samples.items()}


def _metric(evaluators: SampleEvaluators, full: FullOrderConstants) -> np.ndarray:
    """Return Q with Q'Q = D, the mass matrix in the middle of the step, to few digits. [n, n]."""
    assert evaluators.model is not None
    middle = np.array([[0.5 * sum(full.ends), 0.5]])
    mass = evaluators.model(middle, _none(evaluators))["mass"][0]
    return np.round(np.linalg.cholesky(mass).T, 3)


def _in_metric(samples: Samples, metric: np.ndarray) -> Mapping[str, np.ndarray]:
    """Return samples with accelerations, and rates after an impact, in the metric."""
    unit, converted = np.linalg.inv(metric), dict(samples)
    for name in samples:
        if name.split("/")[0] in ("acceleration", "rates"):
            converted[name] = np.einsum("ij,nj...->ni...", metric, converted[name])
        if name.endswith("/fed") or name in ("error", "force"):
            converted[name] = converted[name] @ unit
    if "error" in samples:
        converted["error/push"] = np.einsum("nija,jk->nika", samples["error/push"], unit)
    return converted


def _seen(evaluator, u: np.ndarray, bound: Any, size: int) -> Mapping[str, np.ndarray]:
    """Return samples at points with outputs zero, and off zero by the bound in two directions."""
    samples = [evaluator(u, np.zeros((len(u), size)))]
    for way in sphere(2, size, 1.0):
        samples += [evaluator(u, bound * np.broadcast_to(way, (len(u), size)))]
    return {name: np.concatenate([part[name] for part in samples]) for name in samples[0]}


def _axes(seen: Samples, landed: Samples, off: np.ndarray) -> np.ndarray:
    """Return half axes of an ellipsoid that holds all shares; 0 where a share is."""
    rows = []
    for lengths in (
        np.linalg.norm(seen["output"], axis=1) * off,
        np.abs(seen["momentum"]) * off,
        np.linalg.norm(landed["output"], axis=1) * off,
    ):
        rows.append(lengths / lengths.sum(axis=1).max())
    given = off > 0.0
    axes = np.zeros_like(off)
    axes[given] = axes_of_errors(np.concatenate(rows)[:, given], off[given])
    return axes


class TakenByModel(NamedTuple):
    """What other robots take of barriers' rates at n points.

    Attributes:
        momentum: what shares add to the rate of z2 where outputs are zero [N m]. [n]
        barriers: size of the slope of each barrier in z2. [n, I]
    """

    momentum: np.ndarray
    barriers: np.ndarray

    def of_contact(self, constants: DisturbedConstants, bound: np.ndarray) -> np.ndarray:
        """Return what is taken of each slack of contact, given the bound on sqrt(V). [n, 1]."""
        if not constants.of_other_robots:
            return 0.0 * bound[:, None]
        lists = {name: np.array(getattr(constants, name)) for name in MODEL_LENGTHS}
        peak = constants.peak[0] + constants.peak[1] * bound
        taken: Any = contact_taken(lists, bound, peak)  # pyright: ignore[reportArgumentType]
        return taken[:, None]

    def of_barriers(self, constants: DisturbedConstants, bound: np.ndarray) -> np.ndarray:
        """Return what is taken of barriers' rates, given the bound on sqrt(V). [n, I]."""
        if not constants.of_other_robots:
            return self.barriers
        peak = constants.peak[0] + constants.peak[1] * bound
        drift = self.momentum + constants.model_moves_slope[2] * bound
        drift = drift + constants.model_pushes[2] * peak
        drift = drift + constants.model_feeds[2] * constants.model_peaks[0]
        return self.barriers * drift[:, None]


def taken_by_model(
    evaluators: SampleEvaluators, u: np.ndarray, model: Mapping[str, Any], barriers: int
) -> TakenByModel:
    """Return what other robots with these constants take of a number of barriers at points."""
    if not model:
        return TakenByModel(np.zeros(len(u)), np.zeros((len(u), barriers)))
    assert evaluators.model is not None
    seen = evaluators.model(u, np.zeros((len(u), evaluators.size)))
    momentum = np.linalg.norm(seen["momentum"] * np.array(model["model_axes"]), axis=1)
    return TakenByModel(momentum, np.abs(seen["barriers"]))


def _none(evaluators: SampleEvaluators) -> np.ndarray:
    return np.zeros((1, evaluators.size))


def with_peaks(acceleration: float, rates: float) -> dict[str, Any]:
    """Return bounds on what shares add to accelerations and, in an impact, to rates."""
    peaks = (float(at_most(ABOVE * value, DIGITS)) for value in (acceleration, rates))
    return {"model_peaks": tuple(peaks)}
