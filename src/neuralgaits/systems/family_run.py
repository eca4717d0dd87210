"""Runs of families beside walkers: what was asked of a training, what came of it, a run, opened."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Annotated, Any

import jax
import numpy as np

from neuralgaits.errors import RunError
from neuralgaits.records.record import Count, Record, build, shape_of
from neuralgaits.records.training_config import Seed, Steps
from neuralgaits.runs import RunFolder, resolve
from neuralgaits.runs.json_files import refuse_misshapen
from neuralgaits.runs.names import CONFIG, ROBOT, TRAINING_SUMMARY, WEIGHTS
from neuralgaits.runs.shape import POSITIVE, whole
from neuralgaits.systems.trained_system import TrainedSystem

WIDEST_NETWORK = 256
"""Largest width of a hidden layer."""


@dataclass(frozen=True, eq=False, kw_only=True)
class FamilyConfig(Record):
    """Configuration of a training: `config.json`, without the entries that `runs` adds.

    Attributes:
        family: name of the family; a walker's run has no such field.
        robot, spec: names.
        seed: seed of weights and samples.
        steps: gradient steps.
    """

    family: str
    robot: str
    spec: str
    seed: Seed
    steps: Steps


@dataclass(frozen=True, eq=False, kw_only=True)
class NetworkConfig(FamilyConfig):
    """Configuration of a training of networks whose convergence is asked for.

    Attributes:
        width: width of the networks' hidden layer.
        rate: convergence rate that the family's conditions require.
    """

    width: Annotated[int, whole(1, WIDEST_NETWORK)]
    rate: Annotated[float, POSITIVE]

    def __post_init__(self) -> None:
        # A file may have it as a whole number.
        object.__setattr__(self, "rate", float(self.rate))


@dataclass(frozen=True, eq=False, kw_only=True)
class TrainedSummary(Record):
    """Result of `train`: `summary.json` of a run.

    Attributes:
        run, robot, spec, seed, steps: path of the run and what was requested.
        margins: smallest margin of each condition at fresh random states, in scales.
        samples: how many states.
        wall_s: elapsed time.
        proof: verdict of a proof after the training; None without one, and in the file.
    """

    run: str
    robot: str
    spec: str
    seed: int
    steps: int
    margins: Mapping[str, float]
    samples: Count
    wall_s: float
    proof: str | None = None

    @property
    def holds(self) -> bool:
        """Whether no sample breaks a condition."""
        return all(margin >= 0.0 for margin in self.margins.values())


@dataclass(frozen=True)
class FamilyRun:
    """A run with everything it came from.

    Attributes:
        system: the family's own part, a `TrainedSystem`; a `ProvedSystem` where it has proofs.
        folder: on disk.
        config: settings of the training.
        robot: the model.
        data: numbers of the robot file.
        controller: trained controller.
    """

    system: Any
    folder: RunFolder
    config: Any
    robot: Any
    data: Any
    controller: Any

    @property
    def path(self) -> Path:
        """Path of the run folder."""
        return self.folder.path

    @property
    def table(self) -> Any:
        """The run's conditions, a `ConditionTable`."""
        return self.system.table_of(self.config)

    @cached_property
    def summary(self) -> Any:
        """Summary of the training. Raises: RunError if it is damaged."""
        return self.system.summary.read(self.path / TRAINING_SUMMARY)


def open_family_run(system: TrainedSystem, run: str | Path) -> FamilyRun:
    """Open a finished run. Raises: RunError if it is none of this family, or damaged."""
    folder, family = resolve(run), system.family
    if folder.config.get("family") != family.name:
        raise RunError(f"expected the run of {family.words}, found another's at {folder.path}")
    refuse_misshapen(folder.config, shape_of(system.config), folder.path / CONFIG)
    config = build(system.config, folder.config)
    robot, data = system.read(folder.copy(ROBOT), config.robot)
    controller = folder.read_tree(WEIGHTS, system.untrained(config))
    refuse_odd_weights(controller, folder.path / WEIGHTS)
    system.refuse_controller(controller, folder.path / WEIGHTS)
    return FamilyRun(system, folder, config, robot, data, jax.tree.map(np.asarray, controller))


def refuse_odd_weights(controller: Any, file: Path) -> None:
    """Refuse weights that no training leaves. Raises: RunError."""
    largest = 1e6  # Largest magnitude of a weight that a training leaves.
    for leaf in jax.tree.leaves(controller):
        if not np.all(np.abs(np.asarray(leaf)) <= largest):
            raise RunError(
                f"expected weights of at most {largest:g} in {file}, found larger ones, or "
                "no numbers: the file was changed; train again"
            )
