"""Runs of cart-poles: what was asked of a training, and a run, opened."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Annotated, Any, Literal

import jax
import numpy as np

from neuralgaits.errors import RunError
from neuralgaits.records.record import Count, Record, build, shape_of
from neuralgaits.records.training_config import Seed, Steps
from neuralgaits.runs import RunFolder, resolve
from neuralgaits.runs.json_files import refuse_misshapen
from neuralgaits.runs.names import CONFIG, ROBOT, SUMMARY, WEIGHTS
from neuralgaits.runs.shape import POSITIVE, whole
from neuralgaits.systems.cartpole.balancing import Controller
from neuralgaits.systems.cartpole.cartpole_data import CartPoleData
from neuralgaits.systems.cartpole.cartpole_model import CartPole
from neuralgaits.systems.cartpole.ellipsoid import Ball
from neuralgaits.systems.cartpole.mjcf import read_cartpole
from neuralgaits.systems.cartpole.velocity_policy import Controls, ErrorDecay, VelocityPolicy

FAMILY = "cartpole"
SPEC_NAME = "balancing"
WIDEST = 256
LARGEST_WEIGHT = 1e6
LEAST_WIDTH = 1e-9
"""Least half width of the set along each of its axes (SI units)."""


@dataclass(frozen=True, eq=False, kw_only=True)
class CartPoleConfig(Record):
    """Configuration of a training: `config.json`, without the entries that `runs` adds.

    Attributes:
        family: of the system; a walker's run has no such field.
        robot, spec: names.
        seed: of weights and samples.
        steps: gradient steps.
        width: of the network's hidden layer.
        rate: required decay of the ellipsoid's radius [1/s].
    """

    family: Literal["cartpole"] = FAMILY
    robot: str
    spec: Literal["balancing"] = SPEC_NAME
    seed: Seed
    steps: Steps
    width: Annotated[int, whole(1, WIDEST)]
    rate: Annotated[float, POSITIVE]


@dataclass(frozen=True, eq=False, kw_only=True)
class CartPoleTrained(Record):
    """Result of `train`: `summary.json` of a run.

    Attributes:
        run, robot, spec, seed, steps: of the run.
        margins: smallest margin of each condition at fresh random states, in scales.
        samples: how many states.
        widths: half widths of the set's projections on x, theta and their rates (SI units).
        volume: of the set [m^2 rad^2/s^2].
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
    widths: tuple[float, ...]
    volume: float
    wall_s: float
    proof: str | None = None

    @property
    def holds(self) -> bool:
        """Whether no sample breaks a condition."""
        return all(margin >= 0.0 for margin in self.margins.values())


@dataclass(frozen=True)
class CartPoleRun:
    """A run with everything it came from.

    Attributes:
        folder: on disk.
        config: what was asked.
        robot: the model.
        data: numbers of the robot file.
        controller: policy and set.
    """

    folder: RunFolder
    config: CartPoleConfig
    robot: CartPole
    data: CartPoleData
    controller: Controller

    @property
    def path(self) -> Path:
        """Path of the run folder."""
        return self.folder.path

    @cached_property
    def summary(self) -> CartPoleTrained:
        """Summary of the training. Raises: RunError if it is damaged."""
        return CartPoleTrained.read(self.path / SUMMARY)


def is_cartpole_run(folder: RunFolder) -> bool:
    """Return whether a run folder is of this family."""
    return folder.config.get("family") == FAMILY


def open_cartpole(run: str | Path) -> CartPoleRun:
    """Open a finished run. Raises: RunError if it is none of this family, or damaged."""
    folder = resolve(run)
    if not is_cartpole_run(folder):
        raise RunError(f"expected the run of a cart-pole, found another's at {folder.path}")
    refuse_misshapen(folder.config, shape_of(CartPoleConfig), folder.path / CONFIG)
    config = build(CartPoleConfig, folder.config)
    config = replace(config, rate=float(config.rate))
    robot, data = read_cartpole(folder.copy(ROBOT), config.robot)
    controller = folder.read_tree(WEIGHTS, untrained(config.width))
    refuse_odd_weights(controller, folder)
    refuse_no_ellipsoid(controller, folder)
    return CartPoleRun(folder, config, robot, data, jax.tree.map(np.asarray, controller))


def refuse_odd_weights(controller: Controller, folder: RunFolder) -> None:
    """Refuse weights that no training leaves. Raises: RunError."""
    for leaf in jax.tree.leaves(controller):
        if not np.all(np.abs(np.asarray(leaf)) <= LARGEST_WEIGHT):
            raise RunError(
                f"expected weights of at most {LARGEST_WEIGHT:g} in {folder.path / WEIGHTS}, found "
                "larger ones, or no numbers: the file was changed; train again"
            )


def refuse_no_ellipsoid(controller: Controller, folder: RunFolder) -> None:
    """Refuse weights whose ball is no lower triangular matrix: its radius is solved for by rows.

    Raises: RunError.
    """
    shape = np.asarray(controller.ball.shape)
    if not np.array_equal(shape, np.tril(shape)) or not np.all(np.diag(shape) >= LEAST_WIDTH):
        raise RunError(
            f"expected a lower triangular matrix with a diagonal of {LEAST_WIDTH:g} or more for "
            f"the set in {folder.path / WEIGHTS}, found another: the file was changed; train again"
        )


def untrained(width: int) -> Controller:
    """Return a controller of zeros, to read arrays into."""
    policy = VelocityPolicy(np.zeros(3), np.zeros((width, 3)), np.zeros(width), np.zeros(3))
    decay = ErrorDecay(np.zeros(()), np.zeros((width, 4)), np.zeros(width), np.zeros(4))
    return Controller(Controls(policy, decay), Ball(np.zeros((4, 4))))


def widths(controller: Controller) -> tuple[float, ...]:
    """Return half widths of the set's projections on the four coordinates."""
    return tuple(float(x) for x in np.linalg.norm(np.asarray(controller.ball.shape), axis=1))


def volume(controller: Controller) -> float:
    """Return the set's volume in (x, theta, x', theta')."""
    return float(0.5 * np.pi**2 * np.prod(np.diag(np.asarray(controller.ball.shape))))


def arrays_of(controller: Controller) -> Mapping[str, Mapping[str, Any]]:
    """Return the arrays of policy, decay and ball, whose Program calls them OWNER.NAME."""
    policy, decay = controller.controls.policy, controller.controls.decay
    names = ("hidden", "output", "scale")
    return {
        "controls.policy": {name: getattr(policy, name) for name in ("gains", *names)},
        "controls.decay": {name: getattr(decay, name) for name in ("base", *names)},
        "ball": {"shape": controller.ball.shape},
    }
