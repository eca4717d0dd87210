"""Bounds on a Program's outputs over boxes, by compiled code."""

import ctypes
from collections.abc import Mapping, Sequence

import numpy as np

from neuralgaits._environment import cores
from neuralgaits._types import Float
from neuralgaits.programs.algebras.taylor_model import Taylor
from neuralgaits.programs.evaluation import NO_SYMBOLS
from neuralgaits.programs.native.compiled_rules import rules_of
from neuralgaits.programs.native.program_code import ProgramCode, encode
from neuralgaits.programs.program import Program
from neuralgaits.programs.remainder_symbols import MOST_OFF_ZERO, MOST_SYMBOLS, count_of


class Bounder:
    """Bounds on the smallest element of each output, for u in a box and xi in the unit ball."""

    def __init__(self, code: ProgramCode, rules: ctypes.CDLL):
        self._rules = rules
        self._outputs = len(code.outputs)
        self._threads = min(cores(), 16)
        _arrays, arguments = code.arguments
        self._handle = rules.ng_bounder(*arguments)

    @classmethod
    def of(
        cls,
        program: Program,
        names: Sequence[str],
        folded: Mapping[int, Taylor],
        symbols: Mapping[int, int] = NO_SYMBOLS,
    ) -> "Bounder | None":
        """Create a bounder for outputs of a Program; None without compiled code.

        Args:
            program: Program of u, over which boxes are given, and perhaps of an xi in the unit
                ball.
            names: names of the outputs.
            folded: its constant values, as `fold` returns them.
            symbols: for each value whose remainders have symbols, the number of its first one;
                `most_symbols` in all at most.
        """
        rules = rules_of(program, _room_for(count_of(program, symbols)))
        return None if rules is None else cls(encode(program, names, folded, symbols), rules)

    def __del__(self):
        """Free the Program in the compiled code."""
        self._rules.ng_forget(self._handle)

    def bounds(
        self, low: Float[np.ndarray, "B n"], high: Float[np.ndarray, "B n"]
    ) -> tuple[Float[np.ndarray, "B C"], Float[np.ndarray, "B C"]]:
        """Return lower and upper bounds on each output's smallest element; NaN where unknown.

        The upper bound is the least of the elements' upper bounds.
        """
        corners = [np.ascontiguousarray(side, dtype=np.float64) for side in (low, high)]
        corner_values = [np.empty((len(low), self._outputs)) for _ in corners]
        self._rules.ng_bounds(
            *(self._handle, corners[0].ctypes.data, corners[1].ctypes.data, len(low)),
            *(self._threads, corner_values[0].ctypes.data, corner_values[1].ctypes.data),
        )
        return corner_values[0], corner_values[1]


def _room_for(symbols: int) -> int:
    """Return the smallest number of symbols for which code is compiled and which is enough."""
    # Code is compiled for these numbers of symbols: room for sixteen doubles the time of bounds.
    rooms = (0, 4, 8, MOST_SYMBOLS, MOST_OFF_ZERO)
    return next(room for room in rooms if symbols <= room)
