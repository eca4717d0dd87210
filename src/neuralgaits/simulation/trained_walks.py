"""Walks of a trained gait, each on its own: a walk depends on its number, not on other walks.

So other processes can walk parts of them, and the results are put together again.
"""

from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import Any

import numpy as np

from neuralgaits._control_laws import names_of_laws
from neuralgaits.analysis.run import Run
from neuralgaits.control import AbstractLaw
from neuralgaits.control.command_belief import first_commands
from neuralgaits.control.controlled_gait import law_for
from neuralgaits.control.joint_model import JointModel
from neuralgaits.control.law_by_name import at_bandwidth, law_named
from neuralgaits.errors import InputError
from neuralgaits.robots.mjcf.drawn_robots import DrawnRobots
from neuralgaits.simulation.linked.remote import Remote
from neuralgaits.simulation.native.native_scene import knows
from neuralgaits.simulation.native_walk import Choice, WalkEngine, engine_of_trained
from neuralgaits.simulation.setup.command_schedule import CommandSchedule
from neuralgaits.simulation.setup.starts import full_states, momentum_range
from neuralgaits.simulation.simulators import MUJOCO, Simulator
from neuralgaits.simulation.ticks.falls import Ending
from neuralgaits.simulation.ticks.gauge import Extremes, Gauge, Milestone
from neuralgaits.simulation.ticks.lockstep import EpisodeBatch
from neuralgaits.simulation.ticks.stride_table import Strides
from neuralgaits.simulation.walk import Walk, WalkOptions, walk


@dataclass(frozen=True, eq=False, kw_only=True)
class TrainedWalks(WalkOptions):
    """Walks of a trained gait.

    Attributes:
        run: opened run, a family at the first command that is told.
        start: as in `simulate`.
        drawn: robots of a box in place of the plant, one for each walk.
        bandwidth: double pole of output errors under the law [rad/s]; its own if None.
    """

    run: Run
    start: str
    drawn: DrawnRobots | None = None
    bandwidth: float | None = None

    @cached_property
    def law(self) -> AbstractLaw:
        """Control law with what it keeps of the gait."""
        law = at_bandwidth(self.controller, self.bandwidth)
        return law_for(law, self.run.robot, self.run.trained, self.joints)

    @cached_property
    def _schedule(self) -> CommandSchedule | None:
        """Commands with those of the first step as adaptation begins, see `first_commands`."""
        if self.schedule is None or self.courses is not None:
            return self.schedule
        told = self.schedule.first
        first = first_commands(self.schedule.commands, told, self.adapt)
        return self.schedule if np.array_equal(first, told) else replace(self.schedule, first=first)

    def walk(
        self,
        first: int,
        count: int,
        *,
        record: bool = False,
        longest: int = 0,
        remote: Remote | None = None,
    ) -> Walk:
        """Walk numbers `first` to `first + count - 1`. Raises: InputError, NonFiniteError.

        Args:
            first: number of the first walk.
            count: number of walks.
            record: whether to keep records and states of the first.
            longest: keep records of the first so many ticks of every walk.
            remote: controller processes that give the torques in the law's place.
        """
        schedule = self._schedule
        run = self.run
        if schedule is not None and schedule is not self.schedule:
            run = at_first(run, schedule.first)
        gait = run.gait
        options = {one.name: getattr(self, one.name) for one in fields(WalkOptions)}
        options |= {"controller": self.law, "schedule": schedule}
        return walk(
            run.robot,
            run.trained.policy,
            full_states(
                run.zero_dynamics, gait, self.start, seed=self.seed, episodes=count, first=first
            ),
            robots=None if self.drawn is None else self.drawn.of(first, count),
            z2_range=momentum_range(run.trained),
            record=record,
            longest=longest,
            reset_residual=run.residuals.reset,
            remote=remote,
            first=first,
            **options,
        )


def at_first(run: Run, first: Any) -> Run:
    """Return a family's run at its first command, where its walks start."""
    commands = run.trained.commands
    if not commands:
        return run
    return run.at(**dict(zip((c.name for c in commands), map(float, first), strict=True)))


def walk_engine_for(
    run: Run,
    controller: str | AbstractLaw,
    choice: Choice | None,
    simulator: Simulator = MUJOCO,
    joints: JointModel | None = None,
) -> WalkEngine:
    """Return the loop that walks a run under a law.

    Args:
        run: the run.
        controller: law, by name or as an object.
        choice: `native` or `jax`; None for native where it works.
        simulator: simulator that steps the plants.
        joints: rotors and friction that torques are for.

    Raises: InputError if native was required and cannot be used.
    """
    law = law_named(controller)
    if simulator != MUJOCO:
        if choice == "native":
            raise InputError(
                f"--engine native: expected --simulator {MUJOCO}, found {simulator}, which the "
                "loop in JAX walks: leave --engine out"
            )
        return WalkEngine(None, None)
    if knows(law):
        return engine_of_trained(run, choice, joints)
    if choice == "native":
        raise InputError(
            f"--engine native: expected {names_of_laws(compiled=True)}, found a law of type "
            f"{type(law).__name__}"
        )
    return WalkEngine(None, None)


def to_arrays(result: Walk) -> dict[str, np.ndarray]:
    """Return the results of walks as arrays with a row a walk, without records."""
    episodes = result.episodes
    endings = [int(ending) for ending in episodes.endings]
    arrays: dict[str, np.ndarray] = {"endings": np.array(endings, np.int32)}
    for name, value in episodes.gauge._asdict().items():
        parts = value._asdict() if hasattr(value, "_asdict") else {"": value}
        arrays |= {f"gauge.{name}.{part}": np.asarray(x) for part, x in parts.items()}
    arrays["plant_steps"] = np.array([episodes.plant_steps])
    if result.commands:
        lengths = [len(one.time) for one in episodes.strides]
        arrays["strides"] = np.array(lengths, np.int64)
        for name in Strides._fields:
            column = [getattr(one, name) for one in episodes.strides]
            arrays[f"strides.{name}"] = np.concatenate(column)
    return arrays


def from_arrays(parts: list[dict[str, np.ndarray]], wall_s: float) -> EpisodeBatch:
    """Join the results of walks in parts, in order.

    Args:
        parts: arrays from `to_arrays`.
        wall_s: time of all parts [s].
    """
    whole = {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}
    kinds = {"first": Milestone, "last": Milestone, "steady": Extremes, "running": Extremes}

    def figure(name: str) -> Any:
        if name not in kinds:
            return whole[f"gauge.{name}."]
        return kinds[name](*(whole[f"gauge.{name}.{part}"] for part in kinds[name]._fields))

    strides: list[Strides] = []
    if "strides" in whole:
        ends = np.cumsum(whole["strides"])
        columns = [np.split(whole[f"strides.{name}"], ends[:-1]) for name in Strides._fields]
        strides = [Strides(*one) for one in zip(*columns, strict=True)]
    return EpisodeBatch(
        [Ending(value) for value in whole["endings"].tolist()],
        Gauge(*(figure(name) for name in Gauge._fields)),
        None,
        np.array([]),
        np.array([]),
        int(whole["plant_steps"].sum()),
        wall_s,
        [],
        strides,
    )
