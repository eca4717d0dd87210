"""Conditions on an ellipsoid of states: what must hold, as margins at one point of its chart.

With the radius r of the ellipsoid's chart, h = 1 - r^2 is the barrier function of its face r = 1.
A margin must not be negative anywhere in its region, see `ellipsoid_regions`.
"""

from collections.abc import Mapping
from typing import NamedTuple, Protocol, runtime_checkable

import equinox as eqx
import jax
import jax.numpy as jnp

from neuralgaits._types import Array, Float
from neuralgaits.systems.equilibrium.ellipsoid import Ball
from neuralgaits.systems.equilibrium.velocity_policy import Controls


class Motion(NamedTuple):
    """Rates of a state under a controller, and the force that they take."""

    rates: Float[Array, "4"]
    force: Float[Array, ""]


@runtime_checkable
class ControlledModel(Protocol):
    """A model with its controller's flow, odd in the state, and its limits."""

    @property
    def name(self) -> str:
        """Name of the robot."""
        ...

    @property
    def force_limit(self) -> float:
        """Largest force of the motor, either way [N]."""
        ...

    def motion(self, controls: Controls, state: Float[Array, "4"]) -> Motion:
        """Return the closed loop's flow at a state."""
        ...

    def limit_shares(self, state: Float[Array, "4"], force: Float[Array, ""]) -> dict[str, Array]:
        """Return the share of each limit that is reached, by the name of its condition."""
        ...


class EllipsoidController(eqx.Module):
    """Controller and set that training finds.

    Attributes:
        controls: the policy, and the decay of the velocity's error.
        ball: the set that the conditions are about.
    """

    controls: Controls
    ball: Ball


def radial_margins(
    robot: ControlledModel,
    controller: EllipsoidController,
    rate: float,
    radius: Float[Array, ""],
    normal: Float[Array, "4"],
) -> Mapping[str, Array]:
    """Return the margins at a radius and a unit vector.

    inward: h' = -2 r r' at r = 1, in 1/s. descent: -r'/r - rate. settling: -dr'/dr - rate; it
    gives descent below its region, because r' is 0 at r = 0. Limits: the share that is left on
    either side.

    Args:
        robot: the model.
        controller: its controller and ellipsoid.
        rate: required decay of the radius [1/s].
        radius: radius of the state.
        normal: direction of the state.
    """
    ball = controller.ball

    def motion_at(distance):
        motion = robot.motion(controller.controls, ball.state(distance, normal))
        return ball.rate(normal, motion.rates), motion.force

    (speed, force), (slope, _) = jax.jvp(motion_at, (radius,), (jnp.ones_like(radius),))
    shares = robot.limit_shares(ball.state(radius, normal), force)
    return {
        "inward": -2.0 * speed,
        "descent": -speed / radius - rate,
        "settling": -slope - rate,
        **{name: jnp.stack([1.0 - share, 1.0 + share]) for name, share in shares.items()},
    }
