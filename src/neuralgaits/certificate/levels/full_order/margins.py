"""Margins of the full-order theorem (level 4); none may be negative.

The second argument of a margin is xi: outputs and rates in units in which sqrt(V) is |xi| times the
set's bound at that phase. So the set's states are xi of the unit ball, over every box of u.
`theorem` says which margin belongs to which root box.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from neuralgaits._types import Array, Float, Scalar
from neuralgaits.certificate.levels.full_order.model import (
    FullOrderModel,
    Outputs,
    Quantities,
    Weights,
)
from neuralgaits.certificate.levels.full_order.theorem import (
    BARRIER_CONSTANTS,
    FENCES,
    FullOrderConstants,
    constants_of_set,
    series,
)
from neuralgaits.gait.full_order import FullPoint


def margins(
    model: FullOrderModel, constants: FullOrderConstants, u: Float[Array, "2"], xi: Outputs
) -> Quantities:
    """Return all margins of the theorem at one chart point and one xi of the unit ball."""
    arrays = TheoremArrays.of(constants, model.names)
    xi, model = xi[: model.size], arrays.model(model)
    bound = arrays.bound(u[0])
    return (
        _step_margins(model, arrays, model.point(u, bound * xi))
        | _decay_margins(model, arrays, u, bound * xi)
        | _guard_margins(model, arrays, u, arrays.set["guard_radius"] * xi)
        | _crossing_margins(model, arrays, u)
    )


class TheoremArrays(NamedTuple):
    """Constants of the theorem as elements of arrays, so that a Program names each of them."""

    set: Mapping[str, Scalar]
    barriers: Mapping[str, Mapping[str, Scalar]]
    """Constants of each barrier, by its name."""
    weights: Weights

    @classmethod
    def of(cls, constants: FullOrderConstants, names: Sequence[str]) -> "TheoremArrays":
        """Return the numbers of a set whose barriers have these names, those of the model."""
        parts = {name: jnp.asarray(np.array(values)) for name, values in series(constants).items()}
        rows = parts["barriers"].reshape(-1, len(BARRIER_CONSTANTS))
        return cls(
            dict(zip(constants_of_set(constants), parts["set"], strict=True)),
            {
                name: dict(zip(BARRIER_CONSTANTS, row, strict=True))
                for name, row in zip(names, rows, strict=True)
            },
            parts.get("weights", ()),
        )

    def model(self, model: FullOrderModel) -> FullOrderModel:
        """Return the model with this set's bandwidth and norm."""
        return replace(model, bandwidth=self.set["bandwidth"], weights=self.weights)

    def bound(self, phase: Scalar) -> Scalar:
        """Bound sqrt(V) in the set at a phase [rad]."""
        shrunk = jnp.exp(-self.set["shrink"] * phase * phase)
        if "floor" not in self.set:
            return self.set["radius"] * shrunk
        return self.set["floor"] + (self.set["radius"] - self.set["floor"]) * shrunk


def _step_margins(model: FullOrderModel, arrays: TheoremArrays, point: FullPoint) -> Quantities:
    """Return margins between impacts: the robot walks on within its contact and torque limits."""
    quantities = model.in_step(point)
    least, most = arrays.set["slowest"], arrays.set["fastest"]
    # a <= dphi/dt <= b, and -J.s >= d.
    return {
        "full/pace": jnp.concatenate([quantities["pace"] - least, most - quantities["pace"]]),
        "full/inertia": quantities["inertia"] - arrays.set["inertia"],
        "full/contact": quantities["contact"],
        "full/torque": quantities["torque"],
        "full/foot-rises": quantities["foot-rate"],
        "full/foot-above": quantities["foot"],
    }


def _decay_margins(
    model: FullOrderModel, arrays: TheoremArrays, u: Float[Array, "2"], xi: Outputs
) -> Quantities:
    """Return margins between impacts that keep h - t - sigma V from becoming negative."""
    centre = model.point(u, jnp.zeros_like(xi))
    rate, h = model.rates(centre), model.barriers(centre.z)
    coupling = jax.jacfwd(lambda moved: model.rates(model.point(u, moved)))(xi)
    reading = jax.jacfwd(lambda moved: model.readings(model.point(u, moved)))(xi)
    margins_by_name = {}
    for k, (name, barrier) in enumerate(arrays.barriers.items()):
        slope = reading[k]
        # dh/dt + alpha h >= epsilon at xi = 0; |d(dh/dt)/d xi| <= c and |dh/d xi| <= l as squares.
        margins_by_name[f"full/rate {name}"] = (
            rate[k] + barrier["alpha"] * h[k] - barrier["epsilon"]
        )
        margins_by_name[f"full/coupling {name}"] = (
            barrier["coupling"] ** 2 - coupling[k] @ coupling[k]
        )
        if name not in FENCES:
            margins_by_name[f"full/reading {name}"] = barrier["reading"] ** 2 - slope @ slope
    return margins_by_name


def _guard_margins(
    model: FullOrderModel, arrays: TheoremArrays, u: Float[Array, "2"], xi: Outputs
) -> Quantities:
    """Return margins in the guard's strip: one crossing, and bounds on an impact's effect."""
    point = model.point(u, xi)
    impact, slopes = model.at_impact(point), model.guard_slopes(u, xi)
    along = {name: jnp.sum(d * d, axis=1) for name, d in slopes.along.items()}
    margins_by_name = {
        "full/foot-below": -point.foot[1],
        "full/foot-falls": -point.foot_velocity[1],
        "full/impulse": impact["impulse"],
        "full/momentum-after": impact["momentum"],
        "full/guard-slope": -slopes.fall,
        # |d xi+/d xi| <= L_D and |d phi+/d xi| <= L_z along the guard, as squares.
        "full/gain": arrays.set["gain"] ** 2 - jnp.sum(along["after"]),
        "full/landing-slope": arrays.set["landing_slope"] ** 2 - along["landing"],
    }
    for k, (name, barrier) in enumerate(arrays.barriers.items()):
        # |dh(z+)/d xi| <= L_i along the guard, as squares.
        margins_by_name[f"full/reset-slope {name}"] = (
            barrier["reset_slope"] ** 2 - along["reset"][k]
        )
    return margins_by_name


def _crossing_margins(
    model: FullOrderModel, arrays: TheoremArrays, u: Float[Array, "2"]
) -> Quantities:
    """Return margins of the state after an impact from eta = 0."""
    impact, drift = model.at_crossing(u)
    landing, after = impact["landing"], impact["after"]
    margins_by_name = {
        # |xi+| <= v, |d xi+/d phi| <= v' and |phi+| <= f.
        "full/mismatch": arrays.set["mismatch"] ** 2 - after @ after,
        "full/drift": arrays.set["drift"] ** 2 - drift @ drift,
        "full/landing": jnp.concatenate(
            [arrays.set["landing"] - landing, arrays.set["landing"] + landing]
        ),
        "full/crossing-before": impact["foot"],
        "full/crossing-behind": -impact["foot"],
    }
    for k, (name, barrier) in enumerate(arrays.barriers.items()):
        # h_i(z+) >= h_i+.
        margins_by_name[f"full/reset {name}"] = impact["reset"][k] - barrier["reset"]
    return margins_by_name
