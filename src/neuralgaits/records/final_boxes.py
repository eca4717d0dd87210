"""Number of the boxes in a proof file: the leaves of its trees, which a checker bounds anew."""

import re
from pathlib import Path

from neuralgaits.runs import packed

_LEAF = b"-"
_TREE = re.compile(rb'"tree":\s*"([^"]*)"')


def boxes_of_proof(path: str | Path | None) -> int | None:
    """Return how many boxes a proof file has; None if there is no file or no tree in it.

    It only counts: whether the trees are right is for the reader of proofs to say.
    """
    if path is None:
        return None
    try:
        trees = _TREE.findall(packed.content(Path(path)))
    except OSError:
        return None
    return sum(tree.count(_LEAF) for tree in trees) or None
