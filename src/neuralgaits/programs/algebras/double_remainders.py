"""Remainders of a Program's results in doubles, by which a check chooses those with symbols."""

import numpy as np

from neuralgaits.programs.algebras.double_algebra import DoubleAlgebra
from neuralgaits.programs.evaluation import fold, results
from neuralgaits.programs.program import Program
from neuralgaits.programs.remainder_symbols import Symbols


def double_remainders(
    program: Program, low: np.ndarray, high: np.ndarray, symbols: Symbols
) -> dict[int, np.ndarray]:
    """Return the remainder of each result over one box, as `Remainders` asks."""
    algebra = DoubleAlgebra.of(program, symbols)
    box = {program.inputs[0].name: (low[None], high[None])}
    with np.errstate(all="ignore"):
        rows = results(program, box, algebra, fold(program, algebra), symbols)
        return {number: model.radius[:, 0] for number, model in rows}
