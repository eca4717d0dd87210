"""Write the table of inputs and outputs that can run on the target: `gait_selftest.h`."""

from dataclasses import replace

import numpy as np

from neuralgaits.control.safeguard import Fault
from neuralgaits.export.cases import NEVER, Cases, of_guard, of_region
from neuralgaits.export.design import Design
from neuralgaits.export.drawn_states import steady_steps
from neuralgaits.export.reference import Reference, Results
from neuralgaits.programs.c99.constant_arrays import literal


def selftest_file(design: Design, reference: Reference) -> str:
    """Return the text of the table: states of the region, touchdowns, and one fault."""
    cases = _cases(design, reference)
    results = reference.evaluate(cases)
    lines = [_line(cases, results, i) for i in range(cases.count)]
    return "\n".join(
        [
            "/* Inputs of one tick and what Python makes of them. Written by a program. */",
            f"#define NG_SELFTEST_LINES {cases.count}",
            "",
            "static const ng_selftest_line ng_selftest_lines[NG_SELFTEST_LINES] = {",
            ",\n".join(lines),
            "};",
            "",
        ]
    )


def _cases(design: Design, reference: Reference) -> Cases:
    seed = 20220117
    region, guard = of_region(design, 12, seed), of_guard(design, seed)
    touching = np.flatnonzero(reference.evaluate(guard).touchdown)
    count = 6
    some = touching[:: max(1, len(touching) // count)][:count]
    joined = Cases.joined([region, guard.take(some), region.take(np.zeros(1, dtype=int))])
    tipped = joined.pitch.copy()
    tipped[-1] = 2.0 * design.safeguard.largest_pitch
    count = joined.count
    zeros, joints = np.zeros((count, design.controller.robot.n - 1)), np.zeros(joined.joints.shape)
    rate = 2.0 * float(np.max(design.controller.torque_limit)) / design.safeguard.torque_swing_s
    return replace(
        joined,
        pitch=tipped,
        law=np.arange(count) % len(design.controllers),
        blend_s=np.full(count, design.safeguard.blend_s),
        torque_rate=np.full(count, rate),
        since=np.full(count, NEVER),
        ticks=np.zeros(count, dtype=int),
        running=np.zeros(count, dtype=int),
        elapsed=np.zeros(count),
        held_y=zeros,
        held_dy=zeros,
        held_slope=zeros,
        held_drift=zeros,
        posture=joints,
        torque=joints,
        **_steady_commands(design, joined),
    )


def _steady_commands(design: Design, cases: Cases) -> dict[str, np.ndarray]:
    """Return steps that begin at a command that has been constant for long."""
    first = cases.before
    # A table of C has no NaN.
    commands = np.where(np.isnan(cases.given), first, cases.given)
    steady = {"requested": first, "after": first, "step": steady_steps(design, first)}
    return steady | {"given": commands}


def _line(cases: Cases, results: Results, i: int) -> str:
    stopped = results.fault[i] != Fault.NONE
    outputs = [np.zeros_like(v[i]) if stopped else v[i] for v in (results.y_d, results.dy_d)]
    k = cases.joints.shape[2]
    joints, djoints, torque = (
        _rows(np.reshape(values, (2, k)))
        for values in (cases.joints[i], cases.djoints[i], results.torque[i])
    )
    encoders = ", ".join(
        [
            f".time_us = {cases.time_us[i]}u",
            f".pitch = {literal(cases.pitch[i])}",
            f".dpitch = {literal(cases.dpitch[i])}",
            f".base_velocity = {_row(cases.base_velocity[i])}",
            f".joints = {joints}",
            f".djoints = {djoints}",
            f".normal_force = {_row(cases.force[i])}",
        ]
    )
    columns = []
    if cases.before.size:
        columns = [
            f".begun = {_row(cases.before[i])}",
            f".told = {_row(cases.given[i])}",
        ]
    parts = [
        *columns,
        f".law = {cases.law[i]}, .leg = {cases.leg[i]}, .fault = (ng_fault){int(results.fault[i])}",
        f".encoders = {{{encoders}}}",
        f".y_d = {_row(outputs[0])}",
        f".dy_d = {_row(outputs[1])}",
        f".torque = {torque}",
    ]
    return "    {" + ",\n     ".join(parts) + "}"


def _row(values: np.ndarray) -> str:
    return "{" + ", ".join(literal(value) for value in values) + "}"


def _rows(values: np.ndarray) -> str:
    return "{" + ", ".join(_row(row) for row in values) + "}"
