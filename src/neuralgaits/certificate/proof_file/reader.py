"""Read the claims of a proof file and check its form: fields, types, hash, trees.

Only the standard library and NumPy are needed. The reader accepts the one format it knows, field by
field; an unknown field may change the meaning of a known one.
"""

from array import array
from dataclasses import dataclass
from functools import cached_property
from json import JSONDecodeError
from pathlib import Path
from typing import Any

import numpy as np

from neuralgaits._names import why_no_name
from neuralgaits.certificate.chart import Chart, Corner, CoupledAxes, required_boxes
from neuralgaits.certificate.proof_file.command_ranges import (
    ModelCommand,
    command_ranges,
    refuse_other_family,
)
from neuralgaits.certificate.proof_file.coverage import SpecOutline, premise_names
from neuralgaits.certificate.proof_file.json_fields import (
    box_of,
    exactly,
    parse,
    text_of,
)
from neuralgaits.certificate.proof_file.limits import (
    MOST_LEAVES,
    MOST_NAMES,
    MOST_STATEMENTS,
    limit,
    shortened,
)
from neuralgaits.certificate.proof_file.named_numbers import bounds_of, named_hash, scales_of
from neuralgaits.certificate.proof_file.program_field import FIBRE
from neuralgaits.certificate.proof_file.program_field import program_of as _program
from neuralgaits.certificate.proof_file.theorem_tables import Theorems
from neuralgaits.errors import InputError, reason
from neuralgaits.programs.program import Program
from neuralgaits.programs.prune import reading
from neuralgaits.records.certified import PROOF
from neuralgaits.runs import packed

FORMAT = 3
KIND = "neuralgaits certificate"
FIELDS = frozenset(
    "format kind robot weights_sha256 spec program program_hash chart statements theorems"
    " model".split()
)
STATEMENT_FIELDS = frozenset("conditions region scales bounds degree root tree".split())
MAX_CUTS = 48
"""Most halvings of one axis; more would exhaust the digits of a double."""
LEAF, DIGITS = "-", "0123456789abcdef"
"""Characters of a tree: a leaf, and the axis that is halved."""

Corners = tuple[np.ndarray, np.ndarray]
"""Boxes by their lower and upper corners. [boxes, n] each."""


class InconsistentError(Exception):
    """Raised when a file can be read but contradicts itself."""


@dataclass(frozen=True, eq=False)
class Statement:
    """A statement: every element of each output is at least bound times scale on the root box.

    If the output depends on an input xi of the Program, this holds for every xi of the unit ball.

    Attributes:
        conditions: outputs of the Program.
        region: name of its region in the spec.
        scales, bounds: by condition; scales > 0, bounds of a spec's conditions >= 0.
        degree: degree of the Taylor models, 1 or 2.
        low, high: corners of the root box. [n] each
        tree: depth first: the axis that is halved, lower half first, or `-` for a leaf.
        coupled_axes: axes of the chart whose values must be near each other; the statement leaves
            out other points.
    """

    conditions: tuple[str, ...]
    region: str
    scales: dict[str, float]
    bounds: dict[str, float]
    degree: int
    low: Corner
    high: Corner
    tree: str
    coupled_axes: tuple[CoupledAxes, ...] = ()

    def leaves(self) -> Corners:
        """Return boxes that cover the part of the root box that the statement is about.

        Raises: InconsistentError if the tree is not one.
        """
        # Flat arrays of doubles: a tuple for each corner would take seven times the memory.
        lows, highs = array("d"), array("d")
        characters = iter(self.tree)
        stack = [(self.low, self.high, (0,) * len(self.low))]
        while stack:
            low, high, cuts = stack.pop()
            character = next(characters, None)
            if character is None:
                raise InconsistentError(f"the tree of {self.region} ends before its last leaf")
            if character == LEAF:
                lows.extend(low)
                highs.extend(high)
                continue
            axis = DIGITS.index(character)
            if axis >= len(low) or low[axis] == high[axis] or cuts[axis] == MAX_CUTS:
                raise InconsistentError(f"the tree of {self.region} splits what has no width")
            more = tuple(count + (place == axis) for place, count in enumerate(cuts))
            stack += [(*part, more) for part in reversed(halves(low, high, axis))]
        if next(characters, None) is not None:
            raise InconsistentError(f"the tree of {self.region} goes on after its last leaf")
        low, high = (np.frombuffer(ends).reshape(-1, len(self.low)) for ends in (lows, highs))
        required = required_boxes(self.coupled_axes, low, high)
        return (low, high) if required.all() else (low[required], high[required])


@dataclass(frozen=True, eq=False)
class Claims:
    """All claims of a proof file.

    Attributes:
        robot, spec: name and sha256 of the file.
        weights_sha256: sha256 of the policy's weights file.
        chart: the axes of the Program's input u.
        program: the Program that the statements are about.
        program_hash: the hash that the file gives for it.
        statements: statements in the order of the file.
        theorems: levels above 1, whose premises are statements.
        model: the file's data for readers that derive the dynamics, or None.
        outline: the spec's conditions and regions, as the model has them; None without one.
        commands: the gait's commands, as the model has them.
    """

    robot: tuple[str, str]
    spec: tuple[str, str]
    weights_sha256: str
    chart: Chart
    program: Program
    program_hash: str
    statements: tuple[Statement, ...]
    theorems: Theorems
    model: dict[str, Any] | None
    outline: SpecOutline | None
    commands: tuple[ModelCommand, ...] = ()

    @cached_property
    def off_zero(self) -> set[str]:
        """Return outputs that depend on xi, the place off the zero dynamics.

        Statements about them hold for all xi of the unit ball.
        """
        return reading(self.program, FIBRE)


def halves(low: Corner, high: Corner, axis: int) -> tuple[tuple[Corner, Corner], ...]:
    """Return both halves of a box along an axis, the lower one first."""
    middle = low[axis] + (high[axis] - low[axis]) * 0.5

    def with_middle(corner: Corner) -> Corner:
        return (*corner[:axis], middle, *corner[axis + 1 :])

    return (low, with_middle(high)), (with_middle(low), high)


def read_claims(path: Path) -> Claims:
    """Read a proof file. Raises: InputError in one line if it is not one of this format."""
    remedy = f"name a run that is certified, or its {PROOF}"
    try:
        text = packed.content(path).decode("utf-8")
    except (OSError, ValueError) as error:
        why = "no text" if isinstance(error, UnicodeDecodeError) else reason(error)
        raise InputError(
            f"expected a proof file at {path}, found none to read: {why}; {remedy}"
        ) from None
    try:
        return _claims(parse(text))
    except (ValueError, RecursionError, OverflowError, MemoryError) as error:
        why = "no JSON" if isinstance(error, JSONDecodeError) else str(error)
        # Damaged, or of another version, it is still the proof of a run.
        way = "certify its run again" if KIND in text else remedy
        raise InputError(
            f"expected a proof file of format {FORMAT}, found in {path}: {shortened(why)}; {way}"
        ) from None


def _claims(table: Any) -> Claims:
    if isinstance(table, dict) and "format" in table:
        version = table["format"]
        if type(version) is not int or version != FORMAT:
            raise ValueError(f"format {version!r}")
    fields = exactly(table, "the file", FIELDS)
    if fields["kind"] != KIND:
        raise ValueError(f"kind {fields['kind']!r} instead of {KIND!r}")
    chart, theorems = Chart.read(fields["chart"]), Theorems.read(fields["theorems"])
    program = _program(fields["program"], chart.size)
    outputs = {output.name for output in program.outputs}
    _refuse_names(outputs, premise_names(theorems))
    if (theorems.full is not None) is not (len(program.inputs) > 1):
        raise ValueError(f"a Program of {FIBRE} without level 4, or level 4 without {FIBRE}")
    if all("/" in name for name in outputs):
        raise ValueError("a file of level 4 alone, as earlier versions wrote it beside the others")
    entries = fields["statements"]
    if not isinstance(entries, list) or not entries:
        raise ValueError("no statements")
    limit(len(entries), MOST_STATEMENTS, "statements")
    statements = tuple(_statement(entry, outputs, chart) for entry in entries)
    leaves = sum(statement.tree.count(LEAF) for statement in statements)
    limit(leaves, MOST_LEAVES, "leaves of all trees together")
    model = fields["model"]
    if model is not None and not isinstance(model, dict):
        raise ValueError("a model that is neither a JSON object nor null")
    refuse_other_family(chart, model, theorems=bool(theorems.parameters))
    return Claims(
        robot=named_hash(fields["robot"], "robot"),
        spec=named_hash(fields["spec"], "spec"),
        weights_sha256=text_of(fields["weights_sha256"], "weights_sha256"),
        chart=chart,
        program=program,
        program_hash=text_of(fields["program_hash"], "program_hash"),
        statements=statements,
        theorems=theorems,
        model=model,
        outline=None if model is None else _outline(model, outputs, chart),
        commands=() if model is None else command_ranges(model),
    )


def _refuse_names(outputs: set[str], premises: set[str]) -> None:
    """Refuse an output that is no premise of the theorems, with a name no condition can have."""
    for name in sorted(outputs - premises):
        if why := why_no_name(name):
            raise ValueError(f"an output of the Program named {why}")


def _outline(model: dict[str, Any], outputs: set[str], chart: Chart) -> SpecOutline:
    outline = SpecOutline.read(
        model.get("regions"), model.get("conditions"), decimals=False, ends=chart.region_ends
    )
    conditions = {name for name in outputs if "/" not in name}
    if odd := sorted(conditions ^ set(outline.conditions)):
        raise ValueError(f"{odd[0]}, which only one of model and Program has")
    return outline


def _statement(entry: Any, outputs: set[str], chart: Chart) -> Statement:
    fields = exactly(entry, "a statement", STATEMENT_FIELDS)
    names = fields["conditions"]
    if not isinstance(names, list) or not names or not all(isinstance(n, str) for n in names):
        raise ValueError("conditions which are not a list of names")
    limit(len(names), MOST_NAMES, "conditions")
    if len(set(names)) < len(names) or not set(names) <= outputs:
        raise ValueError(f"conditions {names} that are no different outputs of the Program")
    if type(fields["degree"]) is not int or fields["degree"] not in (1, 2):
        raise ValueError(f"degree {fields['degree']!r} instead of 1 or 2")
    tree = text_of(fields["tree"], "tree")
    if not tree or set(tree) - {LEAF, *DIGITS}:
        raise ValueError(f"a tree that is no text of axes and {LEAF}")
    low, high = box_of(fields["root"], "a root box", chart.size)
    if not chart.spans(low, high):
        raise ValueError(f"a root box from {low} to {high}, which is no box of the chart")
    return Statement(
        conditions=tuple(names),
        region=text_of(fields["region"], "region"),
        scales=scales_of(fields["scales"], names),
        bounds=bounds_of(fields["bounds"], names),
        degree=fields["degree"],
        low=low,
        high=high,
        tree=tree,
        coupled_axes=chart.coupled_axes,
    )
