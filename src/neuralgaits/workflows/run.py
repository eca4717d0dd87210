"""A finished run, opened: robot, spec, gait and what was measured."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import jax

from neuralgaits.barriers import Gait, GaitSpec, specs
from neuralgaits.errors import RunError
from neuralgaits.gait import ZeroDynamics
from neuralgaits.robots import PlanarBiped
from neuralgaits.robots.loader import robot_from_text
from neuralgaits.runs import RunFolder, plain, resolve

WEIGHTS, STATE, ROBOT, SPEC, PROGRAM = (
    "policy.safetensors",
    "state.safetensors",
    "robot.xml",
    "spec.py",
    "program.json",
)


@dataclass(frozen=True)
class Run:
    """A trained gait with everything it came from.

    Attributes:
        folder: on disk.
        robot: the model it was trained on, from the run's own copy.
        spec: the conditions it was trained for.
        gait: policy and tube.
    """

    folder: RunFolder
    robot: PlanarBiped
    spec: GaitSpec
    gait: Gait

    @property
    def path(self) -> Path:
        """The run folder."""
        return self.folder.path

    @property
    def summary(self) -> dict[str, Any]:
        """What `train --json` printed."""
        return self.folder.summary

    @property
    def zero_dynamics(self) -> ZeroDynamics:
        """The hybrid zero dynamics of the run's robot under its policy."""
        return ZeroDynamics(self.robot, self.gait.policy)


def open_run(run: "Run | str | Path") -> Run:
    """Open a finished run by path or as `latest`.

    Raises: RunError with one line if it is missing, unfinished, damaged or does not fit.
    """
    if isinstance(run, Run):
        return run
    folder = resolve(run)
    robot, spec = open_parts(folder)
    gait = folder.read_tree(WEIGHTS, untrained(folder, spec))
    return Run(folder, robot, spec, gait)


def open_parts(folder: RunFolder) -> tuple[PlanarBiped, GaitSpec]:
    """Robot and spec of a run, from the run's own copies."""
    config = folder.config
    robot = robot_from_text(folder.copy(ROBOT), config["robot"])
    name = config["spec"]
    if name not in specs.DESCRIPTIONS:
        if ".py:" not in name:
            raise RunError(
                f"expected a built-in spec or FILE.py:NAME, found {name!r}: the run was trained "
                "from a GaitSpec that no file defines; write the spec to FILE.py and train with "
                "--spec FILE.py:NAME"
            )
        folder.copy(SPEC)  # Refuses a file that was changed after the run.
        name = f"{folder.path / SPEC}:{name.rpartition(':')[2]}"
    spec = specs.load(name, robot)
    found = plain(spec.describe())
    kept = config.get("described") or {}
    if found != kept:
        part = next(key for key, value in found.items() if value != kept.get(key))
        raise RunError(
            f"expected the spec the run was trained with, found other {part} in {name!r}: the run "
            "was trained from a GaitSpec that no file defines, or by another version; write the "
            "spec to FILE.py and train with --spec FILE.py:NAME"
        )
    return robot, spec


def untrained(folder: RunFolder, spec: GaitSpec) -> Gait:
    """The gait the run started from, before any posture steps."""
    config = folder.config
    hidden = None if config["hidden"] is None else tuple(config["hidden"])
    return spec.new_gait(jax.random.key(config["seed"]), config["init"], hidden)
