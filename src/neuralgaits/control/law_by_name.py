"""Control laws by the names that `_control_laws` lists."""

from dataclasses import fields
from functools import cache
from importlib import import_module
from typing import Any

import equinox as eqx
import jax
import numpy as np

from neuralgaits._control_laws import CONTROL_LAWS
from neuralgaits._printable import shown
from neuralgaits.control.law import AbstractLaw
from neuralgaits.errors import InputError


def law_named(controller: str | AbstractLaw) -> AbstractLaw:
    """Return a control law by name, or the law itself. Raises: InputError listing the names."""
    if isinstance(controller, AbstractLaw):
        return controller
    if not isinstance(controller, str) or controller not in CONTROL_LAWS:
        names = ", ".join(CONTROL_LAWS)
        raise InputError(f"unknown controller {shown(controller)}: expected one of {names}")
    return _load(CONTROL_LAWS[controller].place)


@cache
def _load(place: str) -> AbstractLaw:
    module, _, name = place.partition(":")
    entry = getattr(import_module(module), name)
    return entry() if isinstance(entry, type) else entry


def at_bandwidth(controller: str | AbstractLaw, bandwidth: float | None) -> AbstractLaw:
    """Return a control law, by name or as it is, with another double pole of its output errors.

    Args:
        controller: law, by name or as an object.
        bandwidth: w [rad/s]; None for the law's own.

    Raises: InputError for another name, or for a law without a bandwidth.
    """
    law = law_named(controller)
    if bandwidth is None:
        return law
    if (changed := law.at_bandwidth(bandwidth)) is not None:
        return changed
    *names, last = (name for name in CONTROL_LAWS if law_named(name).at_bandwidth(bandwidth))
    name = controller if isinstance(controller, str) else type(controller).__name__
    raise InputError(
        f"--bandwidth: expected a law whose output errors have a double pole, {', '.join(names)} "
        f"or {last}, found {name}: leave --bandwidth out, or write --controller {last}"
    )


def exported_laws(bandwidth: float | None = None) -> dict[str, AbstractLaw]:
    """Return the laws of exported controllers, by name.

    Args:
        bandwidth: bandwidth of laws that have one [rad/s]; None for each law's own.
    """
    laws = {name: law_named(name) for name, entry in CONTROL_LAWS.items() if entry.exported}
    if bandwidth is None:
        return laws
    return {name: law.at_bandwidth(bandwidth) or law for name, law in laws.items()}


def fields_of_law(law: AbstractLaw) -> dict[str, Any]:
    """Return a law's parameters by name, tuples as lists; anything that is no number as text.

    What follows from the gait is left out.
    """
    values = {field.name: getattr(law, field.name) for field in fields(law)}
    values = {name: value for name, value in values.items() if not isinstance(value, eqx.Module)}
    numbers = (bool, int, float, np.generic, np.ndarray, jax.Array, type(None))
    return {
        name: list(value)
        if isinstance(value, tuple)
        else value
        if isinstance(value, numbers)
        else repr(value)
        for name, value in values.items()
    }
