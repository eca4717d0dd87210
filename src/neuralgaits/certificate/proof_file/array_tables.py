"""Arrays of a model in a proof file: exact numbers, or the name of a constant of the Program."""

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np


def array_table(
    owner: str, arrays: Mapping[str, Any], constants: Mapping[str, np.ndarray]
) -> dict[str, Any]:
    """Return arrays by name: as the name of an identical Program constant, else as numbers.

    Args:
        owner: owner of the arrays; the Program calls them OWNER.NAME.
        arrays: arrays by name; None stays None.
        constants: constants of the Program, by name.
    """
    table: dict[str, Any] = {}
    for name, value in arrays.items():
        if value is None:
            table[name] = None
            continue
        array, path = np.asarray(value, dtype=np.float64), f"{owner}.{name}"
        stored = constants.get(path)
        if (
            stored is not None
            and stored.shape == array.shape
            and stored.tobytes() == array.tobytes()
        ):
            table[name] = {"constant": path}
        else:
            table[name] = {"shape": list(array.shape), "values": hexes(array.ravel())}
    return table


def hexes(values: Iterable[Any]) -> list[str]:
    """Return numbers as hexadecimal text, exact to the last bit."""
    return [float(value).hex() for value in values]
