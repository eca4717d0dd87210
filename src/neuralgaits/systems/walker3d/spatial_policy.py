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


class SpatialPolicy(eqx.Module):
    """Numbers of the policy. Slopes are per unit of phase.

    Attributes:
        ends: x0 and xG, the stance hip's place when a step starts and ends [m]. [2]
        pitch, height: value at both ends, slopes at start and end, bump [rad], [m]. [4]
        ahead: slopes at start and end, bump [m]; it runs from -xG to -x0. [3]
        lift: slopes at start and end, bump [m]; it is 0 at both ends. [3]
        start, landing: aside at start and end of a step, for (1, invariants) [m]. [4]
        sway: slopes of aside at start and end [m]. [2]
        centre: of the invariants. [3]
        pendulum: whose invariants they are.
    """

    ends: Float[Array, "2"]
    pitch: Float[Array, "4"]
    height: Float[Array, "4"]
    ahead: Float[Array, "3"]
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
        return self._outputs(self.phase(z), self._inputs(z))

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
        within = self._outputs(t - late - early, self._inputs(z))
        settling = REST_PHASES * (1.0 - jnp.exp(-late / REST_PHASES))
        settled = -REST_PHASES * (1.0 - jnp.exp(early / REST_PHASES))
        return Outputs(
            pitch=within.pitch + self.pitch[2] * settling + self.pitch[1] * early,
            height=within.height + self.height[2] * settling + self.height[1] * early,
            ahead=within.ahead + self.ahead[1] * settling + self.ahead[0] * early,
            aside=within.aside + self.sway[1] * settling + self.sway[0] * early,
            lift=(
                within.lift
                + self.lift[0] * settled
                + self.lift[1] * late
                - LATE_DESCENT * (late - settling)
            ),
        )

    def _inputs(self, z: SpatialState) -> Float[Array, "4"]:
        return jnp.append(1.0, (self.pendulum.invariants(z) - self.centre) / INPUT_SCALE)

    def _outputs(self, t: Float[Array, ""], inputs: Float[Array, "4"]) -> Outputs:
        rest = 1.0 - t
        first, last = t * rest * rest, -t * t * rest
        bump, blend = 16.0 * t * t * rest * rest, t * t * (3.0 - 2.0 * t)

        def closed(numbers: Float[Array, "4"]) -> Array:
            value, begin, end, middle = numbers
            return value + begin * first + end * last + middle * bump

        def open_ended(at_start: Array, at_end: Array, numbers: Float[Array, "3"]) -> Array:
            begin, end, middle = numbers
            way = at_start + (at_end - at_start) * blend
            return way + begin * first + end * last + middle * bump

        zero = jnp.zeros_like(t)
        return Outputs(
            pitch=closed(self.pitch),
            height=closed(self.height),
            ahead=open_ended(-self.ends[1], -self.ends[0], self.ahead),
            aside=open_ended(
                self.start @ inputs, self.landing @ inputs, jnp.append(self.sway, 0.0)
            ),
            lift=open_ended(zero, zero, self.lift),
        )


def _positive(x: Float[Array, ""]) -> Float[Array, ""]:
    """Return x where it is positive, else 0, up to 5e-8: exported C has no kinks.

    A sharper bend would make torques at the ends of a step depend on the rounding of x.
    """
    return 0.5 * (x + jnp.sqrt(x * x + 1e-14))
