"""Order and memory of recorded operations: the loops that they share and the arrays they use."""

from dataclasses import dataclass, field

from neuralgaits.programs.c99.nodes import GATHERED, LOOPED, Node

BLOCK = 8
"""Elements of a hidden layer that are made at a time where nothing but a product needs them."""
WIDEST = 64
"""Widest layer made so: stack is saved by reading the next matrix in strips, which costs little
while its rows are short and half the speed at 256."""


@dataclass
class Group:
    """Operations that are written together.

    Attributes:
        nodes: elementwise operations of one size, products with one matrix, or one operation.
        streamed: elementwise operations whose values only these products read: they are made a
            block at a time inside the products' loop, so that no array holds them.
    """

    nodes: list[Node]
    streamed: list[Node] = field(default_factory=list)

    @property
    def loop(self) -> bool:
        """Whether the group loops over elements; each is read before its place is written."""
        return self.nodes[0].looped

    def members(self) -> list[Node]:
        """All operations of the group, in order."""
        return [*self.streamed, *self.nodes]


@dataclass(frozen=True)
class OperationLayout:
    """Operations in groups that run one after the other.

    Attributes:
        groups: groups in the order of the code.
        stored: number of the array of each value that is kept in one, by the value's number.
        slots: sizes of the arrays.
        blocks: numbers of streamed values that their products read.
    """

    groups: list[Group]
    stored: dict[int, int]
    slots: list[int]
    blocks: frozenset[int]


def lay_out(nodes: list[Node], outputs: list[Node]) -> OperationLayout:
    """Group operations and give every value that outlives its loop an array.

    Args:
        nodes: every recorded value, operands first.
        outputs: values that are wanted in the end.
    """
    groups = _streamed(_grouped([n for n in nodes if not n.lasting and not n.view]), outputs)
    last = _last_reads(groups, outputs)
    outside = _read_outside(groups, outputs)
    stored: dict[int, int] = {}
    slots: list[int] = []
    free: list[int] = []
    alive: set[int] = set()
    for number, group in enumerate(groups):
        ended = {k for k in alive if last[k][0] == number}
        lent = {k for k in ended if last[k][1] and group.loop}
        free += sorted(stored[k] for k in lent)
        for node in group.nodes:
            if node.number in outside and (node.size > 1 or not _scalar(node)):
                stored[node.number] = _slot(slots, free, node.size)
                alive.add(node.number)
        free += sorted(stored[k] for k in ended - lent)
        alive -= ended
    streamed = {node.number for group in groups for node in group.streamed}
    return OperationLayout(groups, stored, slots, frozenset(streamed & outside))


def _scalar(node: Node) -> bool:
    """Return whether a value of size 1 is a variable rather than an array of one element."""
    return node.looped or node.kind in GATHERED


def _slot(slots: list[int], free: list[int], size: int) -> int:
    """Return a free array that is large enough, the smallest first; else a new one."""
    fitting = [slot for slot in free if slots[slot] >= size]
    if fitting:
        tightest = min(fitting, key=lambda slot: slots[slot])
        free.remove(tightest)
        return tightest
    slots.append(size)
    return len(slots) - 1


def _grouped(nodes: list[Node]) -> list[Group]:
    """Put every operation into the first group it fits that comes after its operands."""
    groups: list[Group] = []
    place: dict[int, int] = {}
    for node in nodes:
        first = 0
        for base, same in _read(node):
            if base.lasting:
                continue
            at = place[base.number]
            joins = node.looped and (same or node.size == 1) and base.size == node.size
            first = max(first, at if joins and base.looped else at + 1)
        at = next((i for i in range(first, len(groups)) if _fits(node, groups[i])), len(groups))
        if at == len(groups):
            groups.append(Group([]))
        groups[at].nodes.append(node)
        place[node.number] = at
    return groups


def _fits(node: Node, group: Group) -> bool:
    other = group.nodes[0]
    if node.looped or other.looped:
        return node.looped and other.looped and other.size == node.size
    if node.kind == "affine":
        shared = other.kind == "affine" and other.operands[0] is node.operands[0]
        return shared and other.columns == node.columns == 1
    return False


def _streamed(groups: list[Group], outputs: list[Node]) -> list[Group]:
    """Merge loops into the only loop or products that read their values."""
    readers = _readers(groups, outputs)
    gone: set[int] = set()
    for number, group in enumerate(groups):
        for i in range(number):
            if i in gone or group.streamed:
                continue
            # Values that a third group reads stay where they are.
            if any(readers.get(node.number, set()) - {i, number} for node in groups[i].nodes):
                continue
            if _joins(groups[i], group):
                group.nodes[:0] = groups[i].nodes
            elif _serves(groups[i], group):
                group.streamed = groups[i].nodes
            else:
                continue
            gone.add(i)
            for numbers in readers.values():
                numbers |= {number} if i in numbers else set()
                numbers.discard(i)
    return [group for number, group in enumerate(groups) if number not in gone]


def _readers(groups: list[Group], outputs: list[Node]) -> dict[int, set[int]]:
    """Map each value to the groups that read it; outputs are read after the last group."""
    readers: dict[int, set[int]] = {}
    for number, group in enumerate(groups):
        for node in group.nodes:
            for base, _ in _read(node):
                readers.setdefault(base.number, set()).add(number)
    for output in outputs:
        for base, _ in output.bases():
            readers.setdefault(base.number, set()).add(len(groups))
    return readers


def _joins(early: Group, later: Group) -> bool:
    """Return whether a loop can be part of a later one, which reads it element by element."""
    mine = {node.number for node in early.nodes}
    read = [same for node in later.nodes for base, same in _read(node) if base.number in mine]
    size = early.nodes[0].size
    return (
        early.loop and later.loop and 1 < size == later.nodes[0].size and bool(read) and all(read)
    )


def _serves(loop: Group, products: Group) -> bool:
    """Return whether products read a loop element by element, in whole blocks."""
    first = products.nodes[0]
    if not loop.loop or first.looped or first.kind != "affine" or first.columns > 1:
        return False
    size = loop.nodes[0].size
    mine = {node.number for node in loop.nodes}
    direct = {node.operands[1].number for node in products.nodes}
    read = {base.number for node in products.nodes for base, _ in _read(node)}
    blocks = size % BLOCK == 0 and BLOCK < size <= WIDEST
    return size == first.inner and blocks and mine & read <= direct


def _read(node: Node):
    """Return the values read by an operation, and whether at the element it writes."""
    for operand in node.operands:
        for base, same in operand.bases():
            yield base, same and operand.size == node.size and node.kind in LOOPED


def _last_reads(groups: list[Group], outputs: list[Node]) -> dict[int, tuple[int, bool]]:
    """Map each value to the last group that reads it, and whether element by element."""
    last: dict[int, tuple[int, bool]] = {}
    for number, group in enumerate(groups):
        for node in group.members():
            for base, same in _read(node):
                before = last.get(base.number, (-1, True))
                last[base.number] = (number, same and (before[0] != number or before[1]))
    for output in outputs:
        for base, _ in output.bases():
            last[base.number] = (len(groups), False)
    return last


def _read_outside(groups: list[Group], outputs: list[Node]) -> set[int]:
    """Return the values that are read outside the loop that computes them."""
    place = {node.number: i for i, group in enumerate(groups) for node in group.members()}
    outside = {n.number for group in groups for n in group.nodes if not _scalar(n) or n.size > 1}
    outside -= {n.number for group in groups for n in group.nodes if n.looped}
    for number, group in enumerate(groups):
        for node in group.members():
            for base, same in _read(node):
                if base.lasting:
                    continue
                if place[base.number] != number or not (same or base.size == 1):
                    outside.add(base.number)
    return outside | {base.number for output in outputs for base, _ in output.bases()}
