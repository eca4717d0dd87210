"""Compare the monitor in C with the Programs that it is written from, on states around its sets."""

import tempfile
from pathlib import Path
from typing import NamedTuple

import numpy as np

from neuralgaits._types import Float
from neuralgaits.analysis.state_monitor import StateMonitor
from neuralgaits.errors import MismatchError
from neuralgaits.export import build
from neuralgaits.export.design import Design
from neuralgaits.export.drawn_states import drawn_commands, lifted
from neuralgaits.gait.commands import Pair
from neuralgaits.records.exported import MonitorBuild
from neuralgaits.records.link_figures import Percentiles

SOURCES = (*build.CORE, "monitor.c", "monitor_set.c")
"""Files of a controller with a monitor that run on the robot."""
CHECKED = (*SOURCES, "check_monitor.c")
STATES = 20_000
"""Random states on which `export` compares."""
SEED = 20261126
EDGES = {"double": 1e-12, "float": 1e-2}
"""Distance from an edge of a set within which answers may differ, at least that of the margins. In
single precision the strips before phase 0 and behind phase 1 are narrower than a phase's digits."""


class MonitorCases(NamedTuple):
    """States of a robot, and the steps that they are in. N rows each."""

    q: Float[np.ndarray, "N n"]
    dq: Float[np.ndarray, "N n"]
    before: Float[np.ndarray, "N p"]
    after: Float[np.ndarray, "N p"]
    step: Float[np.ndarray, "N s"]

    def inputs(self, monitor: StateMonitor) -> dict[str, np.ndarray]:
        """Return the inputs of the sets, by name."""
        names = ("q", "dq", "before", "after", "step") if monitor.commands else ("q", "dq")
        return {name: getattr(self, name) for name in names}

    def rows(self) -> Float[np.ndarray, "N k"]:
        """Return the records that `c/check_monitor.c` reads."""
        return np.ascontiguousarray(np.hstack(self))


class MonitorAnswers(NamedTuple):
    """Answers about N states, from C or from Python."""

    inside: np.ndarray
    """Whether the state is in the set of each level. [N, levels]"""
    margin: np.ndarray
    """Smallest margin of each level's set. [N, levels]"""
    nearest: np.ndarray
    """Place of the smallest margin's name, for each level. [N, levels]"""
    margins: list[np.ndarray]
    """All margins of each set. [N, k]"""
    admissible: np.ndarray
    """Whether each state's step is an admissible one. [N]"""


def drawn_cases(design: Design, count: int, seed: int = SEED) -> MonitorCases:
    """Draw states in the sets, outside and next to their fences, of admissible steps."""
    rng = np.random.default_rng(seed)
    m = design.controller.robot.n - 1
    phase = rng.uniform(-0.1, 1.1, count)
    level = rng.uniform(-0.3, 1.3, count)
    close = rng.integers(0, 2, count) + rng.normal(size=count) * 10.0 ** rng.uniform(-15, -1, count)
    level = np.where(rng.uniform(size=count) < 0.3, close, level)
    # From a hundredth of a milliradian to more than any proved error.
    size = 10.0 ** rng.uniform(-5.0, -0.5, (count, 1))
    eta = rng.normal(size=(count, 2 * m)) * size * np.repeat([1.0, 30.0], m)
    if design.commands:
        pair, _ = drawn_commands(design, count, rng)
    else:
        pair = Pair(np.zeros((count, 0)), np.zeros((count, 0)))
    x, _, _, step = lifted(design, np.stack([phase, level], axis=1), eta, pair)
    q, dq = np.split(np.asarray(x), 2, axis=1)
    backwards = rng.uniform(size=(count, 1)) < 0.02
    before, after = map(np.asarray, pair)
    return MonitorCases(q, np.where(backwards, -dq, dq), before, after, np.asarray(step))


def python_answers(monitor: StateMonitor, cases: MonitorCases) -> MonitorAnswers:
    """Return what the monitor's Programs say of each case, in Python."""
    margins = [one.margins(**cases.inputs(monitor)) for one in monitor.sets]
    places = [monitor.sets.index(monitor.set_of(level)) for level in monitor.levels]
    memberships = [monitor.sets[k].membership(margins[k]) for k in places]
    return MonitorAnswers(
        np.stack([one.inside for one in memberships], axis=1),
        np.stack([one.margin for one in memberships], axis=1),
        np.stack([one.nearest for one in memberships], axis=1),
        margins,
        monitor.admissible(cases.before, cases.after),
    )


def c_answers(monitor: StateMonitor, cases: MonitorCases, program: Path) -> MonitorAnswers:
    """Ask a compiled monitor. Raises: MismatchError if it fails."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "cases"
        cases.rows().tofile(file)
        rows = np.frombuffer(build.run(program, "compare", str(file))).reshape(len(cases.q), -1)
    levels = len(monitor.levels)
    answers = rows[:, : 3 * levels].reshape(-1, levels, 3)
    each = max(len(one.names) for one in monitor.sets)
    parts = [
        rows[:, 3 * levels + k * each :][:, : len(one.names)] for k, one in enumerate(monitor.sets)
    ]
    return MonitorAnswers(
        answers[:, :, 0] > 0.5,
        answers[:, :, 1],
        answers[:, :, 2].astype(int),
        parts,
        rows[:, -1] > 0.5,
    )


def distance(answers: MonitorAnswers, expected: MonitorAnswers) -> float:
    """Return the largest distance of any margin m, in units of 1 + |m|."""
    worst = 0.0
    for one, other in zip(answers.margins, expected.margins, strict=True):
        same = np.isnan(one) & np.isnan(other)
        apart = np.where(same, 0.0, np.abs(one - other) / (1.0 + np.abs(other)))
        worst = max(worst, float(np.max(np.where(np.isnan(apart), np.inf, apart))))
    return worst


def disagreements(
    monitor: StateMonitor, answers: MonitorAnswers, expected: MonitorAnswers, limit: float
) -> int:
    """Count answers that differ farther than `limit` from where they may.

    Answers may differ for a margin within `limit` of an edge, names for two margins within it of
    each other; ends of a step begin to count at an edge.
    """
    wrong = int(np.sum(answers.admissible != expected.admissible))
    for k, level in enumerate(monitor.levels):
        one = monitor.set_of(level)
        margins = expected.margins[monitor.sets.index(one)]
        ends = margins[:, : len(one.ends)]
        close = np.abs(expected.margin[:, k]) <= limit
        wrong += int(np.sum((answers.inside[:, k] != expected.inside[:, k]) & ~close))
        other = np.take_along_axis(margins, answers.nearest[:, k : k + 1], axis=1)[:, 0]
        spare = limit * (1.0 + np.abs(expected.margin[:, k]))
        tie = np.abs(other - expected.margin[:, k]) <= 2.0 * spare
        tie |= np.any(np.abs(ends) <= limit, axis=1)
        wrong += int(np.sum((answers.nearest[:, k] != expected.nearest[:, k]) & ~tie))
    return wrong


def check_monitor(
    design: Design, folder: Path, compilers: list[str], count: int = STATES
) -> tuple[MonitorBuild, ...]:
    """Compile the monitor with every compiler in both precisions, compare, and time it.

    Args:
        design: design with a monitor.
        folder: its files, with those of the exporter.
        compilers: names of programs.
        count: number of states.

    Raises: MismatchError if it does not compile, calls a library, or answers otherwise.
    """
    monitor = design.monitor
    assert monitor is not None
    cases = drawn_cases(design, count)
    expected = python_answers(monitor, cases)
    problems = []
    # Largest distance of a margin m from Python's, in units of 1 + |m|: that of narrow tubes, and
    # of sets of small errors. AMBER-3M's is 2e-12, and 1e-3 in single precision.
    limits = {"double": 1e-8, "float": 0.1}
    for compiler in compilers:
        for precision, defines in build.PRECISIONS.items():
            flags = (*build.PLAIN, *defines)
            core = build.inspect(compiler, folder, flags, SOURCES)
            if core.foreign or core.static_bytes:
                raise MismatchError(
                    "expected a monitor that calls no library and keeps no memory, found "
                    f"{', '.join(core.foreign) or 'no calls'} and {core.static_bytes} bytes: "
                    "report it"
                )
            program = build.build(compiler, folder, "check_monitor", CHECKED, flags)
            answers = c_answers(monitor, cases, program)
            far = distance(answers, expected)
            edge = max(EDGES[precision], min(far, limits[precision]))
            wrong = disagreements(monitor, answers, expected, edge)
            if wrong or not far <= limits[precision]:
                raise MismatchError(
                    f"C and Python disagree: expected one answer about {count} states in "
                    f"{precision} precision, found {wrong} that differ, margins apart by "
                    f"{far:.3g}: do not use this monitor, report it"
                )
            times = latency(cases, program)
            problems.append(MonitorBuild(compiler, precision, far, times[:-1], times[-1]))
    return tuple(problems)


def latency(cases: MonitorCases, program: Path) -> tuple[Percentiles, ...]:
    """Measure the time of the margins of each set, then of a whole answer [us]."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "cases"
        cases.rows().tofile(file)
        text = build.run(program, "latency", str(file)).decode()
    rows = [line.split() for line in text.splitlines()]
    return tuple(Percentiles(float(p50), float(p99)) for _, p50, p99 in rows)
