"""Running figures of one episode, updated tick by tick inside the compiled loop.

Extremes count for completed steps only: a fall's last, unfinished step is not part of the gait.
The first steps of an episode carry the transients of its start and are left out.
"""

from typing import NamedTuple, TypeVar

import jax
import jax.numpy as jnp

from neuralgaits._types import Actuated, Array, Float, Int, Scalar
from neuralgaits.control import TickResult

_Figures = TypeVar("_Figures")

START_UP_STEPS = 2
"""Steps at the start of an episode that steady figures leave out."""
SETTLING_S = 0.02
"""Time after touchdown that tracking and force figures leave out: the contact settles."""


class Extremes(NamedTuple):
    """Largest and smallest values over some time."""

    output_error: Scalar
    """Largest |q_a - y_d| from SETTLING_S after touchdown [rad]."""
    settled_torque: Scalar
    """Largest |torque| from SETTLING_S after touchdown [N m]."""
    torque: Scalar
    """Largest |torque| at any time [N m]."""
    joint_rate: Scalar
    """Largest |rate| of an actuated joint from SETTLING_S after touchdown [rad/s]."""
    normal_force: Scalar
    """Smallest normal force on the stance foot from SETTLING_S after touchdown [N]."""

    @classmethod
    def none(cls) -> "Extremes":
        """Return the extremes over no time at all."""
        zero = jnp.zeros(())
        return cls(zero, zero, zero, zero, jnp.asarray(jnp.inf))

    def with_(self, other: "Extremes") -> "Extremes":
        """Return the extremes over both times together."""
        largest = jax.tree.map(jnp.maximum, self, other)
        return largest._replace(normal_force=jnp.minimum(self.normal_force, other.normal_force))


class Milestone(NamedTuple):
    """Time, hip position and work of an episode at a touchdown."""

    time: Scalar
    """Time of the touchdown [s]."""
    hip: Scalar
    """Hip position forward at the touchdown [m]."""
    energy: Scalar
    """Mechanical work so far, the integral of sum |torque rate| [J]."""

    @classmethod
    def origin(cls) -> "Milestone":
        """Return the milestone before any touchdown."""
        return cls(jnp.zeros(()), jnp.zeros(()), jnp.zeros(()))


class Gauge(NamedTuple):
    """Running figures of one episode, updated at each tick."""

    steps: Int[Array, ""]
    """Number of touchdowns so far."""
    energy: Scalar
    """Mechanical work of the episode so far [J]."""
    first: Milestone
    """Milestone at the end of the start-up steps."""
    last: Milestone
    """Milestone at the last touchdown."""
    steady: Extremes
    """Extremes over the completed steps after start-up."""
    running: Extremes
    """Extremes over the step under way."""
    peak_torque: Scalar
    """Largest |torque| of the whole episode [N m]."""
    saturated: Int[Array, ""]
    """Number of ticks with a clipped torque."""
    relaxed: Int[Array, "2"]
    """Numbers of ticks at which a law relaxed a constraint, see `LimitedTorque`."""
    ticks: Int[Array, ""]
    """Number of ticks so far."""
    speed_error: Scalar
    """Sum of squares of the errors of an estimated hip speed [m^2/s^2]."""

    @classmethod
    def start(cls) -> "Gauge":
        """Return the figures before the first tick."""
        none, origin = Extremes.none(), Milestone.origin()
        no_ticks, zero = jnp.zeros((), jnp.int32), jnp.zeros(())
        return cls(
            steps=no_ticks,
            energy=zero,
            first=origin,
            last=origin,
            steady=none,
            running=none,
            peak_torque=zero,
            saturated=no_ticks,
            relaxed=jnp.zeros(2, jnp.int32),
            ticks=no_ticks,
            speed_error=zero,
        )


def update(
    gauge: Gauge,
    result: TickResult,
    *,
    time: Scalar,
    hip: Scalar,
    normal_force: Float[Array, "2"],
    period_s: float,
    speed_error: Scalar | float,
) -> Gauge:
    """Add one tick to the figures.

    Args:
        gauge: figures before the tick.
        result: result of the tick.
        time: time of the tick (s).
        hip: hip position forward (m).
        normal_force: normal force on each foot, legs in the order of the robot file [2] (N).
        period_s: length of the tick (s).
        speed_error: error of the hip speed that its torques are based on (m/s).
    """
    down = result.touchdown
    steps = gauge.steps + down
    gauged = down & (gauge.steps >= START_UP_STEPS)
    milestone = Milestone(time, hip, gauge.energy)
    steady = _choose(gauged, gauge.steady.with_(gauge.running), gauge.steady)
    running = _choose(down, Extremes.none(), gauge.running)
    power = jnp.sum(jnp.abs(result.actuated * result.dq[1:]))
    now = _extremes(result, normal_force)
    return Gauge(
        steps=steps,
        energy=gauge.energy + period_s * power,
        first=_choose(down & (steps == START_UP_STEPS), milestone, gauge.first),
        last=_choose(down, milestone, gauge.last),
        steady=steady,
        running=running.with_(now),
        peak_torque=jnp.maximum(gauge.peak_torque, now.torque),
        saturated=gauge.saturated + result.saturated,
        relaxed=gauge.relaxed + result.relaxed,
        ticks=gauge.ticks + 1,
        speed_error=gauge.speed_error + speed_error**2,
    )


def _extremes(result: TickResult, normal_force: Float[Array, "2"]) -> Extremes:
    """Return the extremes of one tick."""
    settled = result.since_touchdown >= SETTLING_S

    def largest(values: Actuated) -> Scalar:
        return jnp.max(jnp.abs(values))

    torque = largest(result.actuated)
    return Extremes(
        output_error=jnp.where(settled, largest(result.q[1:] - result.y_d), 0.0),
        settled_torque=jnp.where(settled, torque, 0.0),
        torque=torque,
        joint_rate=jnp.where(settled, largest(result.dq[1:]), 0.0),
        normal_force=jnp.where(settled, normal_force[result.leg], jnp.inf),
    )


def _choose(which: Array, new: _Figures, old: _Figures) -> _Figures:
    return jax.tree.map(lambda a, b: jnp.where(which, a, b), new, old)
