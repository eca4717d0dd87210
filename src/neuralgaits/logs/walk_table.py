"""A walk as a table: one row a control tick, coordinates of the current stance leg."""

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace

import numpy as np

from neuralgaits._printable import counted
from neuralgaits._types import Bool, Float, Int


@dataclass(frozen=True, eq=False, repr=False)
class Log:
    """One walk, in SI units. k rows, n coordinates, m = n - 1 actuated joints.

    Coordinates, desired outputs and torques are given stance leg first.

    Attributes:
        t: time [s], strictly increasing. [k]
        stance: the stance leg, 0 or 1 in the order of the robot file. [k]
        q: measured coordinates [rad]. [k, n]
        dq: measured rates [rad/s]. [k, n]
        qd: desired outputs [rad]. [k, m]
        dqd: desired output rates [rad/s]. [k, m]
        tau: commanded joint torques [N m]. [k, m]
        pitch: absolute angle of the root link [rad]. [k]
        dpitch: its rate [rad/s]. [k]
        z: zero dynamics state as the controller measured it (m, kg m^2/s); None if the robot wrote
            none. [k, 2]
        z2_plant: angular momentum with the plant's own masses, without noise [kg m^2/s]; only a
            simulation knows it. [k]
        rows: number of each row in the source, counted from 1. [k]
        joint_names: names of the n coordinates.
        source: file, or the episode of a simulation: for messages.
        computed: description of the quantities that are computed because the file lacks them.
        torques_logged: whether `tau` was measured; it is zero if not.
    """

    t: Float[np.ndarray, " k"]
    stance: Int[np.ndarray, " k"]
    q: Float[np.ndarray, "k n"]
    dq: Float[np.ndarray, "k n"]
    qd: Float[np.ndarray, "k m"]
    dqd: Float[np.ndarray, "k m"]
    tau: Float[np.ndarray, "k m"]
    pitch: Float[np.ndarray, " k"]
    dpitch: Float[np.ndarray, " k"]
    z: Float[np.ndarray, "k 2"] | None
    z2_plant: Float[np.ndarray, " k"] | None
    rows: Int[np.ndarray, " k"]
    joint_names: tuple[str, ...]
    source: str
    computed: tuple[str, ...] = ()
    torques_logged: bool = True

    def __len__(self) -> int:
        """Return the number of rows."""
        return len(self.t)

    def __repr__(self) -> str:
        """Summarise in one line where the walk is from, and how long it is."""
        span = self.t[-1] - self.t[0] if len(self) else 0.0
        return f"<Log of {self.source}: {counted(len(self), 'row')}, {span:.4g} s>"

    @property
    def period_s(self) -> float:
        """Usual time between two rows [s]."""
        return float(np.median(np.diff(self.t)))

    def only(self, which: Bool[np.ndarray, " k"]) -> "Log":
        """Return the rows where `which` is true."""
        arrays = {
            field.name: value[which]
            for field in fields(self)
            if isinstance(value := getattr(self, field.name), np.ndarray)
        }
        return replace(self, **arrays)


Column = tuple[str, str]
"""Name and unit of a column."""


def columns(joint_names: Sequence[str], *, plant: bool) -> tuple[Column, ...]:
    """Return the columns of a log file in order; `plant` adds those that need a simulation."""
    every, actuated = joint_names, joint_names[1:]
    return (
        ("t", "s"),
        ("stance", "-"),
        *((f"q_{name}", "rad") for name in every),
        *((f"dq_{name}", "rad/s") for name in every),
        *((f"qd_{name}", "rad") for name in actuated),
        *((f"dqd_{name}", "rad/s") for name in actuated),
        *((f"tau_{name}", "N m") for name in actuated),
        ("z1", "m"),
        ("z2", "kg m^2/s"),
        ("pitch", "rad"),
        ("dpitch", "rad/s"),
        *((("z2_plant", "kg m^2/s"),) if plant else ()),
    )
