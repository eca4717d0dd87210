"""Sensors of a plant's controller: the values of `--sensing perfect|encoders,NAME=VALUE,...`."""

import math
from dataclasses import replace

from neuralgaits._checks import listed
from neuralgaits._digits import decimal
from neuralgaits.errors import InputError
from neuralgaits.simulation.setup.disturbance import Changes, PlantChanges

PERFECT, ENCODERS = "perfect", "encoders"


def sensed(disturbance: Changes, sensing: str | None) -> Changes:
    """Return a plant's disturbance with the requested sensors; None changes nothing.

    A disturbance that `sensing` does not name stays, such as a longer delay.

    Raises: InputError in one line for an invalid value.
    """
    if sensing is None:
        return disturbance
    kind = sensing.partition(",")[0].strip()
    if kind not in (PERFECT, ENCODERS):
        raise InputError(f"sensing: expected {PERFECT} or {ENCODERS}, found {kind!r}")
    settings = listed("sensing", sensing)[1:]
    if kind == PERFECT:
        if settings:
            raise InputError(
                f"sensing: expected {PERFECT} alone, found {settings[0]!r}: leave it out, or ask "
                f"for {ENCODERS}"
            )
        return replace(disturbance, estimator=0.0)
    overrides = _read(settings)
    # A usual absolute encoder of a joint, in bits a turn; noise of an inertial unit's pitch [rad];
    # delay from reading to torque [ms].
    figures = {"bits": 14, "pitch_noise": 1e-3, "delay_ms": 2.0} | overrides
    usual, values = PlantChanges(), {"estimator": 1.0}
    for name, value in figures.items():
        field = "encoder_step" if name == "bits" else name
        if getattr(disturbance, field) == getattr(usual, field):
            values[field] = _step(value) if name == "bits" else value
        elif name in overrides:
            raise InputError(
                f"sensing {name}: expected it once, found disturbance {field} beside it: leave "
                "one of them out"
            )
    return replace(disturbance, **values)


def name_of(disturbance: PlantChanges) -> str:
    """Return the name of the sensing of a disturbed plant."""
    return ENCODERS if disturbance.estimator else PERFECT


def _read(settings: list[str]) -> dict[str, float]:
    values: dict[str, float] = {}
    known_names = ("bits", "pitch_noise", "pitch_offset", "delay_ms")
    for setting in settings:
        name, equals, text = (part.strip() for part in setting.partition("="))
        if not equals:
            raise InputError(f"sensing: expected NAME=VALUE after {ENCODERS}, found {setting!r}")
        if name not in known_names:
            raise InputError(
                f"unknown sensing {name!r}: expected one of {', '.join(known_names)} after "
                f"{ENCODERS}"
            )
        if name in values:
            raise InputError(f"sensing {name} is given twice: give it once")
        try:
            values[name] = decimal(text)
        except ValueError:
            raise InputError(f"sensing {name}: expected a number, found {text!r}") from None
    return values


def _step(bits: float) -> float:
    """Return the resolution of an encoder [rad]."""
    most_bits = 32
    if not (1 <= bits <= most_bits and bits == int(bits)):
        raise InputError(
            f"sensing bits: expected a whole number from 1 to {most_bits}, found {bits:g}"
        )
    return math.tau / 2 ** int(bits)
