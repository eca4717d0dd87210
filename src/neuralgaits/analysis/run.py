"""A run, opened: robot, spec, gait and summary."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import NamedTuple

import equinox as eqx
import jax
import numpy as np

from neuralgaits import _notebook
from neuralgaits._inputs import same_folder
from neuralgaits._quick_jit import quick_filter_jit
from neuralgaits._types import Array, Float
from neuralgaits.analysis.learned import LearnedResiduals
from neuralgaits.analysis.untrained_gait import gait_of_shapes
from neuralgaits.barriers import Gait, GaitSpec, specs
from neuralgaits.errors import RunError
from neuralgaits.gait import NO_RESIDUALS, AbstractPolicy, Residuals, ZeroDynamics
from neuralgaits.gait.believed_robot import robot_of_step
from neuralgaits.gait.commands import Command, Pair, values
from neuralgaits.gait.policies.commanded_gait import AnyGait, CommandedGait
from neuralgaits.gait.reset_residual import ResetCorrection
from neuralgaits.records.trained import TrainingSummary, trained_of
from neuralgaits.records.training_config import TrainingConfig, config_of
from neuralgaits.robots import PlanarBiped
from neuralgaits.robots.mjcf.loader import robot_from_text
from neuralgaits.runs import RunFolder, plain, resolve
from neuralgaits.runs.folder import CONFIG
from neuralgaits.runs.names import RESIDUAL, ROBOT, SPEC, WEIGHTS


@dataclass(frozen=True)
class Run:
    """A trained gait with everything it came from.

    Attributes:
        folder: folder of the run on disk.
        robot: the model it was trained on, from the run's own copy.
        spec: the conditions it was trained for.
        trained: policy and tube, or the family of them that takes commands; of an unfinished run,
            those that its training starts from.
        command: command at which a family is evaluated; None for the middle of its ranges.
    """

    folder: RunFolder
    robot: PlanarBiped
    spec: GaitSpec
    trained: AnyGait
    command: Mapping[str, float] | None = None

    def __repr__(self) -> str:
        """Return one line with folder, robot, spec and what was recorded of its conditions."""
        command = "" if self.command is None else f" at {dict(self.command)}"
        try:
            config, outcome = self.config, self._on_samples
        except RunError:
            # Whoever looks at it may be looking for what is wrong with it.
            return f"<Run {self.path}{command}: {self.robot.name}, files damaged>"
        about = f"{self.robot.name}, spec {config.spec}, seed {config.seed}"
        return f"<Run {self.path}{command}: {about}, {outcome}>"

    def _repr_html_(self) -> str:
        """Return an HTML summary for a notebook, with the tightest conditions."""
        try:
            conditions = self.summary.conditions
        except RunError as error:
            return _notebook.table(repr(self)[1:-1], [(error,)])
        measured = sorted(conditions.items(), key=lambda row: row[1].min_margin)
        rows = [
            (name, f"{conditions.min_margin:.3g}")
            for name, conditions in measured[: _notebook.TIGHTEST]
        ]
        head = (
            f"tightest of {len(measured)} conditions",
            "least margin recorded on samples, in scales",
        )
        return _notebook.table(repr(self)[1:-1], rows, head if rows else ())

    @property
    def _on_samples(self) -> str:
        """Return the recorded result: nobody measures it again here, and no hash covers it."""
        summary = self.summary
        if summary.left_out is not None:
            return summary.left_out
        count, broken = len(summary.conditions), len(summary.broken)
        outcome = f"all {count}" if not broken else f"{count - broken} of {count}"
        of = "" if summary.tied else ", of weights that the record does not name"
        when = "in training" if self.config.as_given is None else "when it was made"
        return f"recorded {when}: {outcome} conditions hold on fresh samples{of}"

    @cached_property
    def gait(self) -> Gait:
        """Policy and tube; for a family, those at the command. The result is cached."""
        if isinstance(self.trained, Gait):
            return self.trained
        return steady_gait(self.trained, self.robot, self.command, self.residuals.reset)

    def at(self, **command: float) -> "Run":
        """Return the run of a family at a constant command: an ordinary run of an ordinary gait.

        Raises: InputError on other names than the gait's commands, or values outside their range.
        """
        values(self.trained.commands, command)
        return replace(self, command=command)

    @property
    def policy(self) -> "AbstractPolicy | PolicyOfSteps":
        """The policy; for a family, its policies by commands: `policy.at(from_=..., to=...)`."""
        if isinstance(self.trained, Gait):
            return self.trained.policy
        return PolicyOfSteps(self.trained.policy, self.robot, self.residuals.reset)

    @property
    def path(self) -> Path:
        """Path of the run folder."""
        return self.folder.path

    @cached_property
    def config(self) -> TrainingConfig:
        """Settings with which the training was started."""
        return config_of(self.folder)

    @property
    def summary(self) -> TrainingSummary:
        """Summary that `train --json` printed; figures of other weights are left out.

        Raises: RunError if it is damaged.
        """
        return trained_of(self.path)

    @cached_property
    def learned(self) -> LearnedResiduals | None:
        """Corrections of the robot's model that the training used; None if there were none.

        Raises: RunError if the file is not as it was.
        """
        if RESIDUAL not in self.folder.copies:
            return None
        return LearnedResiduals.read(self.folder.copied(RESIDUAL), self.robot.n - 1)

    @property
    def residuals(self) -> Residuals:
        """Residuals of flow and reset that the run was trained with."""
        return NO_RESIDUALS if self.learned is None else self.learned.residuals

    @property
    def zero_dynamics(self) -> ZeroDynamics:
        """The hybrid zero dynamics of the run's robot under its policy, residuals included.

        The robot leans as it is told, if the gait is told that.
        """
        robot = robot_of_step(self.robot, self.gait, np.zeros(0))
        return ZeroDynamics(robot, self.gait.policy, *self.residuals)


LARGEST = 1e30
"""Limit on a policy's weights: beyond it nothing that is computed from them is finite."""
# Compiled once, not once a call.
_gait_at = quick_filter_jit(CommandedGait.at)
_policy_at = quick_filter_jit(
    lambda steps, pair: steps.family.at(steps.robot, pair, steps.reset_residual)
)


class PolicyOfSteps(eqx.Module):
    """Policies by the commands of their steps, for a robot: those of a family, or one for all."""

    family: AbstractPolicy
    robot: PlanarBiped
    reset_residual: ResetCorrection

    def at(self, from_: Mapping[str, float], to: Mapping[str, float]) -> AbstractPolicy:
        """Return the policy of one step.

        Args:
            from_: commands of the step before, by name.
            to: commands of this one.

        Raises: InputError on missing or other names, and values outside their range.
        """
        pair = Pair(*(values(self.family.commands, command) for command in (from_, to)))
        return jax.tree.map(np.asarray, _policy_at(self, pair))

    def parameters_of_step(self, pair: Pair) -> Float[Array, " s"]:
        """Return the parameters that a controller has for a step with these commands."""
        return self.family.parameters_of_step(self.robot, pair, self.reset_residual)


def steady_gait(
    family: CommandedGait,
    robot: PlanarBiped,
    command: Mapping[str, float] | None,
    reset_residual: ResetCorrection = None,
) -> Gait:
    """Return the gait of a family at a constant command; None for the middle of its ranges."""
    if command is None:
        command = {c.name: c.middle for c in family.commands}
    command_values = values(family.commands, command)
    v = [
        x for c, a in zip(family.commands, command_values, strict=True) for x in c.coordinates(a, a)
    ]
    gait = _gait_at(family, robot, np.array(v), reset_residual)
    return jax.tree.map(np.asarray, gait.steady_next)


class RunParts(NamedTuple):
    """Parts of a run beside its folder, see `Run`."""

    robot: PlanarBiped
    spec: GaitSpec
    gait: AnyGait

    def in_folder(self, folder: RunFolder) -> Run:
        """Return the run of these parts in a folder."""
        return Run(folder, *self)


def open_run(run: "Run | str | Path") -> Run:
    """Open a finished run by path or as `latest`.

    Raises: RunError with one line if it is missing, unfinished, damaged or does not fit.
    """
    if isinstance(run, Run):
        return run
    folder = resolve(run)
    robot, spec = open_parts(folder)
    gait = folder.read_tree(WEIGHTS, gait_of_shapes(folder, spec))
    arrays = map(np.asarray, jax.tree.leaves(gait))
    wrong = None
    if not all(np.all(np.abs(array) <= LARGEST) for array in arrays):
        wrong = f"weights of at most {LARGEST:g} in {folder.path / WEIGHTS}, found others"
    elif isinstance(gait, Gait) and not gait.tube.has_room:
        wrong = f"a region with room between its fences in {folder.path / WEIGHTS}, found none"
    if wrong is not None:
        remedy = "the run's policy is damaged or not trained; restore it or train again"
        raise RunError(f"expected {wrong}: {remedy}")
    return Run(folder, robot, spec, gait)


@same_folder()
def open_parts(folder: RunFolder) -> tuple[PlanarBiped, GaitSpec]:
    """Open robot and spec of a run, from the run's own copies."""
    config = config_of(folder)
    robot = robot_from_text(folder.copy(ROBOT), config.robot)
    name = config.spec
    if not specs.is_built_in(name):
        if ".py:" not in name:
            raise RunError(
                f"expected a built-in spec or FILE.py:NAME, found {name!r}: the run was trained "
                "from a GaitSpec that no file defines; write the spec to FILE.py and train with "
                "--spec FILE.py:NAME"
            )
        folder.copy(SPEC)  # Refuses a file that was changed after the run.
        name = f"{folder.path / SPEC}:{name.rpartition(':')[2]}"
    commands = tuple(
        Command(name, c.low, c.high, c.largest_change) for name, c in config.commands.items()
    )
    degree = None if config.given is None else config.given.degree
    spec = specs.load(name, robot, commands, config.speed, config.parameters, degree)
    described = plain(spec.describe())
    if described != config.described:
        differ = (key for key, value in described.items() if value != config.described.get(key))
        part = next(differ, "fields")
        why = f"{CONFIG} was altered, or is of another version; restore it or train again"
        if folder.copy(SPEC).startswith(specs.FILELESS_SPEC):
            why = (
                "the run was trained from a GaitSpec that no file defines; write the spec to "
                "FILE.py and train with --spec FILE.py:NAME"
            )
        raise RunError(
            f"expected the spec the run was trained with, found other {part} in {name!r}: {why}"
        )
    return robot, spec
