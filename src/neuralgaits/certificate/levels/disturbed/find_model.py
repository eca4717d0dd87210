"""Find bounds on the effect of other robots by evaluating points. Nothing here is trusted."""

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from neuralgaits._digits import at_most
from neuralgaits._types import Float
from neuralgaits.certificate.level_target import grid
from neuralgaits.certificate.levels.disturbed.find_state import ABOVE, DIGITS, axes_of_errors
from neuralgaits.certificate.levels.disturbed.model_margins import contact_taken, momentum_drift
from neuralgaits.certificate.levels.disturbed.theorem import DisturbedConstants
from neuralgaits.certificate.levels.full_order.model_errors import Landed, Moves
from neuralgaits.certificate.levels.full_order.model_samples import FED
from neuralgaits.certificate.levels.full_order.samples import SampleEvaluators, Samples, sphere
from neuralgaits.certificate.levels.full_order.share_bounds import largest_shares
from neuralgaits.certificate.levels.full_order.theorem import FullOrderConstants

MOVES, LANDED = Moves._fields, Landed._fields
ROOM, ROOM_OF_ERRORS = 1.04, 1.3
"""Bounds as multiples of the largest values seen."""
ROOMS_OF_SLOPES = 1.25, 1.6, 1.1, 1.8, 1.1
ROOMS_OF_PUSHES = 1.45, 2.2, 1.1, 2.2, 1.1
ROOMS_OF_FEEDS = 1.45, 1.6, 1.1, 1.8, 1.1
ROOMS_OF_IMPACT_SLOPES = 3.3, 11.6, 1.15, 4.4, 1.2
"""Such multiples for each number of a list. Enclosures on 1/800 of the tube are so wide."""


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
    off = np.repeat(np.array(largest_shares(*box)), types)
    axes = _axes(seen, landed, off)
    metric = _metric(evaluators, full)
    seen, landed = _in_metric(seen, metric), _in_metric(landed, metric)

    still, at_rest = _first(seen, len(u)), _first(landed, len(strip))
    slopes = ROOM * np.abs(seen["barriers"]).max(axis=0)
    (fed,) = _bounds(landed, axes, ("impulse/fed",), (ROOM_OF_ERRORS,))
    return {
        "model_box": tuple(map(float, box)),
        "model_axes": tuple(axes.tolist()),
        "model_metric": tuple(float(x) for i, row in enumerate(metric) for x in row[i:]),
        "model_moves": _bounds(still, axes, MOVES, (ROOM,) * 5),
        "model_moves_slope": _bounds(seen, axes, _all(MOVES, "slope"), ROOMS_OF_SLOPES),
        "model_pushes": _bounds(seen, axes, _all(MOVES, "push"), ROOMS_OF_PUSHES),
        "model_feeds": _bounds(seen, axes, _all(FED, "fed"), ROOMS_OF_FEEDS),
        "model_errors": tuple(
            _bound(seen[name], ROOM_OF_ERRORS) for name in ("error", "error/push", "force")
        ),
        "model_slopes": tuple(float(at_most(float(slope), DIGITS)) for slope in slopes),
        "model_curvature": tuple(
            _bound(seen[name], ROOM_OF_ERRORS) for name in ("curvature/mixed", "curvature")
        ),
        "model_impacts": _bounds(at_rest, axes, LANDED, (ROOM,) * 5),
        "model_impacts_slope": _bounds(landed, axes, _all(LANDED, "slope"), ROOMS_OF_IMPACT_SLOPES),
        "model_impulses": (_bound(landed["force"], ROOM_OF_ERRORS), fed),
    }


def _all(names: Sequence[str], kind: str) -> list[str]:
    return [f"{name}/{kind}" for name in names]


def _bounds(
    samples: Samples, axes: np.ndarray, names: Sequence[str], rooms: tuple[float, ...]
) -> tuple[float, ...]:
    """Return bounds on effects of shares in units of their axes, with room for each."""
    found = []
    for name, room in zip(names, rooms, strict=True):
        values = samples[name]
        # Effects on z2 and on the rate of z1 are single numbers: shares come first there.
        place = 1 if name.split("/")[0] in ("momentum", "pace") else 2
        shape = [1] * values.ndim
        shape[place] = len(axes)
        found.append(_bound(values * axes.reshape(shape), room))
    return tuple(found)


def _bound(values: np.ndarray, room: float) -> float:
    """Return the largest Frobenius norm of some arrays, with room."""
    size = np.sqrt((values**2).reshape(len(values), -1).sum(axis=1).max())
    return float(at_most(room * float(size), DIGITS))


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
    """Losses of contact and of barriers' rates to other robots, at n points.

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
        return contact_taken(vars(constants), bound, _peak(constants, bound))[:, None]

    def of_barriers(self, constants: DisturbedConstants, bound: np.ndarray) -> np.ndarray:
        """Return what is taken of barriers' rates, given the bound on sqrt(V). [n, I]."""
        if not constants.of_other_robots:
            return self.barriers
        peak = _peak(constants, bound)
        return self.barriers * momentum_drift(vars(constants), self.momentum, bound, peak)[:, None]


def _peak(constants: DisturbedConstants, bound: np.ndarray) -> np.ndarray:
    return constants.peak[0] + constants.peak[1] * bound


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
