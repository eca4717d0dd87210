"""Run the Python controller on the cases: the reference side of every comparison."""

from dataclasses import fields, replace
from functools import partial
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from neuralgaits._blocks import in_blocks
from neuralgaits._quick_jit import quick_filter_jit, quick_jit
from neuralgaits._types import Array
from neuralgaits.control import ControllerState, step, tell
from neuralgaits.control.command_state import CommandState
from neuralgaits.control.controller import Controller
from neuralgaits.control.law import Desired
from neuralgaits.control.measurement import Measurement
from neuralgaits.control.safeguard import Fault, SafeguardConfig, SafeguardState, check, guard
from neuralgaits.control.touchdown import StanceState
from neuralgaits.export.cases import NEVER, Cases
from neuralgaits.export.design import Design
from neuralgaits.export.programs import path
from neuralgaits.gait.commands import Pair


class Results(NamedTuple):
    """Results of a tick, in the order of `write_result` in `c/check.c`; N rows."""

    fault: np.ndarray
    leg: np.ndarray
    touchdown: np.ndarray
    saturated: np.ndarray
    since: np.ndarray
    ticks: np.ndarray
    elapsed: np.ndarray
    airborne: np.ndarray
    z: np.ndarray
    y_d: np.ndarray
    dy_d: np.ndarray
    actuated: np.ndarray
    torque: np.ndarray
    motors: np.ndarray
    requested: np.ndarray
    before: np.ndarray
    after: np.ndarray
    step: np.ndarray


def results_of(design: Design, rows: np.ndarray) -> Results:
    """Split rows that C wrote into `Results`."""
    m = design.controller.robot.n - 1
    p = len(design.commands)
    joints = 2 * design.leg_joints
    sizes = [p, p, p, design.gait.policy.step_size]
    scalars = 8  # Columns of `Results` that are one number a case.
    widths = [1] * scalars + [2, m, m, m, joints, joints, *sizes]
    parts = np.split(rows, np.cumsum(widths)[:-1], axis=1)
    return Results(*(part[:, 0] for part in parts[:scalars]), *parts[scalars:])


class Reference:
    """Python side of a design, compiled once for a fixed number of rows."""

    def __init__(self, design: Design):
        """Prepare a design; compilation waits for the first use."""
        self._design = design

    def evaluate(self, cases: Cases) -> Results:
        """Run the controller and its safeguard on every case."""
        parts, order = [], []
        for number, controller in enumerate(self._design.controllers.values()):
            which = np.flatnonzero(cases.law == number)
            if which.size:
                order.append(which)
                # One size of block: another would compile the code again.
                parts.append(in_blocks(partial(self._some, controller, cases), 4096, which))
        back = np.argsort(np.concatenate(order))
        return Results(*(np.concatenate(columns)[back] for columns in zip(*parts, strict=True)))

    def _some(self, controller: Controller, cases: Cases, which: np.ndarray) -> Results:
        """Run some of the cases, as many as the code is compiled for."""
        some = cases.take(which)
        arrays = {field.name: getattr(some, field.name) for field in fields(some)}
        safeguard = self._design.safeguard
        ticks = _ticks(controller, safeguard, arrays, some.measurement(self._design))
        rows = {name: np.asarray(column) for name, column in ticks.items()}
        result = Results(**{name: column.astype(np.float64) for name, column in rows.items()})
        torque = result.torque.reshape(len(which), -1)
        gears = np.reshape(self._design.controller.robot.layout.gears, -1)
        return result._replace(torque=torque, motors=torque / gears)


def policy_path(
    design: Design, z: np.ndarray, dz: np.ndarray, ddz: np.ndarray, step: np.ndarray
) -> np.ndarray:
    """Return outputs, rates, slopes and drift of the policy at numbers of a step. [N, 4, m]."""

    @quick_jit
    @jax.vmap
    def ask(*points):
        answers = path(design.gait.policy)(*points)
        return jnp.stack([answers[name] for name in ("y", "dy", "slope", "drift")])

    return np.asarray(ask(z, dz, ddz, step))


@quick_filter_jit
def _ticks(
    controller: Controller,
    safeguard: SafeguardConfig,
    cases: dict[str, Array],
    measurements: Measurement,
) -> dict[str, Array]:
    """Run the guarded tick on many cases; gaits of one structure share a compilation."""

    def tick(case: dict[str, Array], measurement: Measurement) -> dict[str, Array]:
        state = ControllerState(
            StanceState(case["leg"].astype(jnp.int32), case["since"]),
            case["ticks"].astype(jnp.int32),
            Desired(case["held_y"], case["held_dy"], case["held_slope"], case["held_drift"]),
            CommandState(case["requested"], Pair(case["before"], case["after"]), case["step"]),
        )
        state = tell(controller, state, case["given"])
        safe = SafeguardState(
            case["running"] != 0,
            1e-6 * case["last_us"],
            case["elapsed"],
            case["posture"],
            case["torque"],
            case["airborne"],
            case["fault"].astype(jnp.int32),
        )
        swing = 2.0 * jnp.max(controller.torque_limit) / case["torque_rate"]
        config = replace(safeguard, blend_s=case["blend_s"], torque_swing_s=swing)
        return _tick(controller, config, state, safe, measurement)

    return jax.vmap(tick)(cases, measurements)


def _tick(
    controller: Controller,
    config: SafeguardConfig,
    state: ControllerState,
    safe: SafeguardState,
    measurement: Measurement,
) -> dict[str, Array]:
    """Return columns of `Results`; after a fault only torque, leg and fault have a meaning."""
    safe, fault = check(controller, config, safe, measurement)
    after, command = step(controller, state, measurement)
    safe, torque = guard(controller, config, safe, measurement, command)
    stopped = fault != Fault.NONE
    return dict(
        fault=fault,
        leg=jnp.where(stopped, state.stance.leg, command.leg),
        touchdown=command.touchdown,
        saturated=command.saturated,
        since=jnp.minimum(command.since_touchdown, NEVER),
        ticks=after.ticks_to_policy,
        elapsed=safe.elapsed,
        airborne=safe.airborne,
        z=command.z,
        y_d=command.y_d,
        dy_d=command.dy_d,
        actuated=command.actuated,
        torque=torque,
        motors=torque,
        requested=after.commands.requested,
        before=after.commands.pair.before,
        after=after.commands.pair.after,
        step=after.commands.step_parameters,
    )
