"""A training before it has a folder: its settings are checked, and its untrained gait is made."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import jax

from neuralgaits._inputs import same_folder
from neuralgaits._printable import shown
from neuralgaits.analysis.run import Run, RunParts
from neuralgaits.analysis.walking_speeds import gait_doubt
from neuralgaits.barriers import GaitSpec, spec_file_errors, specs
from neuralgaits.barriers.commanded_spec import commands_of
from neuralgaits.barriers.spec import Init
from neuralgaits.certificate.provable import refuse_many_axes, refuse_untraceable, why_not_provable
from neuralgaits.errors import InputError, SpecError
from neuralgaits.gait.commands import LEAN, Commands
from neuralgaits.gait.policies.commanded_gait import AnyGait
from neuralgaits.records.training_config import Proving, Range, TrainingConfig
from neuralgaits.robots.parameter_box import checked_box
from neuralgaits.robots.robot_file import RobotFile
from neuralgaits.runs import RunFolder
from neuralgaits.runs.names import ROBOT, SPEC
from neuralgaits.settings import GaitSettings
from neuralgaits.workflows.planarise import robot_from


@dataclass(frozen=True)
class NewTraining:
    """Inputs of a training.

    Attributes:
        parts: the model, the conditions and the untrained gait.
        config: settings, which become the run's config.
        copies: contents of the input files that the run must be able to read again, by name.
    """

    parts: RunParts
    config: TrainingConfig
    copies: Mapping[str, str]

    def of_seed(self, seed: int) -> "NewTraining":
        """Return this training with other weights and samples."""
        gait = _new_gait(self.parts.spec, seed, self.config.init, self.config.hidden)
        parts = self.parts._replace(gait=gait)
        return replace(self, parts=parts, config=replace(self.config, seed=seed))

    def begun(self, root: Path, out: Path | None) -> Run:
        """Return the run of this training, with a folder of its own.

        Args:
            root: folder of the runs.
            out: path of the run folder; a new one below `root` if None.
        """
        name, seed = self.config.robot, self.config.seed
        folder = RunFolder.create(
            self.config, self.copies, name=name, seed=seed, root=root, out=out
        )
        return self.parts.in_folder(folder)


def new_training(
    settings: GaitSettings,
    seed: int,
    warn: Callable[[str], None] | None = None,
    *,
    certify: bool = False,
    budget: float | None = None,
) -> NewTraining:
    """Load the robot, check the settings against each other, and make the untrained gait.

    Args:
        settings: settings of the gait.
        seed: seed of weights and samples.
        warn: called with a line about what is unusual in the robot, or unlikely of the gait.
        certify: prove the conditions after training.
        budget: seconds for that; None for no limit.

    Raises: RobotError as `robot_from`, InputError on invalid combinations of settings.
    """
    robot = robot_from(settings.robot, settings.feet, settings.weld, warn)
    spec = "walking" if settings.spec is None else settings.spec
    if not isinstance(spec, str | GaitSpec):
        raise InputError(f"spec: expected a name, FILE.py:NAME or a GaitSpec, found {shown(spec)}")
    if isinstance(spec, str):
        spec = specs.for_robot(spec, robot)
    init, steps = settings.init or "posture", settings.steps
    speed, commands, box = _targets(settings)
    loaded = _loaded(spec, robot, commands, speed, box)
    _refuse_untrainable(loaded)
    refuse_many_axes(loaded)
    gait = _new_gait(loaded, seed, init, settings.hidden)
    if not (isinstance(spec, str) and spec in specs.BUILT_IN):
        # The built-in ones are traced by the tests.
        file = specs.source_path(spec) if isinstance(spec, str) else None
        refuse_untraceable(loaded, robot, gait, file)
    unprovable = why_not_provable(gait)
    if certify:
        _refuse_proof(loaded, unprovable)
    config = TrainingConfig(
        robot=robot.name,
        spec=spec if isinstance(spec, str) else spec.name,
        seed=seed,
        init=init,
        hidden=gait.policy.hidden_widths,
        steps=loaded.recipe.steps if steps is None else steps,
        described=loaded.describe(),
        not_provable_because=unprovable,
        certify=Proving(budget) if certify else None,
        commands=ranges_of(commands),
        speed=speed,
        parameters=box,
    )
    copies = {ROBOT: robot.layout.xml, SPEC: _source(spec)}
    doubt = gait_doubt(robot, settings.speed, settings.step_length)
    if doubt is not None and warn is not None:
        warn(doubt)
    return NewTraining(RunParts(robot, loaded, gait), config, copies)


@same_folder()
def _loaded(
    spec: str | GaitSpec,
    robot: RobotFile,
    commands: Commands,
    speed: float | None,
    box: dict[str, float],
) -> GaitSpec:
    """Return the spec for a robot and what its gait is meant for.

    Raises: InputError for a spec that is given whole, with something that a name would be told.
    """
    if isinstance(spec, str):
        return specs.load(spec, robot, commands, speed, box)
    if commands or speed is not None or box:
        raise InputError(
            "expected a spec by name with a speed, commands or parameters, found a GaitSpec: "
            "build it with specs.commanded or specs.robust"
        )
    return spec


def _targets(settings: GaitSettings) -> tuple[float | None, Commands, dict[str, float]]:
    """Return the one speed (m/s), the commands and the box of robots that a gait is meant for."""
    speed, speed_range = settings.speed, None
    if isinstance(speed, tuple):
        speed, speed_range = None, speed
    commands = commands_of(
        speed=speed_range,
        step_length=settings.step_length,
        step_height=settings.step_height,
        slope=settings.slope,
        lean=settings.lean,
    )
    if speed is not None and {command.name for command in commands} - {LEAN}:
        raise InputError(
            "expected one speed, or a range of it beside other commands, found --speed "
            f"{speed:g} with {', '.join(c.name for c in commands)}: give --speed LOW:HIGH"
        )
    return speed, commands, checked_box(settings.parameters or {})


def _refuse_untrainable(spec: GaitSpec) -> None:
    """Refuse a spec with nothing to train for, or a recipe of numbers that are none."""
    if not spec.conditions:
        raise SpecError(f"spec {spec.name!r}: expected at least one condition, found none: add one")
    for name, value in vars(spec.recipe).items():
        parts = value if isinstance(value, tuple) else (value,)
        if not all(math.isfinite(one) for one in parts if isinstance(one, float)):
            raise SpecError(f"spec {spec.name!r}: recipe.{name}: expected numbers, found {value}")
    if not spec.recipe.learning_rate > 0.0:
        raise SpecError(
            f"spec {spec.name!r}: recipe.learning_rate: expected a number above 0, "
            f"found {spec.recipe.learning_rate}"
        )


def _refuse_proof(spec: GaitSpec, unprovable: str | None) -> None:
    """Refuse a gait that cannot be trained until it is proved. Raises: InputError."""
    if spec.commands:
        raise InputError(
            "expected a gait without commands to train until it is proved, found one that "
            f"takes {', '.join(c.name for c in spec.commands)}: train without --certify, then "
            "certify the run"
        )
    if spec.parameters:
        raise InputError(
            "expected a gait for one robot to train until it is proved, found --parameters: "
            "train without --certify, then certify the run"
        )
    if unprovable is not None:
        raise InputError(f"expected a gait that can be certified, found that {unprovable}")


def ranges_of(commands: Commands) -> dict[str, Range]:
    """Return commands in the form of a run's config."""
    return {c.name: Range(c.low, c.high, c.largest_change) for c in commands}


def _new_gait(spec: GaitSpec, seed: int, init: Init, hidden: tuple[int, ...] | None) -> AnyGait:
    with same_folder(), spec_file_errors.blamed():
        return spec.new_gait(jax.random.key(seed), init, hidden)


def _source(spec: str | GaitSpec) -> str:
    """Return the file that defines the spec, or the name of a spec without a file."""
    if isinstance(spec, str):
        return specs.source_path(spec).read_text(encoding="utf-8")
    names = "".join(f"# {condition.name}\n" for condition in spec.conditions)
    return f"{specs.FILELESS_SPEC}, {spec.name!r}, in no file. Its conditions:\n{names}"
