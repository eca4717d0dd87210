"""The policy: from the state of the zero dynamics to the outputs, without a network.

Phase is the stance hip's way t = (x - x0) / (xG - x0) over the step. Torso, hip height and swing
foot follow cubics of t with a bump. Where the foot lands aside depends on three numbers that do not
change along the flow of a linear inverted pendulum, so it is a prediction rather than a chase. The
swing foot meets the ground at t = 1 exactly, and a touchdown there leads to t = 0 exactly, whatever
the lateral state.
"""

import equinox as eqx
import jax.numpy as jnp
import numpy as np

from neuralgaits._types import Array, Float
from neuralgaits.systems.walker3d.spatial_dynamics import SpatialState
from neuralgaits.systems.walker3d.spatial_pose import Outputs

INPUT_SCALE = np.array([0.08, 0.003, 0.016])
"""Sizes of the three invariants about their centre [m^2/s^2, m^2, m^2]."""
REST_PHASES = 0.04
"""Share of a step in which slopes of the outputs die out by 1/e, where the floor is late, and that
of the foot's height where it was early."""
LATE_DESCENT = 0.3
"""How much faster the swing foot goes down then, per unit of phase [m]."""


class Pendulum(eqx.Module):
    """The linear inverted pendulum whose invariants the policy is told.

    Attributes:
        mass: of the robot [kg].
        height: of its centre of mass above the stance foot [m].
        gravity: acceleration of gravity.
        half_width: from the stance hip to the middle of the hips [m].
    """

    mass: float
    height: float
    gravity: float
    half_width: float

    @property
    def rate(self) -> float:
        """Rate of falling [1/s]."""
        return float(np.sqrt(self.gravity / self.height))

    def invariants(self, z: SpatialState) -> Float[Array, "3"]:
        """Return three functions that are constant along the pendulum's flow."""
        x, y, forward, aside = z
        impulse = self.mass * self.height
        velocity = forward / impulse
        ahead, across = velocity / self.rate, aside / (impulse * self.rate)
        middle, growing, falling = y + self.half_width, ahead + x, ahead - x
        energy = velocity * velocity - (self.rate * x) * (self.rate * x)
        # What grows aside times what falls ahead, and the reverse: products have no poles.
        return jnp.stack([energy, (middle + across) * falling, (middle - across) * growing])


class StepNumbers(eqx.Module):
    """Numbers of steps that follow each other at one speed. Slopes are per unit of phase.

    Attributes:
        ends: x0 and xG, the stance hip's place when a step starts and ends [m]. [2]
        pitch, height: value at both ends, slopes at start and end, bump [rad], [m]. [4]
        ahead: slopes at start and end, bump [m]; it runs from -xG to -x0. [3]
        lift: slopes at start and end, bump [m]; it is 0 at both ends. [3]
        start, landing: aside at start and end of a step, for (1, invariants) [m]. [4]
        sway: slopes of aside at start and end [m]. [2]
    """

    ends: Float[Array, "2"]
    pitch: Float[Array, "4"]
    height: Float[Array, "4"]
    ahead: Float[Array, "3"]
    lift: Float[Array, "3"]
    start: Float[Array, "4"]
    landing: Float[Array, "4"]
    sway: Float[Array, "2"]

    @property
    def bumps(self) -> Float[Array, "4"]:
        """Bumps of pitch, height, ahead and lift."""
        return jnp.stack([self.pitch[3], self.height[3], self.ahead[2], self.lift[2]])


class SpatialPolicy(eqx.Module):
    """The policy of one step. Slopes are per unit of phase.

    Attributes:
        ends: x0 and xG, the stance hip's place when the step starts and ends [m]. [2]
        pitch, height, ahead: values at start and end, slopes there, bump [rad], [m], [m]. [5]
        lift: slopes at start and end, bump [m]; it is 0 at both ends. [3]
        start, landing: aside at start and end of the step, for (1, invariants) [m]. [4]
        sway: slopes of aside at start and end [m]. [2]
        centre: of the invariants. [3]
        pendulum: whose invariants they are.
    """

    ends: Float[Array, "2"]
    pitch: Float[Array, "5"]
    height: Float[Array, "5"]
    ahead: Float[Array, "5"]
    lift: Float[Array, "3"]
    start: Float[Array, "4"]
    landing: Float[Array, "4"]
    sway: Float[Array, "2"]
    centre: Float[Array, "3"]
    pendulum: Pendulum

    def phase(self, z: SpatialState) -> Float[Array, ""]:
        """Return the share of the step that is done."""
        return (z[0] - self.ends[0]) / (self.ends[1] - self.ends[0])

    def __call__(self, z: SpatialState) -> Outputs:
        """Return the outputs of a state."""
        return self._outputs(self.phase(z), self.inputs(z))

    def beyond(self, z: SpatialState) -> Outputs:
        """Return the outputs of a state, and where the floor is late those that go on to meet it.

        Within a step they are those of the gait. After its end torso, hips and the swing foot's
        place under its hip come to rest, so that the next step starts about where it should: a foot
        that was drawn back on and on would start it late, with less of the way on which the robot
        slows down. The foot goes down faster; cubics and bumps would take it up again. Before a
        step's start, after a touchdown on a floor that came early, the foot's height comes to rest
        likewise, a millimetre or two lower. All slopes are continuous: torques are accelerations.
        """
        t = self.phase(z)
        late, early = _positive(t - 1.0), -_positive(-t)
        within = self._outputs(t - late - early, self.inputs(z))
        settling = REST_PHASES * (1.0 - jnp.exp(-late / REST_PHASES))
        settled = -REST_PHASES * (1.0 - jnp.exp(early / REST_PHASES))
        return Outputs(
            pitch=within.pitch + self.pitch[3] * settling + self.pitch[2] * early,
            height=within.height + self.height[3] * settling + self.height[2] * early,
            ahead=within.ahead + self.ahead[3] * settling + self.ahead[2] * early,
            aside=within.aside + self.sway[1] * settling + self.sway[0] * early,
            lift=(
                within.lift
                + self.lift[0] * settled
                + self.lift[1] * late
                - LATE_DESCENT * (late - settling)
            ),
        )

    def inputs(self, z: SpatialState) -> Float[Array, "4"]:
        """Return 1 and the invariants, about their centre and in their sizes."""
        return jnp.append(1.0, (self.pendulum.invariants(z) - self.centre) / INPUT_SCALE)

    def _outputs(self, t: Float[Array, ""], inputs: Float[Array, "4"]) -> Outputs:
        rest = 1.0 - t
        first, last = t * rest * rest, -t * t * rest
        bump, blend = 16.0 * t * t * rest * rest, t * t * (3.0 - 2.0 * t)

        def path(at_start: Array, at_end: Array, numbers: Float[Array, "3"]) -> Array:
            begin, end, middle = numbers
            way = at_start + (at_end - at_start) * blend
            return way + begin * first + end * last + middle * bump

        zero = jnp.zeros_like(t)
        return Outputs(
            pitch=path(self.pitch[0], self.pitch[1], self.pitch[2:]),
            height=path(self.height[0], self.height[1], self.height[2:]),
            ahead=path(self.ahead[0], self.ahead[1], self.ahead[2:]),
            aside=path(self.start @ inputs, self.landing @ inputs, jnp.append(self.sway, 0.0)),
            lift=path(zero, zero, self.lift),
        )


def step_between(
    first: StepNumbers,
    last: StepNumbers,
    bumps: Float[Array, "4"],
    centre: Float[Array, "3"],
    pendulum: Pendulum,
) -> SpatialPolicy:
    """Return the policy of a step that begins as steps at one speed do and ends as at another.

    Where it begins and ends, and its slopes there, are those of the two speeds, so that each step
    begins where the touchdown before it led to, whatever speed comes next.

    Args:
        first: numbers of the speed that the step before was told.
        last: numbers of the speed that this step is told.
        bumps: see `StepNumbers.bumps`.
        centre: of the invariants.
        pendulum: whose invariants they are.
    """
    pitch, height, ahead, lift = bumps

    def closed(begin: Array, end: Array, bump: Array) -> Array:
        """Join numbers of two speeds that each have one value for both ends."""
        return jnp.stack([begin[0], end[0], begin[1], end[2], bump])

    return SpatialPolicy(
        ends=jnp.stack([first.ends[0], last.ends[1]]),
        pitch=closed(first.pitch, last.pitch, pitch),
        height=closed(first.height, last.height, height),
        ahead=jnp.stack([-first.ends[1], -last.ends[0], first.ahead[0], last.ahead[1], ahead]),
        lift=jnp.stack([first.lift[0], last.lift[1], lift]),
        start=first.start,
        landing=last.landing,
        sway=jnp.stack([first.sway[0], last.sway[1]]),
        centre=centre,
        pendulum=pendulum,
    )


def _positive(x: Float[Array, ""]) -> Float[Array, ""]:
    """Return x where it is positive, else 0, up to 5e-8: exported C has no kinks.

    A sharper bend would make torques at the ends of a step depend on the rounding of x.
    """
    return 0.5 * (x + jnp.sqrt(x * x + 1e-14))
