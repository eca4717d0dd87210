"""Named differences between the plant and the model: the values of `--disturb NAME=VALUE,...`."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from typing import Any, TypeVar

from neuralgaits._checks import listed
from neuralgaits._digits import decimal
from neuralgaits._names import meant
from neuralgaits._printable import shown
from neuralgaits.errors import InputError


def quantity(default: float | None, lowest: float, highest: float, meaning: str) -> Any:
    """Return the field of a disturbance: its default, its range, its words with a unit."""
    about = {"lowest": lowest, "highest": highest, "meaning": meaning}
    return field(default=default, metadata=about)


@dataclass(frozen=True)
class PlantChanges:
    """Differences of the plant from its robot file; the defaults are no difference.

    Attributes:
        friction: sliding friction coefficient between feet and floor; None keeps the file's.
        torque_limit: limit of every joint, known to the controller [N m]; None keeps the file's.
        delay_ms: delay from reading the sensors to the torque, whole milliseconds.
        floor_height: the floor goes up or down by this much, or not at all, from one foothold
            to the next, each with probability 1/3 [m].
        slope_deg: slope of the floor, positive uphill.
        mass_scale: factor on all masses and inertias.
        torso_shift_m: the torso's centre of mass moves forward by this [m].
        joint_friction: dry friction of every actuated joint [N m].
        encoder_noise: standard deviation of every measured angle, pitch included [rad].
        rate_noise: standard deviation of every measured rate, pitch included [rad/s].
        encoder_step: resolution of every measured angle, pitch included; noise comes before
            rounding [rad].
        pitch_noise: standard deviation of the measured pitch, in addition to that of every angle
            [rad].
        pitch_offset: offset of the measured pitch [rad].
        estimator: 1 for a controller that gets no rates and no velocity and estimates them from
            angles, pitch and contact; 0 for one that gets them.
        drive_stiffness, drive_damping: gains of the drives of all joints, which hold the angles and
            rates of the last tick with them between ticks, see `drives` [N m/rad], [N m s/rad].
        drive_rate: rate of these loops, and of MuJoCo's steps; a multiple of the controller's [Hz].
    """

    friction: float | None = quantity(None, 0.0, 10.0, "friction coefficient of the feet")
    torque_limit: float | None = quantity(None, 0.0, 1e6, "torque limit of every joint [N m]")
    delay_ms: float = quantity(0.0, 0.0, 100.0, "delay of the torques [ms]")
    floor_height: float = quantity(0.0, 0.0, 0.5, "random steps of the floor, +- [m]")
    slope_deg: float = quantity(0.0, -45.0, 45.0, "slope of the floor, uphill positive [deg]")
    mass_scale: float = quantity(1.0, 0.01, 100.0, "factor on masses and inertias")
    torso_shift_m: float = quantity(0.0, -1.0, 1.0, "torso centre of mass moved forward [m]")
    joint_friction: float = quantity(0.0, 0.0, 1e3, "dry friction of every joint [N m]")
    encoder_noise: float = quantity(0.0, 0.0, 1.0, "noise of angles, standard deviation [rad]")
    rate_noise: float = quantity(0.0, 0.0, 10.0, "noise of rates, standard deviation [rad/s]")
    encoder_step: float = quantity(0.0, 0.0, 1.0, "resolution of angles [rad]")
    pitch_noise: float = quantity(0.0, 0.0, 1.0, "further noise of the pitch [rad]")
    pitch_offset: float = quantity(0.0, -0.5, 0.5, "error of the pitch's zero [rad]")
    estimator: float = quantity(0.0, 0.0, 1.0, "1: rates are estimated, not measured")
    drive_stiffness: float = quantity(0.0, 0.0, 1e5, "stiffness of the drives [N m/rad]")
    drive_damping: float = quantity(0.0, 0.0, 1e4, "damping of the drives [N m s/rad]")
    drive_rate: float = quantity(2e3, 1e3, 4e4, "rate of the drives' own loops [Hz]")

    def __post_init__(self):
        """Check every value against its range."""
        for entry in fields(self):
            value, about = getattr(self, entry.name), entry.metadata
            if value is None:
                continue
            low, high = about["lowest"], about["highest"]
            if not (math.isfinite(value) and low <= value <= high):
                raise InputError(
                    f"disturbance {entry.name}: expected {low:g} to {high:g} "
                    f"({about['meaning']}), found {value:g}"
                )
        if self.delay_ms != int(self.delay_ms):
            raise InputError(
                f"disturbance delay_ms: expected whole milliseconds, found {self.delay_ms:g}"
            )
        if self.drive_rate % 1e3:
            raise InputError(
                "disturbance drive_rate: expected whole kilohertz, which the controller's ticks "
                f"divide, found {self.drive_rate:g} Hz"
            )
        if self.drive_rate != PlantChanges.drive_rate and not self.has_drives:
            raise InputError(
                "disturbance drive_rate: expected drives with a loop of their own, found none: "
                "give their --gains, or leave it out"
            )
        if self.estimator not in (0.0, 1.0):
            raise InputError(f"disturbance estimator: expected 0 or 1, found {self.estimator:g}")
        if self.estimator and self.rate_noise:
            raise InputError(
                "disturbance rate_noise: expected measured rates, found that they are estimated: "
                "leave it out, or --sensing perfect"
            )

    @property
    def has_drives(self) -> bool:
        """Return whether drives close loops of their own between two ticks."""
        return self.drive_stiffness > 0.0 or self.drive_damping > 0.0

    @property
    def noise_of_pitch(self) -> float:
        """Return the standard deviation of the measured pitch [rad]."""
        return math.hypot(self.encoder_noise, self.pitch_noise)

    @property
    def is_noisy(self) -> bool:
        """Return whether a reading has noise."""
        return self.noise_of_pitch > 0.0 or self.rate_noise > 0.0


Changes = TypeVar("Changes", bound=PlantChanges)


def existing(kind: type[PlantChanges] = PlantChanges) -> str:
    """Return every name with its meaning, for messages and help."""
    return "; ".join(f"{entry.name}: {entry.metadata['meaning']}" for entry in fields(kind))


def parse(
    disturb: str | Mapping[str, float] | PlantChanges | None, kind: type[Changes] = PlantChanges
) -> Changes:
    """Read `NAME=VALUE,...`, or a mapping of names to values, of a kind of changes.

    Raises: InputError for a name that does not exist, a value that is no number, out of its
    range or given twice; the message has the name meant, or all names.
    """
    if isinstance(disturb, kind):
        return disturb
    if isinstance(disturb, PlantChanges):
        return kind(**vars(disturb))
    if disturb is not None and not isinstance(disturb, str | Mapping):
        raise InputError(f"disturb: expected NAME=VALUE,... or a mapping, found {shown(disturb)}")
    if not disturb:
        return kind()
    pairs = _pairs(disturb) if isinstance(disturb, str) else list(disturb.items())
    names = {entry.name for entry in fields(kind)}
    values: dict[str, float] = {}
    for name, text in pairs:
        if name not in names:
            remedy = meant(name, names) or f"expected one of {existing(kind)}"
            raise InputError(f"unknown disturbance {name!r}: {remedy}")
        if name in values:
            raise InputError(f"disturbance {name} is given twice: give it once")
        try:
            values[name] = decimal(text)
        except (TypeError, ValueError):
            raise InputError(
                f"disturbance {name}: expected a number, found {shown(text)}"
            ) from None
    return kind(**values)


def _pairs(text: str) -> list[tuple[str, str]]:
    pairs = []
    for part in listed("disturbances", text):
        name, equals, value = part.partition("=")
        if not equals:
            raise InputError(f"disturbances: expected NAME=VALUE,..., found {part!r}")
        pairs.append((name.strip(), value.strip()))
    return pairs
