"""The choice of remainders that get symbols, by compiled code.

`programs/remainder_symbols.py` has the rules and their reasons; here they take a hundredth of the
time, so that searches of a thousand boxes can afford them.
"""

from collections.abc import Mapping, Sequence

import numpy as np

from neuralgaits.programs.algebras.taylor_model import Taylor
from neuralgaits.programs.native.compiled_rules import rules_of
from neuralgaits.programs.native.program_code import encode
from neuralgaits.programs.program import Program
from neuralgaits.programs.remainder_symbols import (
    SHARES,
    least_gain,
    middle,
    most_symbols,
    too_large,
)


def compiled_choice(
    program: Program,
    low: Sequence[float],
    high: Sequence[float],
    folded: Mapping[int, Taylor],
) -> tuple[int, ...] | None:
    """Choose the values of a Program whose remainders get symbols, like `values_with_symbols`.

    Args:
        program: Program of u, over which boxes are given, and perhaps of an xi in the unit ball.
        low: lower corner of the region in which boxes are. [n]
        high: upper corner. [n]
        folded: its constant values, as `fold` gives them.

    Returns: their numbers; None without compiled code.
    """
    most, least = most_symbols(program), least_gain(program)
    rules = rules_of(program, most)
    if rules is None:
        return None
    if too_large(program):
        return ()
    code = encode(program, [output.name for output in program.outputs], folded, reuse=False)
    _arrays, arguments = code.arguments
    numbers = np.empty(most, dtype=np.int64)
    for share in SHARES:
        box = [np.ascontiguousarray(corner) for corner in middle(low, high, share)]
        count = rules.ng_choose_symbols(
            *arguments, box[0].ctypes.data, box[1].ctypes.data, least, numbers.ctypes.data
        )
        if count >= 0:
            return tuple(sorted(code.numbers[row] for row in numbers[:count]))
    return ()
