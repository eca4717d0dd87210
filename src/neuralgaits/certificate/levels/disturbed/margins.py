"""What level 5 asks of a gait beside level 4: margins that must not be negative.

Forces and torques are affine in e, so the worst e of the ball |S e| <= push takes push times the
length of their slope in S e.
"""

import jax
import jax.numpy as jnp
import numpy as np

from neuralgaits._types import Array, Float
from neuralgaits.certificate.levels.disturbed.theorem import OF_BARRIER, Disturbed, series
from neuralgaits.certificate.levels.full_order.margins import Numbers
from neuralgaits.certificate.levels.full_order.model import FullOrderModel, Outputs, Quantities
from neuralgaits.certificate.levels.full_order.theorem import FullOrder

FORCES = ("contact", "torque")


def margins(
    model: FullOrderModel, full: FullOrder, shape: Disturbed, u: Float[Array, "2"], xi: Outputs
) -> Quantities:
    """All margins of the theorem at one chart point and one xi of the unit ball."""
    its = Numbers.of(full, model.names)
    model = its.model(model)
    parts = {name: jnp.asarray(np.array(values)) for name, values in series(shape).items()}
    rows = parts["barriers"].reshape(-1, len(OF_BARRIER))
    xi = its.bound(u[0]) * xi
    found = _forces(model, u, xi, parts["push"][0])
    centre = model.point(u, jnp.zeros_like(xi))
    rate, h = model.rates(centre), model.barriers(centre.z)
    coupling = jax.jacfwd(lambda moved: model.rates(model.point(u, moved)))(xi)
    for k, name in enumerate(model.names):
        alpha, weight, lost = rows[k]
        spent = weight * (coupling[k] @ coupling[k]) + lost
        found[f"disturbed/decrease {name}"] = rate[k] + alpha * h[k] - spent
    return found


def _forces(
    model: FullOrderModel, u: Float[Array, "2"], xi: Outputs, push: Float[Array, ""]
) -> Quantities:
    """Slacks, less what e may take of them."""

    def slacks(e: Float[Array, " m"]) -> Quantities:
        found = model.in_step(model.point(u, xi, e))
        return {name: found[name] for name in FORCES}

    none = jnp.zeros(model.size // 2)
    found, slopes = slacks(none), jax.jacfwd(slacks)(none)
    return {
        f"disturbed/{name}": found[name]
        - push * jnp.sqrt(jnp.sum(slopes[name] * slopes[name], axis=1))
        for name in FORCES
    }
