"""Scope of a proof of a run: a level, a box of robots and floors, ranges of commands."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from neuralgaits.analysis.run import Run
from neuralgaits.barriers import GaitSpec
from neuralgaits.certificate.chart import Chart
from neuralgaits.certificate.levels.walking_set.search import FLAT_ON_OTHER_FLOORS
from neuralgaits.certificate.provable import refuse_many_axes, why_not_of_beliefs, why_not_robust
from neuralgaits.certificate.run_certificate.friction_requirement import friction_needed
from neuralgaits.errors import InputError
from neuralgaits.gait.commands import Command
from neuralgaits.records.level_words import HIGHEST_OF_MANY, ORBIT_LEVEL, WALKING_SET_LEVEL
from neuralgaits.robots.mjcf.parameters import axes_of, box_of
from neuralgaits.robots.parameter_box import checked_box

Ranges = Mapping[str, tuple[float, float]]
"""Ranges (low, high) of commands, by name."""


@dataclass(frozen=True)
class Scope:
    """Scope of a proof of a run.

    Attributes:
        level: highest level.
        box: box of robots and floors, half widths by kind; empty for the robot of the file alone.
        within: narrower ranges of commands; None for all that the gait takes.
        spec: the run's, for the robots of the box.
        narrowed: spec with these ranges of its commands.
        chart: these ranges and the axes of the box.
    """

    level: int
    box: Mapping[str, float]
    within: Ranges | None
    spec: GaitSpec
    narrowed: GaitSpec
    chart: Chart

    @classmethod
    def of(
        cls, run: Run, level: int, within: Ranges | None, parameters: Mapping[str, float] | None
    ) -> "Scope":
        """Return the scope of `certify`'s options. Raises: InputError if no theorem covers them."""
        box = _box(run, parameters)
        errors = axes_of(run.robot, box) if box else ()
        _refuse_level(run, level, box)
        commands = commands_within(run, within or {})
        spec = replace(run.spec, parameters=errors)
        chart = Chart.of(commands, errors)
        return cls(level, box, within or None, spec, replace(spec, commands=commands), chart)

    @property
    def part(self) -> str | None:
        """Describe the part of the run's commands that it covers; None for all of them."""
        commands = self.spec.commands
        if self.chart.of_commands(len(commands)) == Chart.of(commands):
            return None
        return "; ".join(self.chart.sequences([c.name for c in commands]) or ())


def _box(run: Run, parameters: Mapping[str, float] | None) -> Mapping[str, float]:
    """Return the box of robots and floors. Raises: InputError if it cannot be proved."""
    spec = run.spec
    box_of_run = {**box_of(run.robot, spec.parameters), **spec.ground}
    box = box_of_run if parameters is None else checked_box(parameters)
    if why := why_not_of_beliefs(spec.commands, box):
        raise InputError(f"--parameters: expected parameters of the gait's robots, found {why}")
    if "friction" in box and not (need := friction_needed(spec.describe())) <= box["friction"]:
        has = (
            f"one that needs {need:g}" if need < np.inf else "one that does not say when feet slip"
        )
        raise InputError(
            f"expected a run that walks on a coefficient of friction of {box['friction']:g}, found "
            f"{has}; train one with --parameters friction={box['friction']:g}"
        )
    if "floor" in box and run.robot.feet is not None:
        raise InputError(f"--parameters: {FLAT_ON_OTHER_FLOORS}; leave floor out")
    if "floor" in box and spec.commands:
        raise InputError(
            "expected a gait without commands with a floor of unknown height, found one that "
            f"takes {', '.join(c.name for c in spec.commands)}: leave floor out"
        )
    axes = axes_of(run.robot, box)
    if not axes:
        return box
    if why := why_not_robust(run):
        raise InputError(
            f"expected a run that can be proved for a box of robots, found {why}; train one with "
            "--parameters"
        )
    refuse_many_axes(replace(spec, parameters=axes))
    return box


def _refuse_level(run: Run, level: int, box: Mapping[str, float]) -> None:
    """Refuse a level that no theorem covers. Raises: InputError."""
    if box and level > HIGHEST_OF_MANY:
        raise InputError(
            f"expected level 1, 2 or 3 for a box of robots, found {level}: the theorem of full "
            "order is about one robot; leave --level out, or give --parameters none, whose proof "
            "takes the place of the box's"
        )
    if "floor" in box and level < WALKING_SET_LEVEL:
        raise InputError(
            "expected level 2 or 3 with a floor of unknown height, found 1, which is about single "
            "states: raise --level, or leave floor out"
        )
    if run.robot.feet is not None and level > ORBIT_LEVEL:
        raise InputError(
            f"expected level 1, 2 or 3 for a robot on flat feet, found {level}: the theorem of "
            "full order is about point feet, since a flat foot whose joints are off their targets "
            "does not land flat; leave --level out"
        )
    if run.spec.commands and level > run.config.last_level:
        raise InputError(
            f"expected level 1, 2 or 3 for a gait with commands, found {level}: the theorem of "
            "full order is about one gait; leave --level out"
        )


def commands_within(run: Run, within: Ranges) -> tuple[Command, ...]:
    """Return the run's commands with these ranges. Raises: InputError on other names or ranges."""
    commands = run.spec.commands
    if within and not commands:
        raise InputError(
            f"expected a gait that takes commands with --within, found {run.path}, which takes "
            "none: leave it out"
        )
    if unknown := sorted(set(within) - {c.name for c in commands}):
        raise InputError(
            f"expected a command of {run.path}, {', '.join(c.name for c in commands)}, "
            f"found {unknown[0]}"
        )
    narrowed: list[Command] = []
    for c in commands:
        low, high = within.get(c.name, (c.low, c.high))
        if not c.low <= low < high <= c.high:
            degrees = c.in_degrees("{}:{}, and {}:{}", c.low, c.high, low, high)
            raise InputError(
                f"expected a range of {c.name} in {c.low:g}:{c.high:g} {c.unit}, "
                f"found {low:g}:{high:g}{degrees}"
            )
        change = c.largest_change
        if change is not None and change >= high - low:
            change = None
        narrowed.append(replace(c, low=low, high=high, largest_change=change))
    return tuple(narrowed)
