"""Texts of trees: what is none is refused before a box is made of it, and by the walk too."""

import numpy as np
import pytest

from neuralgaits.certificate.proof_file.reader import LEAF, InconsistentError, Statement
from neuralgaits.certificate.proof_file.tree_text import why_no_tree

L = LEAF
ONE_CUT, THREE_BOXES = f"0{L}{L}", f"10{L}{L}{L}"


def _statement(tree: str, high: tuple[float, ...] = (1.0, 2.0)) -> Statement:
    low = (0.0,) * len(high)
    return Statement(("a",), "tube", {"a": 1.0}, {"a": 0.0}, 2, low, high, tree)


@pytest.mark.parametrize(("tree", "boxes"), [(L, 1), (ONE_CUT, 2), (THREE_BOXES, 3)])
def test_a_tree_covers_its_root_box(tree, boxes):
    statement = _statement(tree)
    assert why_no_tree(statement) is None
    low, high = statement.leaves()
    assert len(low) == boxes
    assert np.prod(high - low, axis=1).sum() == 2.0


@pytest.mark.parametrize(
    ("tree", "high", "words"),
    [
        ("0", (1.0, 2.0), "ends before its last leaf"),
        (f"0{L}", (1.0, 2.0), "ends before its last leaf"),
        (f"{L}{L}", (1.0, 2.0), "goes on after its last leaf"),
        # Leaves and halvings balance at the end, and still the first leaf was the last.
        (f"{L}0{L}", (1.0, 2.0), "goes on after its last leaf"),
        (f"{ONE_CUT}0{L}", (1.0, 2.0), "goes on after its last leaf"),
        (f"2{L}{L}", (1.0, 2.0), "splits what has no width"),
        (f"1{L}{L}", (1.0, 0.0), "splits what has no width"),
    ],
)
def test_what_is_no_tree_is_refused_twice(tree, high, words):
    statement = _statement(tree, high)
    assert words in (why_no_tree(statement) or "")
    with pytest.raises(InconsistentError, match=words):
        statement.leaves()
