"""Joint PD towards the policy's outputs: the paper's deployment."""

import equinox as eqx
import jax
import jax.numpy as jnp

from neuralgaits._types import Actuated, ZeroState
from neuralgaits.control.law import AbstractLaw, Desired, Outputs, Reading, errors
from neuralgaits.robots import PlanarBiped


class Pd(AbstractLaw):
    """Torque = -stiffness (q_a - y_d) - damping (dq_a - dy_d), without feed-forward.

    Stiff gains hold at 1 kHz because reflected rotor inertia slows the joints.

    Attributes:
        stiffness: per joint [N m/rad].
        damping: per joint [N m s/rad].
        hold_ticks: control ticks between two questions to the policy: 500 Hz at 1 kHz.
        measure_z2: False tells the policy z2 = 0, as the paper's experiments did.
    """

    stiffness: float = eqx.field(default=1500.0, static=True)
    damping: float = eqx.field(default=50.0, static=True)
    hold_ticks: int = eqx.field(default=2, static=True)
    measure_z2: bool = eqx.field(default=True, static=True)

    def told(self, z: ZeroState) -> ZeroState:
        """All of z, or z1 with z2 = 0. Returns: [2]."""
        return z if self.measure_z2 else z * jnp.array([1.0, 0.0])

    def desired(self, robot: PlanarBiped, outputs: Outputs, reading: Reading) -> Desired:
        """Desired outputs and rates at the measured z. Returns: `Desired`."""
        y, dy = jax.jvp(outputs, (reading.z,), (reading.dz,))
        return Desired(y, dy, jnp.zeros_like(y), jnp.zeros_like(y))

    def torque(self, robot: PlanarBiped, reading: Reading, desired: Desired) -> Actuated:
        """Joint torques before saturation. Returns: [m] (N m)."""
        error, rate = errors(reading, desired)
        return -self.stiffness * error - self.damping * rate


PAPER = Pd(stiffness=578.0, damping=16.2, measure_z2=False)
"""The paper's deployment: its gains, and a policy that is told z2 = 0."""
