"""Evaluations of the effects of other robots, from which bounds on these are found.

Nothing here is trusted.
"""

from collections.abc import Mapping
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from neuralgaits._types import Array
from neuralgaits.certificate.levels.full_order.model import FullOrderModel, Outputs
from neuralgaits.certificate.levels.full_order.model_errors import (
    Chart,
    ShareUnits,
    barrier_slopes,
    feeds,
    impulse_feeds,
    landings,
    moves,
    output_curvature,
)
from neuralgaits.certificate.levels.full_order.share_bounds import largest_shares
from neuralgaits.robots.mjcf.link_shares import LinkShares

FED = "acceleration", "output", "momentum", "pace", "contact"
"""Names of `Feeds` that are slopes in Q ddq."""


class ModelSamples(NamedTuple):
    """Effects of other robots' shares, each as large as allowed, in plain coordinates xi.

    Attributes:
        output, momentum: what they add to the rate of xi [n, 2m, K] and to that of z2 [n, K].
        along: slope in xi of the former. [n, K, 2m, 2m]
        growth: what they add to that of e under held torques. [n, m, K]
        barriers: slope of each barrier in z2. [n, I]
        landed, landed_momentum: what they add in an impact to xi [q, 2m, K] and to z2 [q, K].
    """

    output: np.ndarray
    along: np.ndarray
    momentum: np.ndarray
    growth: np.ndarray
    barriers: np.ndarray
    landed: np.ndarray
    landed_momentum: np.ndarray

    @classmethod
    def of(
        cls,
        seen: Mapping[str, np.ndarray],
        landed: Mapping[str, np.ndarray],
        box: tuple[float, float, float],
    ) -> "ModelSamples":
        """Return the effects of robots of a box, given those of unit shares, outputs zero."""
        off = np.repeat(np.array(largest_shares(*box)), seen["momentum"].shape[1] // 5)
        return cls(
            seen["output"] * off,
            np.moveaxis(seen["output/slope"], 2, 1) * off[:, None, None],
            seen["momentum"] * off,
            seen["growth"] * off,
            seen["barriers"],
            landed["output"] * off,
            landed["momentum"] * off,
        )


def effects_in_norm(samples: Mapping[str, np.ndarray], matrix: np.ndarray) -> dict[str, np.ndarray]:
    """Convert samples of effects from plain coordinates to those of the norm of S."""
    pair, inverse = np.kron(np.eye(2), matrix), np.linalg.inv(matrix)
    rows = {"output": pair, "curvature": pair, "growth": matrix, "error": matrix}
    columns = {"push": inverse, "slope": np.linalg.inv(pair)}
    converted = dict(samples)
    for name in samples:
        first, *_, last = name.split("/") if "/" in name else (name, "")
        if first in rows:
            converted[name] = np.einsum("ij,nj...->ni...", rows[first], converted[name])
        if last in columns:
            converted[name] = converted[name] @ columns[last]
    return converted


def sampled_effects(model: FullOrderModel, u: Chart, xi: Outputs) -> dict[str, Array]:
    """Return moves, feeds and curvature of unit shares by name, slopes of moves in xi, and D."""
    units = _ones(model)
    own, fed = moves(model, u, xi, units), feeds(model, u, xi, units)
    mixed, twice = output_curvature(model, u, xi)
    along = jax.jacfwd(lambda xi: moves(model, u, xi, units))(xi)
    return {
        **own._asdict(),
        **{f"{name}/slope": part for name, part in along._asdict().items()},
        **{f"{name}/push": part for name, part in fed.moves._asdict().items()},
        **{f"{name}/fed": part for name, part in fed._asdict().items() if name in FED},
        "error": fed.error,
        "error/push": fed.error_push,
        "force": fed.force,
        "curvature/mixed": mixed,
        "curvature": twice,
        "barriers": barrier_slopes(model, u),
        "mass": model.robot.mass_matrix(model.point(u, xi).q),
    }


def sampled_impacts(model: FullOrderModel, u: Chart, xi: Outputs) -> dict[str, Array]:
    """Return landings of unit shares by name, their slopes in xi, and feeds of the impulse."""
    units = _ones(model)
    own, (force, fed) = landings(model, u, xi, units), impulse_feeds(model, u, xi, units)
    along = jax.jacfwd(lambda xi: landings(model, u, xi, units))(xi)
    return {
        **own._asdict(),
        **{f"{name}/slope": part for name, part in along._asdict().items()},
        "force": force,
        "impulse/fed": fed,
    }


def _ones(model: FullOrderModel) -> ShareUnits:
    n = model.robot.n
    unit = np.concatenate([np.eye(n)[i, i:] for i in range(n)])
    return ShareUnits(jnp.ones(5 * LinkShares.of(model.robot).types), jnp.asarray(unit))
