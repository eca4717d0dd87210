"""Constants of emitted functions as static arrays of C, and how numbers are written."""

import math
import re

import numpy as np

from neuralgaits.errors import InputError


class Tables:
    """Static arrays of one file; equal arrays are stored once.

    Attributes:
        texts: definitions by name.
        numbers: number of reals that they hold.
    """

    def __init__(self, prefix: str):
        """Start without tables; names begin with `prefix`."""
        self.texts: dict[str, str] = {}
        self.numbers = 0
        self._prefix = prefix
        self._names: dict[tuple[bytes, tuple[int, ...]], str] = {}

    def reals(self, wish: str, data: np.ndarray) -> str:
        """Return the name of the table with these numbers. `wish` is used if it is free."""
        key = (data.tobytes(), data.shape)
        if key not in self._names:
            name = self._free(wish)
            self._names[key] = name
            self.numbers += data.size
            dims = "".join(f"[{n}]" for n in data.shape)
            self.texts[name] = wrapped(f"static const ng_real {name}{dims} = {braces(data)};")
        return self._names[key]

    def places(self, index: tuple[int, ...]) -> str:
        """Return the name of the table with these places in an array."""
        key = (repr(index).encode(), (-1,))
        if key not in self._names:
            name = self._free("places")
            self._names[key] = name
            values = ", ".join(str(i) for i in index)
            self.texts[name] = wrapped(
                f"static const unsigned short {name}[{len(index)}] = {{{values}}};"
            )
        return self._names[key]

    def _free(self, wish: str) -> str:
        name, count = f"{self._prefix}_{wish}", 2
        while name in self.texts:
            name, count = f"{self._prefix}_{wish}_{count}", count + 1
        return name


def literal(value: float) -> str:
    """Write a number of the type in use; 17 digits keep every bit of a double.

    Raises: InputError if it is not finite.
    """
    return _number(value) if value >= 0.0 else f"(-{_number(-value)})"


def _number(value: float) -> str:
    if not math.isfinite(value):
        raise InputError(
            f"expected finite numbers to write in C, found {float(value)}: weights or robot are "
            "damaged; restore the run, or train again"
        )
    return f"NG({float(value)!r})"


def braces(data: np.ndarray) -> str:
    """Write an initialiser, one row of a matrix a line."""
    if data.ndim == 1:
        return wrapped("{" + ", ".join(map(_number, data)) + "}")
    return "{\n" + ",\n".join("    " + braces(row).replace("\n", "\n    ") for row in data) + "\n}"


def identifier(name: str) -> str:
    """Return a C identifier for a path such as `network.weights[1]`."""
    return re.sub(r"\W+", "_", name).strip("_")


def wrapped(text: str) -> str:
    """Break a long line at its commas."""
    if "\n" in text:
        return text
    lines, line = [], ""
    width = 96  # Width of a line of C (characters).
    for part in text.split(", "):
        if line and len(line) + 2 + len(part) > width:
            lines.append(f"{line},")
            line = "    " + part
        else:
            line = f"{line}, {part}" if line else part
    return "\n".join([*lines, line])
