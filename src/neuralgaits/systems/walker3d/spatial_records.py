"""Records of bipeds in three dimensions: robot file, configuration, training."""

from dataclasses import dataclass
from typing import Annotated, Literal

from neuralgaits.errors import InputError
from neuralgaits.gait.commands import Command
from neuralgaits.records.record import Record
from neuralgaits.runs.shape import POSITIVE, list_of, may
from neuralgaits.settings.forms import Interval
from neuralgaits.systems.family_run import FamilyConfig, TrainedSummary
from neuralgaits.systems.walker3d.spatial_levels import SPEED


@dataclass(frozen=True, eq=False)
class SpatialFacts(Record):
    """A robot file. Units are in the names.

    Attributes:
        thigh_m, shin_m: lengths of the links.
        hip_width_m: between the hips.
        torque_limits_nm: limits of hip roll, hip pitch and knee.
        unactuated: degrees of freedom without a motor, on a point foot.
    """

    robot: str
    mass_kg: float
    torso_kg: float
    thigh_kg: float
    shin_kg: float
    thigh_m: float
    shin_m: float
    hip_width_m: float
    armature_kg_m2: tuple[float, float, float]
    torque_limits_nm: tuple[float, float, float]
    gravity_m_s2: float
    friction: float
    unactuated: int


@dataclass(frozen=True, eq=False, kw_only=True)
class SpatialConfig(FamilyConfig):
    """Configuration of a training.

    Attributes:
        aimed_speed_m_s: speed that was asked for; None for one that goes with the legs' length.
        speeds_m_s: lowest and highest speed of a gait that is told one at each touchdown, and the
            largest change from one step to the next; None for a gait that takes no commands.
    """

    family: Literal["walker3d"] = "walker3d"
    spec: Literal["periodic"] = "periodic"
    aimed_speed_m_s: Annotated[float | None, may(POSITIVE)] = None
    speeds_m_s: Annotated[tuple[float, float, float] | None, may(list_of(POSITIVE, 3, 3))] = None

    @property
    def command(self) -> Command | None:
        """The command that each touchdown brings; None for a gait that takes none."""
        return None if self.speeds_m_s is None else Command(SPEED, *self.speeds_m_s)

    @property
    def about_command(self) -> list[str]:
        """The sentences of a page about the command; none for a gait that takes none."""
        command = self.command
        if command is None:
            return []
        return [
            f"It is told a speed from {command.low:g} to {command.high:g} m/s at each touchdown, "
            f"at most {command.change_limit:g} m/s more or less than in the step before.",
            "Sizes, figures, the live page and the exported C are those of "
            f"{command.middle:g} m/s all the time.",
        ]


def refuse_speeds(speed: float | Interval) -> None:
    """Refuse speeds that no walker has. Raises: InputError."""
    for end in speed if isinstance(speed, tuple) else (speed,):
        if not 0.0 < end < 3.0:
            raise InputError(
                f"speed: expected more than 0 and less than 3 m/s, found {end:g}: write --speed 0.6"
            )


def speed_range(low: float, high: float) -> tuple[float, float, float]:
    """Return a range of speeds, and the largest change from one step to the next [m/s].

    Raises: InputError on an empty or a short range.
    """
    change = 0.003  # Within reach of the tubes of the robot that is shipped.
    if not high - low > 2.0 * change:
        raise InputError(
            f"speed: expected a range LOW:HIGH more than {2.0 * change:g} m/s wide, found "
            f"{low:g}:{high:g}: write --speed {low:g}, or a wider range"
        )
    return low, high, change


@dataclass(frozen=True, eq=False, kw_only=True)
class SpatialTrained(TrainedSummary):
    """Result of `train`. Margins are smallest at random points of each condition's region.

    Attributes:
        speed_m_s, step_m, step_s: speed and step of the periodic orbit.
        multipliers: magnitudes of the multipliers of the orbit, the largest first.
        friction: largest ratio of the contact's forces, of the same samples.
        peak_torque_nm: largest torque of the same samples.
        yaw_nm: largest moment that holds the yaw, of the same samples.
        inlet_m, inlet_momenta: half widths of the inlet: y [m], L_y and n as shares of L_y.
        missed_m: largest distance between the swing foot after a touchdown and where the policy
            starts it, of the same samples.
    """

    speed_m_s: float
    step_m: float
    step_s: float
    multipliers: tuple[float, ...]
    friction: float
    peak_torque_nm: float
    yaw_nm: float
    inlet_m: float
    inlet_momenta: tuple[float, ...]
    missed_m: float
