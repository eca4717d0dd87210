"""Margins of level 5 about robots whose links are not the file's; none may be negative.

The argument is in docs/level5_model.md, which names the bounds. Enclosures over all outputs are
wide, so what shares add is bounded where outputs are zero, and its slope in xi apart.
"""

from collections.abc import Mapping
from typing import Any

import jax
import jax.numpy as jnp

from neuralgaits._types import Array, Float, Scalar
from neuralgaits.certificate.levels.disturbed.model_theorem import CONTACT, IMPULSE, MOMENTUM
from neuralgaits.certificate.levels.full_order.model import FullOrderModel, Outputs, Quantities
from neuralgaits.certificate.levels.full_order.model_errors import (
    ShareUnits,
    barrier_slopes,
    feeds,
    impulse_feeds,
    landings,
    moves,
    output_curvature,
)
from neuralgaits.robots.mjcf.link_shares import LinkShares

Lists = Mapping[str, Any]


def model_margins(
    model: FullOrderModel,
    u: Float[Array, "2"],
    xi: Outputs,
    before_impact: Outputs,
    lists: Lists,
) -> Quantities:
    """Return the margins of bounds on the effects of shares, at one chart point.

    Args:
        model: model with the set's norm.
        u: phase and level.
        xi: scaled outputs between impacts [rad]. [2m]
        before_impact: scaled outputs before an impact [rad]. [2m]
        lists: constants of the theorem, by name.
    """
    units, still = _units(model, lists), jnp.zeros_like(xi)
    fed = feeds(model, u, xi, units)
    along = jax.jacfwd(lambda at: moves(model, u, at, units))(xi)
    landed = jax.jacfwd(lambda at: landings(model, u, at, units))(before_impact)
    in_ddq = fed.acceleration, fed.output, fed.momentum, fed.pace, fed.contact
    slopes, of_barriers = lists["model_slopes"], barrier_slopes(model, u)
    # Frobenius norms as squares, which are smooth.
    return {
        "disturbed/model-moves": _room(lists["model_moves"], moves(model, u, still, units)),
        "disturbed/model-moves-slope": _room(lists["model_moves_slope"], along),
        "disturbed/model-pushes": _room(lists["model_pushes"], fed.moves),
        "disturbed/model-feeds": _room(lists["model_feeds"], in_ddq),
        "disturbed/model-errors": _room(
            lists["model_errors"], (fed.error, fed.error_push, fed.force)
        ),
        "disturbed/model-slopes": jnp.concatenate([slopes - of_barriers, slopes + of_barriers]),
        "disturbed/model-curvature": _room(
            lists["model_curvature"], output_curvature(model, u, xi)
        ),
        "disturbed/model-impact": _room(lists["model_impacts"], landings(model, u, still, units)),
        "disturbed/model-impact-slope": _room(lists["model_impacts_slope"], landed),
        "disturbed/model-impulses": _room(
            lists["model_impulses"], impulse_feeds(model, u, before_impact, units)
        ),
    }


def taken_margins(
    model: FullOrderModel,
    u: Float[Array, "2"],
    lists: Lists,
    bound: Scalar,
    peak: Scalar,
    left: Quantities,
) -> Quantities:
    """Return margins of the file's robot less what other robots take of them.

    Args:
        model: model with the set's norm.
        u: phase and level.
        lists: constants of the theorem, by name.
        bound: bound on sqrt(V) at this phase [rad].
        peak: bound on |S e| at this phase [rad/s^2].
        left: margins of the file's robot: "contact", and each barrier's decrease by its name.
    """
    own = moves(model, u, jnp.zeros(model.size), _units(model, lists)).momentum
    drift = momentum_drift(lists, jnp.sqrt(jnp.sum(own * own)), bound, peak)
    margins = {"disturbed/model-contact": left["contact"] - contact_taken(lists, bound, peak)}
    barriers = [name for name in left if name != "contact"]
    for name, slope in zip(barriers, barrier_slopes(model, u), strict=True):
        sides = jnp.stack([left[name] - slope * drift, left[name] + slope * drift])
        margins[f"disturbed/model-decrease {name}"] = sides
    return margins


def _units(model: FullOrderModel, lists: Lists) -> ShareUnits:
    """Return the units of shares. Raises: ValueError for lists that are not of this robot."""
    n, types = model.robot.n, LinkShares.of(model.robot).types
    axes, metric = lists["model_axes"], lists["model_metric"]
    if len(axes) != 5 * types or len(metric) != n * (n + 1) // 2:
        raise ValueError(
            f"{len(axes)} axes of shares of {types} types of link, and a metric of {len(metric)} "
            f"numbers over {n} coordinates"
        )
    return ShareUnits(axes, metric)


def momentum_drift(lists: Lists, still: Any, bound: Any, peak: Any) -> Any:
    """Bound what other robots add to the rate of z2, given that at zero outputs [N m].

    Numbers and arrays alike.
    """
    drift = still + lists["model_moves_slope"][MOMENTUM] * bound
    drift = drift + lists["model_pushes"][MOMENTUM] * peak
    return drift + lists["model_feeds"][MOMENTUM] * lists["model_peaks"][0]


def contact_taken(lists: Lists, bound: Any, peak: Any) -> Any:
    """Bound what other robots take of each slack of contact [body weights].

    Numbers and arrays alike.
    """
    fed = lists["model_feeds"][CONTACT] + lists["model_errors"][2]
    first = lists["model_moves"][CONTACT] + lists["model_moves_slope"][CONTACT] * bound
    return first + lists["model_pushes"][CONTACT] * peak + fed * lists["model_peaks"][0]


def impulse_margin(lists: Lists, impulse: Float[Array, "3"], radius: Scalar) -> Quantities:
    """Return slacks of the impulse on the file's robot less what other robots take [N s]."""
    fed = lists["model_impulses"][0] + lists["model_impulses"][1]
    taken = lists["model_impacts"][IMPULSE] + lists["model_impacts_slope"][IMPULSE] * radius
    return {"disturbed/model-impulse": impulse - taken - fed * lists["model_peaks"][1]}


def _room(bounds: Float[Array, " k"], slopes: tuple[Array, ...]) -> Float[Array, " k"]:
    """Return squared bounds less squared Frobenius norms."""
    return bounds * bounds - jnp.stack([jnp.sum(slope * slope) for slope in slopes])
