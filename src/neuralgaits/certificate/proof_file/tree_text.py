"""Whether the text of a tree is one, without walking it: trees of millions of boxes are read."""

import numpy as np

from neuralgaits.certificate.proof_file.reader import DIGITS, LEAF, Statement


def why_no_tree(statement: Statement) -> str | None:
    """Return why a statement's text is no tree of halvings of its root box; None if it is one.

    Each halving opens one box more and each leaf closes one, so that a tree ends with the sign
    that closes the last.
    """
    signs = np.frombuffer(statement.tree.encode("ascii"), dtype=np.uint8)
    halved = signs != ord(LEAF)
    still_open = 1 + np.cumsum(np.where(halved, 1, -1))
    if (still_open[:-1] <= 0).any():
        return f"the tree of {statement.region} goes on after its last leaf"
    if still_open[-1] != 0:
        return f"the tree of {statement.region} ends before its last leaf"
    for sign in np.unique(signs[halved]):
        axis = DIGITS.index(chr(sign))
        if axis >= len(statement.low) or statement.low[axis] == statement.high[axis]:
            return f"the tree of {statement.region} splits what has no width"
    return None
