"""Conditions and their quantities as plain data, read off the objects that are evaluated.

Those of this package are described in full, by name and numbers, so that a reader can derive them
on its own. For a user's own functions and kinds, only the names are known.
"""

from collections.abc import Callable
from dataclasses import fields, is_dataclass
from typing import Any

import numpy as np

from neuralgaits.barriers import conditions
from neuralgaits.barriers.conditions import AbstractCondition
from neuralgaits.barriers.quantities import AfterReset, AtLeast, AtMost
from neuralgaits.barriers.quantity_words import QUANTITIES, words_about


def describe_condition(condition: AbstractCondition) -> dict[str, Any]:
    """Describe a condition as data: "kind" (or "user" and its class) and its fields."""
    kind = type(condition)
    built_in = vars(conditions).get(kind.__name__) is kind
    described: dict[str, Any] = {"kind": kind.__name__} if built_in else {"user": kind.__qualname__}
    for item in fields(condition):
        key = "quantity" if item.name == "function" else item.name
        described[key] = _plain(getattr(condition, item.name))
    return described


def describe_quantity(quantity: Callable[..., Any]) -> dict[str, Any]:
    """Describe a quantity as data: "function", its name in `functions`, its numbers; or "user"."""
    name = _name_of(quantity)
    if name is None:
        own = {"user": getattr(quantity, "__qualname__", type(quantity).__qualname__)}
        words = words_about(quantity)
        return own if words is None else own | {"what": words.what, "unit": words.unit}
    described: dict[str, Any] = {"function": name}
    for item in fields(quantity) if is_dataclass(quantity) else ():
        key = "of" if item.name == "function" else item.name
        described[key] = _plain(getattr(quantity, item.name))
    return described


def _name_of(quantity: Callable[..., Any]) -> str | None:
    """Return the name in `functions` of a quantity of this package; None for a user's own."""
    for kind, name in ((AtLeast, "at_least"), (AtMost, "at_most"), (AfterReset, "after_reset")):
        if type(quantity) is kind:
            return name
    for name, entry in QUANTITIES.items():
        if entry.formula is quantity or entry.formula is type(quantity):
            return name
    return None


def _plain(value: Any) -> Any:
    if callable(value):
        return describe_quantity(value)
    if isinstance(value, tuple | list):
        return [_plain(item) for item in value]
    # Arrays and NumPy's scalars; what is neither is already plain.
    return np.asarray(value).tolist() if hasattr(value, "__array__") else value
