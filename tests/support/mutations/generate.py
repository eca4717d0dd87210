"""As many mutations as wanted, each from its own seed."""

from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np

from support.mutations.base import Base, Mutation, Reader
from support.mutations.models import FALSE_MODELS
from support.mutations.numbers import FALSE_NUMBERS
from support.mutations.statements import FALSE_STATEMENTS, bound_by_a_little
from support.mutations.structures import AGAINST_RUN, INCONSISTENT
from support.mutations.texts import UNREADABLE
from support.mutations.theorems import FULL_ORDER_NUMBERS, NOT_FOLLOWING
from support.mutations.trees import TREES

Maker = Callable[[Base, np.random.Generator], Mutation | None]
Groups = tuple[tuple[Maker, ...], ...]
GROUPS: dict[Reader, Groups] = {
    "program": (UNREADABLE, INCONSISTENT, FALSE_STATEMENTS, FALSE_NUMBERS, TREES),
    "model": (UNREADABLE, INCONSISTENT, FALSE_STATEMENTS, FALSE_NUMBERS, FALSE_MODELS, TREES),
    "run": (AGAINST_RUN,),
}
PREMISES: Groups = (FALSE_STATEMENTS, FALSE_NUMBERS)
"""For statements about the outputs of theorems that are not claimed."""
FULL_ORDER_PREMISES: Groups = (
    tuple(maker for maker in FALSE_STATEMENTS if maker is not bound_by_a_little),
    FALSE_NUMBERS,
)
"""At full order, where a box that is hard to decide takes minutes."""
CONCLUSIONS: Groups = (NOT_FOLLOWING,)
"""For theorems that are claimed."""
ONLY_TREES: Groups = (TREES,)
"""For statements of any level."""
FULL_ORDER: Groups = (FULL_ORDER_NUMBERS,)
"""For the theorem of level 4, claimed: seen before a box is bounded."""
TRIES = 200
"""A maker that finds no false statement is asked again with another seed, so often."""


def mutations(
    base: Base, reader: Reader, count: int, seed: int = 0, groups: Groups | None = None
) -> Iterator[Mutation]:
    """Mutations that a reader must object to: every group in turn, and in it every maker.

    Args:
        base: the true proof.
        reader: that is to be tested.
        count: how many.
        seed: of the first.
        groups: makers to take; those for the reader of a proof of level 1 if not given.
    """
    made, attempt = 0, seed
    groups = GROUPS[reader] if groups is None else groups
    while made < count:
        if attempt > seed + TRIES + 10 * count:
            raise AssertionError(f"only {made} of {count} mutations found")
        makers = groups[attempt % len(groups)]
        maker = makers[attempt // len(groups) % len(makers)]
        found = maker(base, np.random.default_rng(attempt))
        attempt += 1
        if found is not None and reader in found.readers:
            made += 1
            yield _at_full_order(found) if len(base.program.inputs) > 1 else found


def _at_full_order(found: Mutation) -> Mutation:
    """A checker looks at points of u with all of xi at once, and may miss what is false at one."""
    return replace(found, kind="barely false") if found.kind == "false" else found
