"""Words and unit of each physical quantity, given where its formula is."""

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, TypeVar

Formula = TypeVar("Formula", bound=Callable[..., Any])
Says = Callable[[Mapping[str, Any], Callable[[Any], str]], str]
"""Sentence about a quantity that is at least 0, from its numbers and from how a number is shown."""


@dataclass(frozen=True)
class QuantityWords:
    """Words about a quantity, for reports.

    Attributes:
        formula: function or class that computes it.
        what: the quantity itself; empty for the distance to a limit, which `says` describes.
        unit: its unit.
        gist: purpose of a condition on it, in two or three words; None if there is none to say.
        says: sentence that says it is at least 0; None for "what ≥ 0 unit".
    """

    formula: Callable[..., Any]
    what: str
    unit: str
    gist: str | None = None
    says: Says | None = None


QUANTITIES: dict[str, QuantityWords] = {}
"""Every quantity of this package, by its name in `functions`."""
_ATTRIBUTE = "quantity_words"


def quantity(
    what: str, unit: str, *, gist: str | None = None, says: Says | None = None
) -> Callable[[Formula], Formula]:
    """Mark a function of the point data, or a class of them, as a quantity with words and unit.

    A user's own may have this mark, too: reports then show its words and unit, as the user's.

    Args:
        what: the quantity itself, as in "height of the hip".
        unit: its unit, as in "m".
        gist: purpose of a condition on it, in two or three words.
        says: see `QuantityWords`; of this package's quantities only.
    """

    def mark(formula: Formula) -> Formula:
        words = QuantityWords(formula, what, unit, gist, says)
        setattr(formula, _ATTRIBUTE, words)
        # A proof file describes these by name, and readers know their formulas: no other module
        # gives a name a meaning.
        package, _, module = formula.__module__.rpartition(".")
        modules = ("functions", "quantities", "feet_quantities")
        if package == "neuralgaits.barriers" and module in modules:
            # A class has the name of its function: `KneeBend` is `knee_bend`.
            name = re.sub("(?<=[a-z])(?=[A-Z])", "_", formula.__name__).lower()
            QUANTITIES[name] = words
        return formula

    return mark


def words_about(formula: Callable[..., Any]) -> QuantityWords | None:
    """Return the words that a quantity was marked with; None if it was not."""
    return getattr(formula, _ATTRIBUTE, None)
