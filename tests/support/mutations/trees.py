"""Trees with signs changed, and with subtrees cut, exchanged and grown.

A tree says where boxes are halved. One that is none contradicts the file: what it reduces to,
split by split, is not a leaf, or it is deeper than a double has digits. One that is a tree makes
no statement true or false, so those come with a bound that a point of the grid misses.
"""

import re
from collections.abc import Callable

import numpy as np

from support.mutations.base import BOTH, Base, Mutation, Table, altered
from support.mutations.statements import one_alone

Draw = np.random.Generator
DEEPEST = 48
"""Halvings after which a double has no digits left."""


def wide(statement: Table) -> str:
    """The axes along which the root box can be halved, as digits."""
    ends = zip(statement["root"]["low"], statement["root"]["high"], strict=True)
    return "".join(str(k) for k, (a, b) in enumerate(ends) if float.fromhex(a) != float.fromhex(b))


def is_tree(signs: str, axes: str) -> bool:
    """Whether halvings into leaves can be taken back, one after the other, until a leaf is left."""
    before = None
    while axes and signs != before:
        before, signs = signs, re.sub(f"[{axes}]--", "-", signs)
    return signs == "-"


def subtrees(signs: str) -> list[tuple[int, int]]:
    """Where each node's subtree begins and ends, the whole tree first."""
    spans, open_nodes = [], []
    for place, sign in enumerate(signs):
        open_nodes.append([place, 0 if sign == "-" else 2])
        while open_nodes and open_nodes[-1][1] == 0:
            begin, _ = open_nodes.pop()
            spans.append((begin, place + 1))
            if open_nodes:
                open_nodes[-1][1] -= 1
    assert not open_nodes
    return sorted(spans)


def flipped(base: Base, draw: Draw) -> Mutation | None:
    """One sign, or several."""

    def change(bits: str, axes: str) -> tuple[str, str]:
        count = int(draw.choice([1, 1, 1, 2, 3]))
        places = sorted({int(k) for k in draw.integers(len(bits), size=count)})
        for place in places:
            other = "-" if bits[place] != "-" else str(draw.choice([*(axes or "0"), "7"]))
            bits = bits[:place] + other + bits[place + 1 :]
        return f"signs {places} changed", bits

    return _broken(base, draw, change)


def cut_out(base: Base, draw: Draw) -> Mutation | None:
    """A subtree that is gone."""

    def change(bits: str, axes: str) -> tuple[str, str]:
        begin, end = _pick(subtrees(bits), draw)
        return f"bits {begin} to {end} gone", bits[:begin] + bits[end:]

    return _broken(base, draw, change)


def put_in(base: Base, draw: Draw) -> Mutation | None:
    """A subtree twice."""

    def change(bits: str, axes: str) -> tuple[str, str]:
        begin, end = _pick(subtrees(bits), draw)
        place, _ = _pick(subtrees(bits), draw)
        return f"bits {begin} to {end} again at {place}", bits[:place] + bits[begin:end] + bits[
            place:
        ]

    return _broken(base, draw, change)


def of_another_box(base: Base, draw: Draw) -> Mutation | None:
    """The tree of a statement whose boxes have another number of halves."""
    table = base.copy()
    others = sorted({s["tree"] for s in table["statements"]})

    def change(bits: str, axes: str) -> tuple[str, str]:
        del bits, axes
        return "another statement's tree", str(draw.choice(others))

    return _broken(base, draw, change)


def too_deep(base: Base, draw: Draw) -> Mutation | None:
    """A leaf halved until its digits are exhausted, and once more."""
    table, statement, bits, axes = _chosen(base, draw)
    if not axes:
        return None
    leaves = [k for k, sign in enumerate(bits) if sign == "-"]
    place, count = _pick(leaves, draw), DEEPEST + 1
    path = str(draw.choice([*axes])) * count + "-" * (count + 1)
    statement["tree"] = bits[:place] + path + bits[place + 1 :]
    assert is_tree(statement["tree"], axes)
    return _altered(table, statement, f"leaf at {place} halved {count} times")


def pruned(base: Base, draw: Draw) -> Mutation | None:
    """A subtree cut down to a leaf, and a bound too high."""

    def change(bits: str, axes: str) -> tuple[str, str]:
        begin, end = _pick(subtrees(bits), draw)
        return f"bits {begin} to {end} a leaf", bits[:begin] + "-" + bits[end:]

    return _hidden(base, draw, change)


def exchanged(base: Base, draw: Draw) -> Mutation | None:
    """Two subtrees exchanged, and a bound too high."""

    def change(bits: str, axes: str) -> tuple[str, str]:
        spans = subtrees(bits)
        one = _pick(spans, draw)
        apart = [s for s in spans if s[1] <= one[0] or s[0] >= one[1]]
        if not apart:
            return "nothing to exchange", bits
        (a, b), (c, d) = sorted([one, _pick(apart, draw)])
        return f"bits from {a} and {c} exchanged", bits[:a] + bits[c:d] + bits[b:c] + bits[
            a:b
        ] + bits[d:]

    return _hidden(base, draw, change)


def grown(base: Base, draw: Draw) -> Mutation | None:
    """Leaves split further, and a bound too high."""

    def change(bits: str, axes: str) -> tuple[str, str]:
        if not axes:
            return "no width to split", bits
        chosen = draw.random(len(bits)) < 0.3
        split = str(draw.choice([*axes])) + "--"
        grown_bits = (
            split if sign == "-" and more else sign for sign, more in zip(bits, chosen, strict=True)
        )
        return "leaves split", "".join(grown_bits)

    return _hidden(base, draw, change)


def lopsided(base: Base, draw: Draw) -> Mutation | None:
    """One corner halved thirty times and the rest not at all, and a bound too high."""

    def change(bits: str, axes: str) -> tuple[str, str]:
        if not axes:
            return "no width to split", bits
        count = int(draw.integers(5, 30))
        path = "".join(axes[k % len(axes)] for k in range(count))
        return f"one corner halved {count} times", path + "-" * (count + 1)

    return _hidden(base, draw, change)


Change = Callable[[str, str], tuple[str, str]]


def _chosen(base: Base, draw: Draw) -> tuple[Table, Table, str, str]:
    table = base.copy()
    statement = _pick(table["statements"], draw)
    return table, statement, statement["tree"], wide(statement)


def _broken(base: Base, draw: Draw, change: Change) -> Mutation | None:
    """A statement with what is no tree of its root; None if it is one by chance."""
    table, statement, bits, axes = _chosen(base, draw)
    what, statement["tree"] = change(bits, axes)
    if not statement["tree"] or is_tree(statement["tree"], axes):
        return None
    return _altered(table, statement, what)


def _altered(table: Table, statement: Table, what: str) -> Mutation:
    name = statement["conditions"][0]
    return altered(f"tree of {name}: {what}", "inconsistent", BOTH, table)


def _hidden(base: Base, draw: Draw, change: Change) -> Mutation:
    """A statement that is false by a twentieth of its scale or more, with another true tree."""
    table, statement, name, seen = one_alone(base, draw)
    axes = wide(statement)
    what, statement["tree"] = change(statement["tree"], axes)
    assert is_tree(statement["tree"], axes)
    more = float(draw.uniform(0.05, 1.0))
    statement["bounds"][name] = seen + more
    return altered(f"{name} {more:.2g} too high, {what}", "false", BOTH, table)


def _pick(items: list, draw: Draw):
    return items[int(draw.integers(len(items)))]


BROKEN_TREES = (flipped, cut_out, put_in, of_another_box, too_deep)
FALSE_TREES = (pruned, exchanged, grown, lopsided)
TREES: tuple[Callable[[Base, Draw], Mutation | None], ...] = (*BROKEN_TREES, *FALSE_TREES)
