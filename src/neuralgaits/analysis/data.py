"""Data from which figures of a gait are drawn: arrays by name, and names of their rows.

P phases, L levels, A and B grid lines, T nodes, c conditions, b barriers, n coordinates, m joints.
Margins are in scales of their conditions, NaN where a condition does not apply.

chart/   phase [P], level [L], z [L, P, 2], margins [c, L, P], barriers [b, L, P]
plane/   z1 [A], z2 [B], dz and nominal_dz [B, A, 2], barriers [b, B, A], foot [B, A]
fences/  z1 [P], z2 [2, P]
guard/   z and z_after [L, 2]
map/     z2 and z2_after [N]
orbit/   t [T], z [T, 2], q and dq [T, n], torque [T, m], force, foot and foot_velocity [T, 2],
         skeleton [T, points, 2], margins [c, T], barriers [b, T],
         numbers [4]: z2 at mid-step, multiplier, period [s], step length [m]
walks/   z [K, 2]: two walks that start at the fences, NaN between pieces
robot/   torque_limit [m], mass [], gravity [], leg_length [], friction []
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from neuralgaits._types import Float


class OrbitNumbers(NamedTuple):
    """Key figures of the periodic orbit."""

    z2: float
    """Momentum z2 at mid-step, z1 = 0 [kg m^2/s]."""
    multiplier: float
    """Slope of the Poincare map [1]."""
    period_s: float
    """Duration of a step [s]."""
    step_length_m: float
    """Distance between two footholds [m]."""


@dataclass(frozen=True)
class GaitData:
    """A gait in arrays.

    Attributes:
        arrays: see the words of this file.
        conditions, barriers: names, in the order of the arrays.
        described: the spec's conditions as plain data, in the same order.
        joints: names of the actuated joints.
        torso: whether the robot has one.
        residual: whether dz differs from nominal_dz.
    """

    arrays: Mapping[str, np.ndarray]
    conditions: tuple[str, ...]
    barriers: tuple[str, ...]
    described: tuple[Mapping[str, Any], ...]
    joints: tuple[str, ...]
    torso: bool
    residual: bool

    def __getitem__(self, name: str) -> np.ndarray:
        """Return the array of that name."""
        return self.arrays[name]

    @property
    def periodic(self) -> bool:
        """Whether the gait has a periodic orbit."""
        return len(self.arrays["orbit/t"]) > 0

    @property
    def numbers(self) -> OrbitNumbers:
        """Key figures of the orbit; NaN if there is none."""
        return OrbitNumbers(*(float(value) for value in self.arrays["orbit/numbers"]))

    def row_at(self, share: float) -> int:
        """Return the orbit's row that is nearest to a share of the step's time."""
        t = self.arrays["orbit/t"]
        return int(np.argmin(np.abs(t - share * t[-1])))

    def limits(self, quantity: str) -> tuple[float | None, float | None]:
        """Return the lower and the upper bound that conditions set on a quantity, None if unset."""
        values: list[float | None] = []
        for side in ("at_least", "at_most"):
            bounds = [entry["bound"] for entry in self.bounds(side, quantity)]
            values.append(next((float(bound) for bound in bounds if np.ndim(bound) == 0), None))
        return values[0], values[1]

    def bounds(self, function: str, of: str | None = None) -> list[Mapping[str, Any]]:
        """Quantities of the conditions that read a function, as in ("at_least", "torso_angle")."""
        quantities = [c["quantity"] for c in self.described if "quantity" in c]
        return [
            quantity
            for quantity in quantities
            if quantity.get("function") == function
            and (of is None or (quantity.get("of") or {}).get("function") == of)
        ]


@dataclass(frozen=True)
class MeasuredWalk:
    """A logged walk. k rows, m joints.

    Attributes:
        source: name of the program or log that it is from.
        t: time [s]. [k]
        z: state as the controller measured it. [k, 2]
        q, desired: actuated joint angles, measured and desired [rad]. [k, m]
        torque: commanded [N m]. [k, m]
        skeleton: points of the robot from its first stance foot [m]. [k, points, 2]
        step: number of the step each row belongs to, from 0. [k]
    """

    source: str
    t: Float[np.ndarray, " k"]
    z: Float[np.ndarray, "k 2"]
    q: Float[np.ndarray, "k m"]
    desired: Float[np.ndarray, "k m"]
    torque: Float[np.ndarray, "k m"]
    skeleton: Float[np.ndarray, "k points 2"]
    step: np.ndarray

    @property
    def last_step(self) -> np.ndarray:
        """Return the rows of the last finished step."""
        return np.flatnonzero(self.step == max(int(self.step[-1]) - 1, 0))


@dataclass(frozen=True)
class ResidualData:
    """A learned residual over the plane.

    Attributes:
        gait: gait of the policy that walked or was trained with it.
        epsilon: residual of dz on the gait's plane (m/s, N m). [B, A, 2]
        visited: logged states it was learned from; none if the logs are gone. [K, 2]
        trained: whether the policy was trained with it.
    """

    gait: GaitData
    epsilon: Float[np.ndarray, "B A 2"]
    visited: Float[np.ndarray, "K 2"]
    trained: bool
