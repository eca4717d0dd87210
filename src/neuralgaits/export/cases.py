"""Draw states and readings on which C and Python are compared, as one record of numbers each.

Every number is exact in single precision, so both builds get the same inputs.
"""

from collections.abc import Iterator
from dataclasses import dataclass, fields, replace

import jax
import jax.numpy as jnp
import mujoco
import numpy as np

from neuralgaits._quick_jit import quick_jit
from neuralgaits._types import Array, Float, Int
from neuralgaits.control.measurement import Measurement, coordinates
from neuralgaits.control.safeguard import Fault, joint_ranges
from neuralgaits.export.design import Design
from neuralgaits.export.drawn_states import drawn_commands, lifted, single
from neuralgaits.robots.mjcf_state import StateMap

NEVER = 1e30
"""Time since the last touchdown while there is none yet [s], as `NG_NEVER`."""


@dataclass(frozen=True, eq=False)
class Cases:
    """N cases; the fields are in the order of a record, see `read_case` in `c/check.c`."""

    law: Int[np.ndarray, " N"]
    blend_s: Float[np.ndarray, " N"]
    torque_rate: Float[np.ndarray, " N"]
    leg: Int[np.ndarray, " N"]
    since: Float[np.ndarray, " N"]
    ticks: Int[np.ndarray, " N"]
    running: Int[np.ndarray, " N"]
    last_us: Int[np.ndarray, " N"]
    elapsed: Float[np.ndarray, " N"]
    airborne: Float[np.ndarray, " N"]
    fault: Int[np.ndarray, " N"]
    time_us: Int[np.ndarray, " N"]
    pitch: Float[np.ndarray, " N"]
    dpitch: Float[np.ndarray, " N"]
    held_y: Float[np.ndarray, "N m"]
    held_dy: Float[np.ndarray, "N m"]
    held_slope: Float[np.ndarray, "N m"]
    held_drift: Float[np.ndarray, "N m"]
    posture: Float[np.ndarray, "N 2 k"]
    torque: Float[np.ndarray, "N 2 k"]
    base_velocity: Float[np.ndarray, "N 2"]
    force: Float[np.ndarray, "N 2"]
    joints: Float[np.ndarray, "N 2 k"]
    djoints: Float[np.ndarray, "N 2 k"]
    given: Float[np.ndarray, "N p"]
    requested: Float[np.ndarray, "N p"]
    before: Float[np.ndarray, "N p"]
    after: Float[np.ndarray, "N p"]
    step: Float[np.ndarray, "N s"]

    @property
    def count(self) -> int:
        """Number N of test cases in the set."""
        return len(self.law)

    def records(self) -> Float[np.ndarray, "N c"]:
        """Return the cases as an array with one row each."""
        columns = [getattr(self, field.name).reshape(self.count, -1) for field in fields(self)]
        return np.ascontiguousarray(np.concatenate(columns, axis=1), dtype=np.float64)

    def take(self, which: Array) -> "Cases":
        """Return the cases that an index selects."""
        return Cases(**{field.name: getattr(self, field.name)[which] for field in fields(self)})

    @staticmethod
    def joined(parts: "list[Cases]") -> "Cases":
        """Join several sets, one after the other."""
        names = [field.name for field in fields(Cases)]
        return Cases(**{n: np.concatenate([getattr(p, n) for p in parts]) for n in names})

    def measurement(self, design: Design) -> Measurement:
        """Return the readings in the signs and zeros of the theory, as a simulation has them."""
        layout = design.controller.robot.layout
        turn = layout.pitch_sign * self.pitch
        dpitch = layout.pitch_sign * self.dpitch
        with np.errstate(invalid="ignore"):  # NaN and infinities are among the cases.
            _, arm_slope = layout.hip_arm(turn, np)
            hip_velocity = self.base_velocity + dpitch[:, None] * arm_slope
        signs = np.array(layout.leg_joint_signs)
        return Measurement(
            time=1e-6 * self.time_us,
            pitch=turn + layout.root_angle,
            dpitch=dpitch,
            angles=signs * self.joints + np.array(layout.leg_joint_offsets),
            rates=signs * self.djoints,
            hip_velocity=hip_velocity,
            normal_force=self.force,
        )


def of_region(design: Design, count: int, seed: int) -> Cases:
    """Draw random states of the gait's region and around it, mostly well tracked."""
    rng = np.random.default_rng(seed)
    inside = rng.uniform(size=(count, 2))
    around = np.stack([rng.uniform(-0.1, 1.1, count), rng.uniform(-0.3, 1.3, count)], axis=1)
    chart = np.where(rng.uniform(size=count)[:, None] < 0.85, inside, around)
    cases = _cases_at(design, chart, rng)
    away = _clear(design, cases)
    return replace(cases, force=np.where(away[:, None], cases.force, 0.0))


def of_guard(design: Design, seed: int) -> Cases:
    """Draw switches of the stance leg: every combination of conditions that it depends on."""
    weight = float(design.controller.robot.mass * design.controller.robot.gravity)
    stance = design.controller.stance
    combinations = np.array(
        np.meshgrid(
            [0.3, 0.5, 1.0],  # phase: the swing foot is behind, beside, ahead
            np.linspace(0.0, 1.0, 4),
            [0, 1],
            [0.0, 0.8 * stance.force_share, 1.2 * stance.force_share],
            [0.0, 0.5 * stance.lockout_s, 1.5 * stance.lockout_s, NEVER],
            [0, 1],
            range(len(design.controllers)),
            indexing="ij",
        )
    ).reshape(7, -1)
    phase, level, leg, share, since, ticks, law = combinations
    rng = np.random.default_rng(seed)
    cases = _cases_at(design, np.stack([phase, level], axis=1), rng, leg.astype(int))
    force = np.where(np.arange(2) == leg[:, None], weight, share[:, None] * weight)
    return replace(
        cases,
        force=single(force),
        since=single(since),
        ticks=ticks.astype(int),
        law=law.astype(int),
    )


def of_faults(design: Design, seed: int) -> Cases:
    """Draw readings that must stop the robot, and neighbours of them that must not."""
    chart = np.full((1, 2), 0.5)
    base = _cases_at(design, chart, np.random.default_rng(seed), np.zeros(1, dtype=int))
    base = replace(base, time_us=base.last_us + 1000, running=np.ones(1, dtype=int))
    cases = [base]
    for name, flat, values in _spoils(design):
        for value in values:
            column = getattr(base, name).astype(np.float64).copy()
            column.reshape(-1)[flat] = value
            cases.append(replace(base, **{name: column}))
    safe = design.safeguard
    for gap in (1000, 0.9e6 * safe.gap_s, 1.1e6 * safe.gap_s, 0, -1000):
        cases.append(replace(base, time_us=base.last_us + round(gap)))
    for share in (0.9, 1.1):
        longest = np.full(1, share * safe.airborne_s)
        cases.append(replace(base, airborne=single(longest), force=np.zeros((1, 2))))
    cases += [replace(base, fault=np.full(1, int(fault))) for fault in Fault]
    return Cases.joined(cases)


def _spoils(design: Design) -> Iterator[tuple[str, int, list[float]]]:
    """Return columns of a reading, the place in them, and values to put there."""
    safe, layout = design.safeguard, design.controller.robot.layout
    weight = float(design.controller.robot.mass * design.controller.robot.gravity)
    low, high = (np.asarray(limit) for limit in joint_ranges(design.controller.robot))
    bad = [np.nan, np.inf, -np.inf, 1e6, -1e6, 1e-40]

    def around(bound: float) -> list[float]:
        return [factor * bound for factor in (0.9, 1.1, -0.9, -1.1)]

    yield "pitch", 0, bad + around(safe.largest_pitch)
    yield "dpitch", 0, bad + around(safe.largest_rate)
    for i in range(2):
        yield "base_velocity", i, bad + around(safe.largest_speed)
        yield "force", i, bad + around(safe.force_share * weight)
    signs, offsets = np.array(layout.leg_joint_signs), np.array(layout.leg_joint_offsets)
    for i, (lower, upper) in enumerate(zip(low.reshape(-1), high.reshape(-1), strict=True)):
        edge = safe.angle_margin
        angles = np.array([lower - edge - 0.05, lower - edge + 0.05, upper + edge + 0.05])
        yield "joints", i, bad + list((angles - offsets.reshape(-1)[i]) * signs.reshape(-1)[i])
        yield "djoints", i, bad + around(safe.largest_rate)


def _cases_at(
    design: Design,
    chart: Float[np.ndarray, "N 2"],
    rng: np.random.Generator,
    leg: Int[np.ndarray, " N"] | None = None,
) -> Cases:
    """Return cases at chart points, with all other numbers drawn."""
    robot, count = design.controller.robot, len(chart)
    m = robot.n - 1
    k, weight = design.leg_joints, float(robot.mass * robot.gravity)
    limit = np.asarray(design.controller.torque_limit)
    leg = rng.integers(0, 2, count) if leg is None else leg
    # Largest drawn tracking errors [rad], [rad/s]: three times those of walks under `pd`.
    eta = rng.uniform(-1.0, 1.0, (count, 2 * m)) * np.repeat([0.05, 0.5], m)
    pair, previous = drawn_commands(design, count, rng)
    x, outputs, slopes, step = lifted(design, chart, eta, pair)
    q, dq = np.split(x, 2, axis=1)
    foot_velocity = rng.uniform(-0.05, 0.05, (count, 2))
    state_map = StateMap.build(mujoco.MjModel.from_xml_string(robot.layout.xml), robot.layout)
    qpos, qvel = state_map.to_mjcf(q, dq, leg, (0.0, 0.0), foot_velocity)
    stands = np.arange(2) == leg[:, None]
    swinging = rng.uniform(0.0, 0.5, (count, 1)) * (rng.uniform(size=(count, 1)) < 0.3)
    force = weight * np.where(stands, rng.uniform(0.3, 1.5, (count, 1)), swinging)
    time_us = rng.integers(0, 2**31, count)
    blend_s = np.where(rng.uniform(size=count) < 0.7, 0.0, 0.25)
    rate_limit = np.where(rng.uniform(size=count) < 0.5, 1e9, 1e4)  # 1e9 N m/s never binds.
    joints = qpos[:, state_map.joints]
    away = rng.uniform(-0.05, 0.05, (count, 2, k))
    signs = np.array(robot.layout.leg_joint_signs)
    offsets = np.array(robot.layout.leg_joint_offsets)
    return Cases(
        law=rng.integers(0, len(design.controllers), count),
        blend_s=blend_s,
        torque_rate=rate_limit,
        leg=leg,
        since=single(np.where(rng.uniform(size=count) < 0.3, NEVER, rng.uniform(0, 0.6, count))),
        ticks=rng.integers(0, 2, count),
        running=(rng.uniform(size=count) < 0.9).astype(int),
        last_us=time_us - 1000,
        elapsed=single(rng.uniform(0.0, 0.24, count) * (blend_s > 0.0)),
        airborne=np.zeros(count),
        fault=np.zeros(count, dtype=int),
        time_us=time_us,
        pitch=single(qpos[:, state_map.root[2]]),
        dpitch=single(qvel[:, state_map.root[2]]),
        held_y=single(outputs + rng.uniform(-0.01, 0.01, outputs.shape)),
        held_dy=single(dq[:, 1:] + rng.uniform(-0.1, 0.1, outputs.shape)),
        held_slope=single(slopes),
        held_drift=single(rng.uniform(-20.0, 20.0, outputs.shape)),
        posture=single(signs * joints + offsets + away),
        torque=single(rng.uniform(-1.0, 1.0, (count, 2, k)) * np.min(limit)),
        base_velocity=single(qvel[:, state_map.root[:2]]),
        force=single(force),
        joints=single(joints),
        djoints=single(qvel[:, state_map.joints]),
        before=np.asarray(pair.before),
        after=np.asarray(pair.after),
        step=single(step),
        **previous,
    )


def _clear(design: Design, cases: Cases) -> np.ndarray:
    """Return the cases in which rounding decides nothing in the stance machine. [N]."""
    robot, stance = design.controller.robot, design.controller.stance

    @quick_jit
    @jax.vmap
    def ahead(measurement, leg):
        q, _ = coordinates(robot, measurement, leg)
        return robot.swing_foot(q)[0]

    measurement = jax.tree.map(jnp.asarray, cases.measurement(design))
    foot = np.asarray(ahead(measurement, jnp.asarray(cases.leg)))
    # Distance of a drawn number from any threshold [m], [s], so that rounding decides nothing.
    clearance = 1e-4
    near = np.abs(foot - stance.advance_share * robot.leg_length) < clearance
    late = cases.since + design.controller.period_s - stance.lockout_s
    near |= np.abs(late) < clearance
    weight = float(robot.mass * robot.gravity)
    swing = cases.force[np.arange(cases.count), 1 - cases.leg]
    return ~near & (np.abs(swing - stance.force_share * weight) > clearance)
