"""Read a file of stones to step on: a row each, `stone,x[m],z[m],width[m]`, with checks."""

import math
import re
from pathlib import Path

import numpy as np

from neuralgaits._digits import decimal
from neuralgaits._inputs import between_commas, csv_lines
from neuralgaits._types import Float
from neuralgaits.errors import InputError
from neuralgaits.gait.commands import Commands, command_named
from neuralgaits.simulation.setup.course import Course, stones_at

ROUNDING_M = 1e-6
"""Distance by which a stone may be out of reach, because files are rounded [m]."""
_HEAD = ("stone", "x[m]", "z[m]", "width[m]")


def stones_of_file(path: Path, commands: Commands, steps: int) -> Course:
    """Return the course of a file.

    Args:
        path: path of the file.
        commands: commands of the gait; a stone beyond their ranges is out of reach.
        steps: number of steps of the walk.

    Raises: InputError with one line.
    """
    lines = csv_lines(path, "stones")
    head = tuple(re.sub(r"\s", "", word) for word in lines[0]) if lines else ()
    if head != _HEAD:
        raise InputError(
            f"{path}: expected the columns {','.join(_HEAD)}, found {','.join(head) or 'none'}: "
            "write them into row 1, between commas"
        )
    rows = np.array([_row(path, n, line) for n, line in enumerate(lines[1:], 1)]).reshape(-1, 4)
    for n, stone in enumerate(rows[:, 0]):
        if stone != n:
            raise InputError(
                f"{path}: expected stones numbered one after the other from 0, found {stone:g} in "
                f"row {n + 1}: fill the gap"
            )
    if len(rows) < steps + 1:
        raise InputError(
            f"{path}: expected {steps + 1} stones for {steps} steps, found {len(rows)}: add "
            f"stones, or walk --steps {max(1, len(rows) - 1)}"
        )
    middles, widths = rows[:, 1:3] - rows[0, 1:3], rows[:, 3]
    _check_reach(path, commands, middles, widths)
    return stones_at(middles, widths)


def _row(path: Path, number: int, line: list[str]) -> list[float]:
    try:
        values = [decimal(word) for word in line]
    except ValueError:
        values = []
    if len(values) != len(_HEAD) or not all(map(math.isfinite, values)) or values[3] <= 0.0:
        raise InputError(
            f"{path}: expected {len(_HEAD)} finite numbers in row {number}, the width above 0, "
            f"found {','.join(line)!r}: {between_commas(','.join(line))}"
        )
    return values


def _check_reach(
    path: Path, commands: Commands, middles: Float[np.ndarray, "K 2"], widths: np.ndarray
) -> None:
    """Refuse stones that the gait's commands cannot reach, and blocks inside each other."""
    height = command_named(commands, "step_height")
    length = command_named(commands, "step_length")
    assert length is not None
    level = (0.0, 0.0) if height is None else (height.low, height.high)
    for n, (ahead, up) in enumerate(np.diff(middles, axis=0), 1):
        for what, value, low, high in (
            ("ahead of", ahead, length.low, length.high),
            ("above", up, *level),
        ):
            if not low - ROUNDING_M <= value <= high + ROUNDING_M:
                raise InputError(
                    f"{path}: expected stone {n} between {low:g} and {high:g} m {what} the one "
                    f"before it, as far as the gait steps, found {value:.4g} m: move it"
                )
        if ahead < 0.5 * (widths[n - 1] + widths[n]) - ROUNDING_M:
            raise InputError(
                f"{path}: expected stones beside each other, found stone {n} inside the one "
                "before it: make them narrower"
            )
