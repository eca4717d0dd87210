"""One step of the zero dynamics: the flow from t = 0 to t = 1, and the touchdown there."""

from typing import NamedTuple

import jax
import jax.numpy as jnp

from neuralgaits._quick_jit import quick_jit
from neuralgaits._types import Array, Float
from neuralgaits.systems.walker3d.spatial_dynamics import Flow, SpatialState, flow
from neuralgaits.systems.walker3d.spatial_impact import reset
from neuralgaits.systems.walker3d.spatial_policy import SpatialPolicy
from neuralgaits.systems.walker3d.spatial_walker import SpatialWalker

PHASES = 24
"""Steps of the integration (fourth-order Runge-Kutta) from one touchdown to the next."""


class SpatialStep(NamedTuple):
    """A step of the zero dynamics.

    Attributes:
        states: states at equal distances of phase, the start first. [PHASES + 1, 4]
        duration: [s].
        landed: state after the touchdown. [4]
        last: flow just before it.
    """

    states: Float[Array, "phases 4"]
    duration: Float[Array, ""]
    landed: SpatialState
    last: Flow


def step_from(robot: SpatialWalker, policy: SpatialPolicy, start: Float[Array, "3"]) -> SpatialStep:
    """Return the step that starts with (y, L_y, n) where the stance hip is at x0."""
    begin, end = policy.ends
    length = end - begin

    def slope(t: Array, state: Float[Array, "4"]) -> Float[Array, "4"]:
        """Return the rates of (y, L_y, n, time) by phase."""
        z = jnp.append(begin + length * t, state[:3])
        rates = flow(robot, policy, z).rates
        return jnp.append(rates[1:], 1.0) * length / rates[0]

    def advance(state: Array, count: Array) -> tuple[Array, Array]:
        t, width = count / PHASES, 1.0 / PHASES

        def stage(carry: tuple[Array, Array], row: Array) -> tuple[tuple[Array, Array], None]:
            rate, total = carry
            ahead, weight = row
            rate = slope(t + ahead * width, state + ahead * width * rate)
            return (rate, total + weight * rate), None

        # One compiled flow serves all four stages.
        table = jnp.array([[0.0, 1.0], [0.5, 2.0], [0.5, 2.0], [1.0, 1.0]]) / jnp.array(
            [[1.0, 6.0]]
        )
        (_, mean), _ = jax.lax.scan(stage, (jnp.zeros(4), jnp.zeros(4)), table)
        following = state + width * mean
        return following, following

    first = jnp.append(start, 0.0)
    last, rows = jax.lax.scan(advance, first, jnp.arange(float(PHASES)))
    rows = jnp.concatenate([first[None], rows])
    way = begin + length * jnp.linspace(0.0, 1.0, PHASES + 1)
    states = jnp.concatenate([way[:, None], rows[:, :3]], axis=1)
    now = flow(robot, policy, states[-1])
    return SpatialStep(states, last[3], reset(robot, now.pose, now.links, now.motion), now)


def step_of_orbit(robot: SpatialWalker, policy: SpatialPolicy, start: Float[Array, "3"]) -> float:
    """Return the duration of a step [s]."""
    duration = quick_jit(lambda one: step_from(robot, policy, one).duration)
    return float(duration(jnp.asarray(start)))
