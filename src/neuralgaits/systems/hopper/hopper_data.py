"""Numbers of a hopper's file, from which its model is derived."""

from dataclasses import asdict, dataclass

from neuralgaits.systems.hopper.hopper_model import Hopper


@dataclass(frozen=True)
class HopperData:
    """Numbers of a file, in SI units; numbers of its joints and motors.

    Attributes:
        upper_mass, upper_offset, upper_inertia, wheel_inertia: see `Hopper`.
        foot_mass, foot_offset, foot_inertia, gravity: see `Hopper`.
        shortest, longest, force_limit, torque_limit, friction: see `Hopper`.
        zero_length: length of the leg where its joint is at 0.
        foot_radius: of the sphere.
        force_gear, torque_gear: force and torque for each unit of control.
        joints: numbers of root x, root z, lean, wheel and leg.
        motors: numbers of the wheel's motor and the leg's.
        foot: number of the sphere.
    """

    upper_mass: float
    upper_offset: float
    upper_inertia: float
    wheel_inertia: float
    foot_mass: float
    foot_offset: float
    foot_inertia: float
    gravity: float
    shortest: float
    longest: float
    force_limit: float
    torque_limit: float
    friction: float
    zero_length: float
    foot_radius: float
    force_gear: float
    torque_gear: float
    joints: tuple[int, ...]
    motors: tuple[int, int]
    foot: int

    def numbers(self) -> dict[str, float]:
        """Return all fields that are numbers, by name."""
        return {name: x for name, x in asdict(self).items() if isinstance(x, float)}

    def model(self, name: str) -> Hopper:
        """Return the model that these numbers make."""
        kept = [one for one in Hopper.__dataclass_fields__ if one != "name"]
        return Hopper(**{one: getattr(self, one) for one in kept}, name=name)
