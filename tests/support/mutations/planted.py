"""Gaits with a violation planted in a small part of a region, and forged proofs of them."""

import copy
import shutil
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from safetensors.numpy import load_file, save_file

from neuralgaits.programs import POINT, Program, evaluate
from neuralgaits.programs.prune import prune
from neuralgaits.runs.names import WEIGHTS
from support.mutations.base import (
    BOTH,
    Base,
    Mutation,
    Table,
    altered,
    corners,
    grid,
    least,
    with_program,
)
from support.mutations.numbers import changed_constant

DEEPEST, SHALLOWEST = -0.02, -0.0005
"""The planted margin lies between these, in scales."""
HALVINGS = 40


@dataclass(frozen=True)
class Planted:
    """A gait that breaks a condition, a little and somewhere.

    Attributes:
        name: what was changed.
        condition: that is broken.
        margin: the smallest seen, in scales; negative.
        share: of its region's points that break it.
        program: of the gait.
        statement: of the true proof, about the condition.
    """

    name: str
    condition: str
    margin: float
    share: float
    program: Program
    statement: Table

    def plant(self, run: Path, out: Path) -> Path:
        """A copy of a run with the weights of the gait."""
        shutil.copytree(run, out, ignore=shutil.ignore_patterns("certificate"))
        weights = load_file(out / WEIGHTS)
        weights |= {name: a for name, a in self.program.parameters.items() if name in weights}
        save_file({name: np.array(a, order="C") for name, a in weights.items()}, out / WEIGHTS)
        return out

    def forged(self, base: Base) -> Mutation:
        """The true proof's tree for the broken condition, claiming that it just holds."""
        statement = self.statement | {
            "conditions": [self.condition],
            "bounds": {self.condition: 0.0},
            "scales": {self.condition: self.statement["scales"][self.condition]},
        }
        table = base.copy() | {"statements": [copy.deepcopy(statement)]}
        table = with_program(table, self.program)
        name = f"forged: {self.condition} {self.margin:.2g} after {self.name}"
        # A box with both signs in it may be left undecided.
        return altered(name, "barely false", BOTH, table)


def planted(base: Base, count: int, seed: int = 0) -> Iterator[Planted]:
    """Gaits with one thing changed: a layer, an output's limits, a fence, ..."""
    made, attempt = 0, seed
    while made < count:
        found = _plant(base, attempt)
        attempt += 1
        if found is not None:
            made += 1
            yield found
        if attempt > seed + 20 * count:
            raise AssertionError(f"only {made} of {count} gaits found")


def _plant(base: Base, seed: int) -> Planted | None:
    """Halve the size of a change until the worst margin is barely negative."""
    low, high = 0.0, 1.0
    for _ in range(HALVINGS):
        size = 0.5 * (low + high)
        name, program = changed_constant(base.program, np.random.default_rng(seed), size)
        statement, condition, margin, share = _worst(base, program)
        if not margin < SHALLOWEST:
            low = size
        elif margin < DEEPEST:
            high = size
        else:
            return Planted(name, condition, margin, share, program, statement)
    return None


def _worst(base: Base, program: Program) -> tuple[Table, str, float, float]:
    """The condition with the smallest margin at points: its statement, name, margin, share."""
    found: list[tuple[float, str, Table]] = []
    for statement in base.table["statements"]:
        seen = least(program, statement["conditions"], grid(*corners(statement)))
        found += [
            (value / statement["scales"][name], name, statement)
            for name, (value, _) in seen.items()
        ]
    margin, name, statement = min(found, key=lambda item: item[0])
    return statement, name, margin, _share(program, name, grid(*corners(statement)))


def _share(program: Program, name: str, u: np.ndarray) -> float:
    with np.errstate(all="ignore"):
        values = evaluate(prune(program, [name]), {"u": u}, POINT)[name]
    return float(np.mean(values.reshape(len(u), -1).min(axis=1) < 0.0))
