"""Order and memory of recorded operations: which share a loop, and where arrays stand."""

from dataclasses import dataclass

from neuralgaits.interpreters.c99_nodes import GATHERED, LOOPED, Node


@dataclass(frozen=True)
class Layout:
    """Operations in groups that run one after the other.

    Attributes:
        groups: elementwise operations of one size, products with one matrix, or one operation.
        stored: by number of a value that stands in an array, the number of that array.
        slots: sizes of the arrays.
    """

    groups: list[list[Node]]
    stored: dict[int, int]
    slots: list[int]


def lay_out(nodes: list[Node], outputs: list[Node]) -> Layout:
    """Group operations and give every value that outlives its loop an array.

    Args:
        nodes: every recorded value, operands first.
        outputs: values that are wanted in the end.
    """
    groups, place = _grouped([n for n in nodes if not n.lasting and not n.view])
    last = _last_reads(groups, outputs)
    outside = _read_outside(groups, place, outputs)
    stored: dict[int, int] = {}
    slots: list[int] = []
    free: list[int] = []
    alive: set[int] = set()
    for number, group in enumerate(groups):
        done = {k for k in alive if last[k][0] == number}
        # A loop reads an element before it stores one in its place; other groups do not.
        lent = {k for k in done if last[k][1] and group[0].kind in LOOPED}
        free += sorted(stored[k] for k in lent)
        for node in group:
            if node.number in outside and (node.size > 1 or node.kind == "affine"):
                stored[node.number] = _slot(slots, free, node.size)
                alive.add(node.number)
        free += sorted(stored[k] for k in done - lent)
        alive -= done
    return Layout(groups, stored, slots)


def _slot(slots: list[int], free: list[int], size: int) -> int:
    """A free array that is large enough, the smallest first; else a new one."""
    fitting = [slot for slot in free if slots[slot] >= size]
    if fitting:
        chosen = min(fitting, key=lambda slot: slots[slot])
        free.remove(chosen)
        return chosen
    slots.append(size)
    return len(slots) - 1


def _grouped(nodes: list[Node]) -> tuple[list[list[Node]], dict[int, int]]:
    """Put every operation into the first group it fits that comes after its operands."""
    groups: list[list[Node]] = []
    place: dict[int, int] = {}
    for node in nodes:
        first = 0
        for base, same in _read(node):
            if base.lasting:
                continue
            at = place[base.number]
            joins = node.kind in LOOPED and (same or node.size == 1) and base.size == node.size
            joins = joins and base.kind in LOOPED
            first = max(first, at if joins else at + 1)
        at = next((i for i in range(first, len(groups)) if _fits(node, groups[i])), len(groups))
        if at == len(groups):
            groups.append([])
        groups[at].append(node)
        place[node.number] = at
    return groups, place


def _fits(node: Node, group: list[Node]) -> bool:
    other = group[0]
    if node.kind in LOOPED:
        return other.kind in LOOPED and other.size == node.size
    if node.kind == "affine":
        shared = other.kind == "affine" and other.operands[0] is node.operands[0]
        return shared and other.columns == node.columns == 1
    return False


def _read(node: Node):
    """Values read by an operation, and whether at the element it writes."""
    for operand in node.operands:
        for base, same in operand.bases():
            yield base, same and operand.size == node.size and node.kind in LOOPED


def _last_reads(groups: list[list[Node]], outputs: list[Node]) -> dict[int, tuple[int, bool]]:
    """By value, the last group that reads it, and whether element by element."""
    last: dict[int, tuple[int, bool]] = {}
    for number, group in enumerate(groups):
        for node in group:
            for base, same in _read(node):
                before = last.get(base.number, (-1, True))
                last[base.number] = (number, same and (before[0] != number or before[1]))
    for output in outputs:
        for base, _ in output.bases():
            last[base.number] = (len(groups), False)
    return last


def _read_outside(groups: list[list[Node]], place: dict[int, int], outputs: list[Node]) -> set[int]:
    """Values that are read outside the loop that computes them."""
    found = {n.number for group in groups for n in group if n.kind not in LOOPED | GATHERED}
    found |= {n.number for group in groups for n in group if n.kind in GATHERED and n.size > 1}
    for number, group in enumerate(groups):
        for node in group:
            for base, same in _read(node):
                if base.lasting:
                    continue
                if place[base.number] != number or not (same or base.size == 1):
                    found.add(base.number)
    return found | {base.number for output in outputs for base, _ in output.bases()}
