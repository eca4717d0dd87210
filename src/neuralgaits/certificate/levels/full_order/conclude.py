"""Conclude level 4 from the constants of the full-order theorem and its premises.

The arithmetic is in `inequalities`. Needs no JAX.
"""

from neuralgaits.certificate.levels.full_order.inequalities import inequalities, is_norm, obstacle
from neuralgaits.certificate.levels.full_order.theorem import (
    FENCES,
    FullOrderConstants,
    decays,
    premises,
)
from neuralgaits.certificate.levels.full_order.words import constant_rows, in_words
from neuralgaits.certificate.premises import Bounds, missing_premises
from neuralgaits.records.certified import Conclusion


def conclude_full_order(constants: FullOrderConstants, bounds: Bounds) -> Conclusion:
    """Conclude that D is forward invariant, between impacts and across them.

    Args:
        constants: the set and its constants.
        bounds: proved bounds, see `premises.proved_bounds`.
    """
    rows = tuple(constant_rows(constants, bounds))
    figures = {constant.name: constant.value for constant in rows}
    broken = [step for step in inequalities(constants) if not step.holds]
    missing = list(missing_premises(premises(constants), bounds))
    shown = 4  # Unproved premises that are named.
    if len(missing) > shown:
        missing[shown:] = [f"and {len(missing) - shown} more premises"]
    reasons = [obstacle(step) for step in broken] + missing
    names = [barrier.name for barrier in constants.barriers]
    if names[:2] != list(FENCES) or len(set(names)) < len(names):
        reasons.insert(0, f"barriers {names}: two fences, then barriers of other names, are needed")
    if not decays(constants.bandwidth):
        reasons.insert(0, "A^T P + P A <= -gamma P does not hold")
    if not is_norm(constants):
        reasons.insert(0, "weights that are no upper triangle without zeros on its diagonal")
    if reasons:
        return Conclusion(4, "undecided", "; ".join(reasons), (), figures, rows)
    return Conclusion(4, "proved", None, in_words(constants), figures, rows)
