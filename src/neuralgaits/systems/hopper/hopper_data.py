"""Numbers of a hopper's file: its model, and where joints, motors and foot are in the file."""

from dataclasses import asdict, dataclass

from neuralgaits.systems.hopper.hopper_model import Hopper


@dataclass(frozen=True)
class HopperData:
    """A file's model in SI units, and numbers of its joints and motors.

    Attributes:
        robot: the model.
        zero_length: length of the leg where its joint is at 0.
        foot_radius: radius of the foot's sphere.
        force_gear, torque_gear: force and torque for each unit of control.
        joints: numbers of root x, root z, lean, wheel and leg.
        motors: numbers of the wheel's motor and the leg's.
        foot: number of the sphere.
    """

    robot: Hopper
    zero_length: float
    foot_radius: float
    force_gear: float
    torque_gear: float
    joints: tuple[int, ...]
    motors: tuple[int, int]
    foot: int

    def numbers(self) -> dict[str, float]:
        """Return all fields that are numbers, the model's among them, by name."""
        fields = asdict(self.robot) | asdict(self)
        return {name: x for name, x in fields.items() if isinstance(x, float)}
