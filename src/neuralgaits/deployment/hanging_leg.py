"""Inverse dynamics of a leg that hangs from a torso at rest, with its foot in the air.

Torques are linear in the masses of the links, so each link has a column of its own: a fit may then
scale them. Source: virtual work of each link; angles as in `BipedConstants`.
"""

from dataclasses import dataclass

import numpy as np

from neuralgaits._types import Float
from neuralgaits.robots.derive import LegData
from neuralgaits.robots.layout import MjcfLayout
from neuralgaits.robots.mjcf.loader import links_from_text


@dataclass(frozen=True, eq=False)
class HangingLeg:
    """A leg below a torso that is held.

    Attributes:
        leg: its links, lowest first, a flat foot included.
        gravity: [m/s^2].
    """

    leg: LegData
    gravity: float

    @classmethod
    def of(cls, layout: MjcfLayout, name: str, gravity: float) -> "HangingLeg":
        """Return either leg of a robot file; both are equal. Gravity is in m/s^2."""
        leg, _ = links_from_text(layout.xml, name)
        return cls(leg, gravity)

    def torques(
        self,
        torso: Float[np.ndarray, " t"],
        q: Float[np.ndarray, "t k"],
        dq: Float[np.ndarray, "t k"],
        ddq: Float[np.ndarray, "t k"],
    ) -> tuple[Float[np.ndarray, "t k"], Float[np.ndarray, "t k k"]]:
        """Return the torques that a motion of the joints takes.

        Args:
            torso: up-angle of the torso, which moves slowly [rad]. [t]
            q: joints in the theory's signs, lowest first [rad]. [t, k]
            dq: their rates [rad/s]. [t, k]
            ddq: their accelerations [rad/s^2]. [t, k]

        Returns: of rotors and viscous friction [t, k], and of each link [t, k joints, k links]
            (N m).
        """
        k = q.shape[1]
        # A joint is the angle of the upper link minus that of the lower one, so every link turns
        # by -1 with each joint above it.
        above = np.tri(k)
        theta, dtheta, ddtheta = torso[:, None] - q @ above, -dq @ above, -ddq @ above
        line = 1j * np.exp(1j * theta)
        bend = (1j * ddtheta - dtheta**2) * line
        pivots, centres, motion = (np.zeros((len(q), k), dtype=complex) for _ in range(3))
        place, pull = np.zeros(len(q), complex), np.zeros(len(q), complex)
        for b in reversed(range(k)):
            pivots[:, b] = place
            place = place - self.leg.length[b] * line[:, b]
            pull = pull - self.leg.length[b] * bend[:, b]
            centres[:, b] = place + self.leg.com[b] * line[:, b]
            motion[:, b] = pull + self.leg.com[b] * bend[:, b]
        links = np.zeros((len(q), k, k))
        for b in range(k):
            force = self.leg.mass[b] * (motion[:, b] + 1j * self.gravity)
            for j in range(b, k):
                arm = -1j * (centres[:, b] - pivots[:, j])
                links[:, j, b] = (force * arm.conj()).real - self.leg.inertia[b] * ddtheta[:, b]
        return self.leg.armature * ddq + self.leg.damping * dq, links
