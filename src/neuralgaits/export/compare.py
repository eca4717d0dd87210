"""Compare C with Python: both get the same inputs; distances of the outputs are measured."""

import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from neuralgaits._types import Float
from neuralgaits.errors import InputError, MismatchError
from neuralgaits.export import build
from neuralgaits.export.cases import Cases, of_faults, of_guard, of_region
from neuralgaits.export.design import Design
from neuralgaits.export.drawn_states import steps_of
from neuralgaits.export.float_bound import largest_errors
from neuralgaits.export.reference import Reference, Results, policy_path, results_of
from neuralgaits.export.robot_programs import Part
from neuralgaits.records.exported import Agreement, ExportTolerance, FloatBound
from neuralgaits.records.link_figures import Percentiles

SEED = 20220117
STEP_TIME = "policy_step"
"""Name of the measured time for numbers that are computed once a step, in `c/check.c`."""


@dataclass(frozen=True, eq=False)
class Questions:
    """Inputs for C, and Python's answers to them.

    Attributes:
        cases: control ticks; those of the region come first.
        ticks: Python's results for them.
        points: z, dz, ddz of the policy, and numbers of a step. [N, 6 + s]
        policy: Python's results for them. [N, 4, m]
    """

    cases: Cases
    ticks: Results
    points: Float[np.ndarray, "N 6_plus_s"]
    policy: Float[np.ndarray, "N 4 m"]


def limits(design: Design, precision: str) -> ExportTolerance:
    """Return the largest errors that a build may have."""
    if precision == "double":
        return ExportTolerance(1e-12, 1e-12)
    # Largest torque error in single precision where the step's numbers are in single precision,
    # too: joint damping turns errors of desired rates into 0.01 N m of 41.
    step_torque = 5e-4
    torque = step_torque if design.commands else 5e-5
    is_narrow = max(design.gait.policy.hidden_widths or (), default=0) <= 64
    return ExportTolerance(2e-6 if is_narrow else 1e-5, torque)


def questions(design: Design, reference: Reference, states: int) -> Questions:
    """Draw the cases and compute Python's answers.

    Raises: InputError if the controller faults in every state of the region.
    """
    cases = Cases.joined(
        [of_region(design, states, SEED), of_guard(design, SEED), of_faults(design, SEED)]
    )
    ticks = reference.evaluate(cases)
    if np.all(ticks.fault[:states] != 0):
        raise InputError(
            f"expected a gait whose controller goes on in its region, found faults in all {states} "
            "states: the run's policy is damaged or not trained; restore it or train again"
        )
    return Questions(cases, ticks, *policy_questions(design, states))


def policy_questions(
    design: Design, states: int
) -> tuple[Float[np.ndarray, "N 6_plus_s"], Float[np.ndarray, "N 4 m"]]:
    """Draw z, dz and ddz of the region and compute Python's answers there, see `Questions`."""
    _, step = steps_of(design, states, SEED)
    points = np.concatenate([_around(design, step), step], axis=1)
    points = points.astype(np.float32).astype(np.float64)
    return points, policy_path(design, *np.split(points, [2, 4, 6], axis=1))


def model_questions(
    design: Design, states: int
) -> tuple[dict[str, Float[np.ndarray, "N ..."]], Float[np.ndarray, "N 2 m"]]:
    """Return inputs of the policy as one function, by name, and Python's y and dy there."""
    commands, step = steps_of(design, states, SEED)
    points = _around(design, step).astype(np.float32).astype(np.float64)
    z, dz, ddz = np.split(points, 3, axis=1)
    inputs_of_commands = {"commands": commands} if design.commands else {}
    return {"z": z, "dz": dz} | inputs_of_commands, policy_path(design, z, dz, ddz, step)[:, :2]


def _around(design: Design, step: Float[np.ndarray, "N s"]) -> Float[np.ndarray, "N 6"]:
    """Draw z, dz and ddz of the region, within the interval of each step. [N, 6]."""
    rng = np.random.default_rng(SEED)
    bounds, states = design.controller.bounds, len(step)
    lower, upper = (np.tile(bound, (states, 1)) for bound in (bounds.lower, bounds.upper))
    if design.commands:
        lower[:, 0], upper[:, 0] = step[:, 0], step[:, 1]
    z = rng.uniform(lower, upper)
    dz = rng.uniform([-0.5, -60.0], [1.5, 60.0], (states, 2))
    ddz = np.stack([np.zeros(states), rng.uniform(-400.0, 400.0, states)], axis=1)
    return np.concatenate([z, dz, ddz], axis=1)


def agree(design: Design, questions: Questions, program: Path, precision: str) -> Agreement:
    """Run a compiled controller on the same inputs. Raises: MismatchError if it is too far off."""
    with tempfile.TemporaryDirectory() as folder:
        cases, points = Path(folder) / "cases", Path(folder) / "points"
        questions.cases.records().tofile(cases)
        questions.points.tofile(points)
        rows = np.frombuffer(build.run(program, "compare", str(cases)))
        answers = np.frombuffer(build.run(program, "policy", str(points)))
    m = design.controller.robot.n - 1
    results = results_of(design, rows.reshape(questions.cases.count, -1))
    _same_decisions(design, questions, results)
    _same_steps(design, questions, results, precision)
    agreement = _distances(design, questions, results, answers.reshape(-1, 6, m))
    asking = limits(design, precision)
    worst = {
        "outputs": (max(agreement.output, agreement.rate), asking.output),
        "torques": (agreement.torque, asking.torque),
    }
    for name, (distance, limit) in worst.items():
        if not distance <= limit:
            raise MismatchError(
                f"C and Python disagree: expected {name} within {limit:g} of their range in "
                f"{precision} precision, found {distance:.3g}: do not use this controller"
            )
    build.run(program, "selftest")
    return agreement


def latency(questions: Questions, program: Path) -> dict[str, Percentiles]:
    """Measure times of calls (us): the policy alone, and whole control steps by law."""
    with tempfile.TemporaryDirectory() as folder:
        cases = Path(folder) / "cases"
        questions.cases.records().tofile(cases)
        text = build.run(program, "latency", str(cases)).decode()
    rows = [line.split() for line in text.splitlines()]
    return {name: Percentiles(float(p50), float(p99)) for name, p50, p99 in rows}


def float_bound(design: Design, rates: Part, questions: Questions) -> FloatBound:
    """Bound the error of y_d and its rate in single precision, over the whole region.

    For a family it bounds a few of its steps, whose numbers count as exact.

    Returns: `output` and `rate`, shares of their ranges.
    """
    bounds = design.controller.bounds
    dz = questions.points[:, 2:4]
    ranges = np.ptp(questions.policy, axis=0)
    rows = []
    cuts = {"z": (64, 32), "dz": (2, 2)}
    # Of a family's steps the first four are bounded.
    for step in questions.points[:4, 6:] if design.commands else [None]:
        lows = {"z": np.array(bounds.lower), "dz": dz.min(axis=0)}
        highs = {"z": np.array(bounds.upper), "dz": dz.max(axis=0)}
        if step is not None:
            lows["z"][0], highs["z"][0] = step[:2]
            lows["step"] = highs["step"] = step
        errors = largest_errors(rates.program, lows, highs, cuts)
        rows.append((np.max(errors["y"] / ranges[0]), np.max(errors["dy"] / ranges[1])))
    output, rate = np.max(rows, axis=0)
    return FloatBound(output=float(output), rate=float(rate))


def _same_decisions(design: Design, questions: Questions, results: Results) -> None:
    """Require equal faults, stance leg, touchdowns and clipping. Raises: MismatchError."""
    expected = questions.ticks
    going = expected.fault == 0
    limit = np.asarray(design.controller.torque_limit)
    # So close to a limit the two precisions may disagree about clipping.
    close = np.abs(np.abs(expected.actuated) - limit) < 1e-4 * limit
    sure = going & ~np.any(close, axis=1)
    checks = {"fault": slice(None), "leg": slice(None), "touchdown": going, "ticks": going}
    for name, where in (*checks.items(), ("saturated", sure)):
        wrong = np.flatnonzero(getattr(results, name)[where] != getattr(expected, name)[where])
        if wrong.size:
            raise MismatchError(
                f"C and Python disagree on {name} in {wrong.size} of {questions.cases.count} "
                "cases: "
                "do not use this controller, report it"
            )


def _same_steps(design: Design, questions: Questions, answers: Results, precision: str) -> None:
    """Require equal commands and numbers of the step after a tick. Raises: MismatchError."""
    expected, going = questions.ticks, questions.ticks.fault == 0
    # Largest error of a step's numbers, as a share of each one's range: an impact and Newton's
    # method lie between them and the commands.
    step_limits = {"double": 1e-11, "float": 1e-3}
    for name in ("requested", "before", "after", "step") if design.commands else ():
        one, other = (getattr(results, name)[going] for results in (answers, expected))
        # Errors are relative to the range of each number, or to this if it hardly varies.
        unit = np.maximum(np.ptp(other, axis=0), 1e-3)
        distance = float(np.max(np.abs(one - other) / unit))
        if not distance <= step_limits[precision]:
            raise MismatchError(
                f"C and Python disagree: expected {name} of a step within "
                f"{step_limits[precision]:g} of its range in {precision} precision, found "
                f"{distance:.3g}: do not use this controller"
            )


def _distances(
    design: Design, questions: Questions, results: Results, answers: Float[np.ndarray, "N 6 m"]
) -> Agreement:
    going = questions.ticks.fault == 0
    limit = np.max(np.asarray(design.controller.torque_limit))
    torque = np.abs(results.torque - questions.ticks.torque)
    torque = max(
        float(torque.max()), float(_apart(results.actuated, questions.ticks.actuated, going))
    )
    # The function for rates repeats y and dy.
    expected = np.concatenate([questions.policy, questions.policy[:, :2]], axis=1)
    gaps = np.max(np.abs(answers - expected), axis=0)
    ranges = np.ptp(expected, axis=0)
    # A policy of z1 alone may have an output that never moves.
    shares = np.max(gaps / np.where(ranges > 0.0, ranges, 1.0), axis=1)
    outputs = max(_apart(results.y_d, questions.ticks.y_d, going), float(gaps[[0, 4]].max()))
    return Agreement(
        output=float(max(shares[0], shares[4])),
        rate=float(max(shares[1], shares[5])),
        slope=float(max(shares[2], shares[3])),
        torque=torque / limit,
        absolute=max(torque, outputs, _apart(results.dy_d, questions.ticks.dy_d, going)),
    )


def _apart(values: np.ndarray, expected: np.ndarray, where: np.ndarray) -> float:
    return float(np.max(np.abs(values - expected)[where]))
