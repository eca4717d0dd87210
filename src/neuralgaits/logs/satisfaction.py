"""Conditions of a spec judged on measurements: on rows of logs, not on the zero dynamics.

Only quantities that a log knows are judged: posture, rates, torques, the swing foot and z, but
neither contact forces nor impulses. A barrier holds in a row if h >= 0 there.
"""

from collections.abc import Sequence
from functools import lru_cache, partial
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from neuralgaits._blocks import in_blocks
from neuralgaits._quick_jit import quick_filter_jit
from neuralgaits._types import Actuated, Array, Bool, Coordinates, Float
from neuralgaits.barriers import Gait, GaitSpec
from neuralgaits.barriers.conditions import AbstractCondition, Barrier, Pointwise
from neuralgaits.gait import Point, ZeroDynamics
from neuralgaits.gait.zero_coordinates import position_of
from neuralgaits.logs.strides import SETTLING_S
from neuralgaits.logs.walk_table import Log


class Satisfaction(NamedTuple):
    """Shares of the judged rows, all logs together."""

    rows: int
    """Number of judged rows: from SETTLING_S after each touchdown."""
    tube: float
    """Share of rows between the fences, and between start of the step and guard."""
    all: float
    """Share of rows in the tube in which every condition that a log can judge held as well."""
    conditions: dict[str, float]
    """Share of the rows at the phases of a condition's region in which the condition held."""


def satisfaction(logs: Sequence[Log], zd: ZeroDynamics, gait: Gait, spec: GaitSpec) -> Satisfaction:
    """Judge logged walks by the conditions their gait was trained for.

    Args:
        logs: walks of the robot's joints.
        zd: zero dynamics of the run's own model under the gait, which define z.
        gait: gait that walked.
        spec: its conditions; those on the guard and on the fences are left out.
    """
    settled = [log.only(_settled_rows(log)) for log in logs]
    parts = [np.concatenate([log.q, log.dq, log.tau], axis=1) for log in settled]
    rows = np.concatenate([np.zeros((0, 3 * zd.robot.n - 1)), *parts])
    torques = all(log.torques_logged for log in logs)
    conditions = _conditions_of_logs(zd, spec, torques)
    if not len(rows):
        return Satisfaction(0, 0.0, 0.0, {})
    judge = _judge_of(tuple(conditions))
    # Number of rows judged at once: one compiled shape for logs of any length.
    charts, satisfied = in_blocks(partial(judge, zd, gait), 2048, rows)
    phase, level = charts.T
    inside = (phase >= 0.0) & (phase <= 1.0) & (level >= 0.0) & (level <= 1.0)
    shares, good = {}, inside.copy()
    for column, condition in enumerate(conditions):
        due = _due(spec, condition, phase)
        good &= satisfied[:, column] | ~due
        if due.any():
            shares[condition.name] = float(np.mean(satisfied[due, column]))
    return Satisfaction(len(rows), float(np.mean(inside)), float(np.mean(good)), shares)


def _settled_rows(log: Log) -> Bool[np.ndarray, " k"]:
    """Select rows from SETTLING_S after the last change of the stance leg."""
    begins = np.concatenate([[True], log.stance[1:] != log.stance[:-1]])
    return log.t - np.maximum.accumulate(np.where(begins, log.t, -np.inf)) >= SETTLING_S


def _due(spec: GaitSpec, condition: AbstractCondition, phase: Float[np.ndarray, " k"]):
    """Select rows at the phases of a condition's region."""
    boxes = spec.regions[condition.region]
    return np.any([(phase >= box.low[0]) & (phase <= box.high[0]) for box in boxes], axis=0)


def _conditions_of_logs(
    zd: ZeroDynamics, spec: GaitSpec, torques: bool
) -> list[Pointwise | Barrier]:
    """Return the conditions on a region with area whose quantity a log knows."""
    judged = []
    for condition in spec.conditions:
        boxes = spec.regions[condition.region]
        curve = any(low == high for box in boxes for low, high in zip(*box, strict=True))
        if not curve and isinstance(condition, Pointwise | Barrier):
            if _is_logged(condition, zd, torques):
                judged.append(condition)
    return judged


def _is_logged(condition: Pointwise | Barrier, zd: ZeroDynamics, torques: bool) -> bool:
    """Return whether a condition reads only what a log knows: a point caches what it computes."""
    unknown: set[str] = set()

    def read(q: Coordinates, dq: Coordinates, torque: Actuated) -> Array:
        point = _measured(zd, q, dq, torque)
        if not torques:
            del vars(point)["torque"]
        # Fields that follow from the measured ones without the policy.
        derived = (
            *("theta", "foot", "foot_velocity", "foot_above_ground", "foot_lift_rate"),
            "centre_of_mass",
        )
        names = {*vars(point), *derived}
        value = condition.function(point)
        unknown.update(set(vars(point)) - names)
        return value

    still = jnp.zeros(zd.robot.n)
    jax.eval_shape(read, still, still, still[1:])
    return not unknown


def _measured(zd: ZeroDynamics, q: Coordinates, dq: Coordinates, torque: Actuated) -> Point:
    """Return the point data of a row: measured where a point of the zero dynamics computes."""
    point = zd.point(zd.coordinates.of(q, dq))
    dz = zd.coordinates.rate(q, dq)
    measured = ("q", "dq", "dz", "torque")  # Fields of a point's data that a log contains.
    vars(point).update(zip(measured, (q, dq, dz, torque), strict=True))
    return point


@lru_cache(maxsize=4)
def _judge_of(conditions: tuple[Pointwise | Barrier, ...]):
    """(zd, gait, rows [b, 3n - 1]) to charts [b, 2] and what holds [b, conditions]."""

    @quick_filter_jit
    def judge(zd: ZeroDynamics, gait: Gait, rows: Array) -> tuple[Array, Array]:
        n = zd.robot.n

        def one(values: Array) -> tuple[Array, Array]:
            q, dq, torque = jnp.split(values, [n, 2 * n])
            row = _measured(zd, q, dq, torque)
            satisfied = [jnp.all(condition.function(row) >= 0.0) for condition in conditions]
            chart = jnp.stack([gait.phase(position_of(row.z)), gait.level(row.z)])
            return chart, jnp.stack(satisfied)

        return jax.vmap(one)(rows)

    return judge
