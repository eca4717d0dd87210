"""Numbers of a cart-pole's file, from which its model is derived."""

from dataclasses import asdict, dataclass

import mujoco
import numpy as np

from neuralgaits.robots.mjcf.model_contents import HINGE, SLIDE
from neuralgaits.systems.cartpole.cartpole_model import CartPole
from neuralgaits.systems.joint_map import JointMap


@dataclass(frozen=True)
class CartPoleData:
    """Numbers of a file, in SI units, from which the model is derived; names of its parts.

    Attributes:
        cart_mass, pole_mass: masses of the bodies, each with what is welded to it.
        distance: distance from the hinge to the pole's centre of mass.
        pole_inertia: about its centre of mass, around the hinge's axis.
        cart_armature, pole_armature, cart_damping, pole_damping: numbers of the joints.
        rail_low, rail_high: range of the slide.
        lean: room for the hinge on either side of the upright.
        force_limit: largest force of the motor on the cart.
        upright: the hinge's angle where the pole is upright.
        turn: 1 where a positive angle leans the pole forward, along the slide's axis; else -1.
        gear: force for each unit of control.
        slide, hinge, motor: names.
    """

    cart_mass: float
    pole_mass: float
    distance: float
    pole_inertia: float
    cart_armature: float
    pole_armature: float
    cart_damping: float
    pole_damping: float
    gravity: float
    rail_low: float
    rail_high: float
    lean: float
    force_limit: float
    upright: float
    turn: float
    gear: float
    slide: str
    hinge: str
    motor: str

    def numbers(self) -> dict[str, float]:
        """Return all fields that are numbers, by name."""
        return {name: x for name, x in asdict(self).items() if isinstance(x, float)}

    def model(self, name: str) -> CartPole:
        """Return the model that these numbers make."""
        return CartPole(
            mass=self.cart_mass + self.pole_mass + self.cart_armature,
            moment=self.pole_mass * self.distance,
            inertia=self.pole_inertia + self.pole_mass * self.distance**2 + self.pole_armature,
            cart_damping=self.cart_damping,
            pole_damping=self.pole_damping,
            gravity=self.gravity,
            rail=0.5 * (self.rail_high - self.rail_low),
            lean=self.lean,
            force_limit=self.force_limit,
            name=name,
        )

    def joint_map(self, model: mujoco.MjModel) -> JointMap:
        """Return where the coordinates x and theta are in a compiled model of the file."""
        joints = [int(np.flatnonzero(model.jnt_type == kind)[0]) for kind in (SLIDE, HINGE)]
        motor = int(np.flatnonzero(model.actuator_trnid[:, 0] == joints[0])[0])
        zeros = (0.5 * (self.rail_low + self.rail_high), self.upright)
        return JointMap((joints[0], joints[1]), zeros, (1.0, self.turn), motor, self.gear)
