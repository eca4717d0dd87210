"""A finished run, opened: robot, spec, gait and what was measured."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import jax
from jaxtyping import PRNGKeyArray

from neuralgaits.analysis.learned import Learned
from neuralgaits.barriers import Gait, GaitSpec, specs
from neuralgaits.errors import RunError
from neuralgaits.gait import Residuals, ZeroDynamics
from neuralgaits.robots import PlanarBiped
from neuralgaits.robots.loader import robot_from_text
from neuralgaits.runs import RunFolder, plain, resolve
from neuralgaits.runs.folder import CONFIG, refuse_misshapen
from neuralgaits.runs.names import RESIDUAL, ROBOT, SPEC, START, WEIGHTS
from neuralgaits.runs.shape import NUMBER, TEXT, Shape, list_of, may, one_of, table_of, whole
from neuralgaits.runs.trained import trained

WIDEST, DEEPEST = 2**14, 16
"""Hidden layers that a config may ask for: what is more is damage, and would fill the memory."""
ASKED: Shape = {
    "robot": TEXT,
    "spec": TEXT,
    "seed": whole(0, 2**31 - 1),
    "init": one_of("posture", "random"),
    "hidden": may(list_of(whole(1, WIDEST), *range(1, DEEPEST + 1))),
    "steps": whole(1, 2**31 - 1),
    "described": {
        "recipe": {"learning_rate?": NUMBER, "samples?": table_of(NUMBER)},
        "conditions": list_of({"name": TEXT, "region": TEXT, "scale": NUMBER}),
    },
    "not_provable_because": may(TEXT),
    "certify?": may({"budget_s": may(NUMBER)}),
    "rate?": NUMBER,
    "disturbance?": may(list_of(NUMBER, 2)),
    "parent?": may(TEXT),
}
"""`config.json` of a run."""


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
        """What `train --json` printed. Raises: RunError if it is damaged."""
        return trained(self.folder)

    @cached_property
    def learned(self) -> Learned | None:
        """What the run was told of its robot beyond the model; None if nothing.

        Raises: RunError if the file is not as it was.
        """
        if RESIDUAL not in self.folder.config["copies"]:
            return None
        return Learned.read(self.folder.copied(RESIDUAL), self.robot)

    @property
    def residuals(self) -> Residuals:
        """Residuals of flow and reset that the run was trained with."""
        return Residuals() if self.learned is None else self.learned.residuals

    @property
    def zero_dynamics(self) -> ZeroDynamics:
        """The hybrid zero dynamics of the run's robot under its policy, residuals included."""
        return ZeroDynamics(self.robot, self.gait.policy, *self.residuals)


def open_run(run: "Run | str | Path") -> Run:
    """Open a finished run by path or as `latest`.

    Raises: RunError with one line if it is missing, unfinished, damaged or does not fit.
    """
    if isinstance(run, Run):
        return run
    folder = resolve(run)
    robot, spec = open_parts(folder)
    gait = folder.read_tree(WEIGHTS, _shaped(folder, spec))
    return Run(folder, robot, spec, gait)


def _shaped(folder: RunFolder, spec: GaitSpec) -> Gait:
    """A gait whose arrays have shapes and kinds but no values, which a run's weights fill.

    The values that training started from are left out: computing them takes a second. A user's own
    function may do with them what it likes, so it gets them.
    """
    if folder.config["spec"] not in specs.DESCRIPTIONS:
        return untrained(folder, spec)
    kept = {}

    def shapes(key):
        leaves, kept["structure"] = jax.tree.flatten(_new_gait(folder, spec, key))
        kept["leaves"] = leaves
        return [leaf for leaf in leaves if isinstance(leaf, jax.Array)]

    found = iter(jax.eval_shape(shapes, jax.eval_shape(jax.random.key, 0)))
    leaves = [next(found) if isinstance(leaf, jax.Array) else leaf for leaf in kept["leaves"]]
    return jax.tree.unflatten(kept["structure"], leaves)


def asked_of(folder: RunFolder) -> Mapping[str, Any]:
    """A run's config. Raises: RunError if it does not hold what a training asks for."""
    refuse_misshapen(folder.config, ASKED, folder.path / CONFIG)
    return folder.config


def open_parts(folder: RunFolder) -> tuple[PlanarBiped, GaitSpec]:
    """Robot and spec of a run, from the run's own copies."""
    config = asked_of(folder)
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
        differ = (key for key, value in found.items() if value != kept.get(key))
        part = next(differ, "fields")
        raise RunError(
            f"expected the spec the run was trained with, found other {part} in {name!r}: the run "
            "was trained from a GaitSpec that no file defines, or by another version; write the "
            "spec to FILE.py and train with --spec FILE.py:NAME"
        )
    return robot, spec


def untrained(folder: RunFolder, spec: GaitSpec) -> Gait:
    """The gait the run started from, before any posture steps."""
    config = folder.config
    gait = _new_gait(folder, spec, jax.random.key(config["seed"]))
    if START not in config["copies"]:
        return gait
    folder.copied(START)  # Refuses weights that were changed since.
    return folder.read_tree(START, gait)


def _new_gait(folder: RunFolder, spec: GaitSpec, key: PRNGKeyArray) -> Gait:
    hidden = None if folder.config["hidden"] is None else tuple(folder.config["hidden"])
    return spec.new_gait(key, folder.config["init"], hidden)
