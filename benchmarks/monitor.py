"""The monitor: C against Python and the certificate's functions, its cost, and walks it watches.

Asked: on 10^6 states in, out of and next to the proved sets of levels 2, 4 and 5 the same answers,
but within 1e-12 of an edge; at most 1 us for level 2 and 5 us for levels 4 and 5. Walks: share of
ticks in each set under `pd` and `fblin`, which nothing asks for. Environment: STATES, STEPS.
"""

import shutil
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Literal

import jax
import jax.numpy as jnp
import numpy as np
from common import show, trained, whole

from neuralgaits.analysis.run import Run, open_run
from neuralgaits.analysis.state_monitor import StateMonitor
from neuralgaits.certificate.run_certificate.proved_monitor import monitor_of
from neuralgaits.certificate.run_certificate.verified_summary import read_certificate
from neuralgaits.control import Fblin
from neuralgaits.export import build
from neuralgaits.export.monitor_check import (
    EDGES,
    SOURCES,
    MonitorAnswers,
    MonitorCases,
    c_answers,
    disagreements,
    distance,
    drawn_cases,
    latency,
    python_answers,
)
from neuralgaits.gait import ZeroDynamics
from neuralgaits.workflows.certify import certify
from neuralgaits.workflows.export import design_of
from neuralgaits.workflows.simulate import simulate

STATES = whole("STATES", 1_000_000)
STEPS = whole("STEPS", 50)
AT_ONCE = 50_000
BANDWIDTH = 50.0
"""Of the proof's outputs [rad/s]: that of the longest proved hold."""
ASKED_US = {2: 1.0, 4: 5.0}


def main() -> None:
    """Print every row."""
    run = certified()
    monitor = monitor_of(run)
    assert monitor is not None
    _compared(run, monitor)
    for law in ("pd", "fblin", Fblin(bandwidth=BANDWIDTH)):
        _watched(run, law, "fixed-point")
        _watched(run, law, "region")


def certified() -> Run:
    """The gait of seed 0, proved to level 5 now or by an earlier call."""
    run = trained("amber3m", 0)
    proved = run.path.with_name(f"{run.path.name}-level-5")
    if not (proved / "certificate" / "summary.json").is_file():
        shutil.rmtree(proved, ignore_errors=True)
        shutil.copytree(run.path, proved)
        certify(proved, level=5, bandwidth=BANDWIDTH)
    return open_run(proved)


def _compared(run: Run, monitor: StateMonitor) -> None:
    """C, the Programs and the certificate's own functions about the same states."""
    from support.monitored import compiled, theorem_margins, tube_margins

    design = replace(design_of(run), monitor=monitor)
    theorems = getattr(read_certificate(run.folder).proof, "theorems", None)
    assert theorems is not None and theorems.walking is not None and theorems.full is not None
    phi = jax.jit(jax.vmap(ZeroDynamics(run.robot, run.gait.policy).phi))
    with TemporaryDirectory() as folder:
        program = compiled(Path(folder), design)
        wrong, broken, far, inside = 0, 0, 0.0, np.zeros(len(monitor.levels))
        for seed in range(0, STATES, AT_ONCE):
            cases = drawn_cases(design, min(AT_ONCE, STATES - seed), seed)
            found, expected = c_answers(monitor, cases, program), python_answers(monitor, cases)
            wrong += disagreements(monitor, found, expected, EDGES["double"])
            far = max(far, distance(found, expected))
            inside += found.inside.sum(axis=0)
            z = np.asarray(phi(jnp.concatenate([cases.q, cases.dq], axis=1))[1])
            slacks = tube_margins(run.gait, theorems.walking, z)
            broken += _otherwise(found, monitor, 2, slacks)
            slacks = theorem_margins(run, theorems.full, cases.q, cases.dq)
            broken += _otherwise(found, monitor, 4, slacks)
        show(f"states: {STATES}; inside of levels {monitor.levels}", str(inside / STATES))
        show("answers and names that differ, C from the Programs", wrong, "0")
        show("largest distance of a margin m, in units of 1 + |m|", far)
        show("answers that differ, C from the certificate's functions", broken, "0")
        _cost(design_cases=drawn_cases(design, 20_000), monitor=monitor, folder=Path(folder))


def _otherwise(
    found: MonitorAnswers, monitor: StateMonitor, level: int, slacks: dict[str, np.ndarray]
) -> int:
    """Answers of C about a level that are not those of these slacks."""
    from support.monitored import close, none_negative

    answers = found.inside[:, monitor.levels.index(level)]
    return int(np.sum((answers != none_negative(slacks)) & ~close(slacks, EDGES["double"])))


def _cost(design_cases: MonitorCases, monitor: StateMonitor, folder: Path) -> None:
    """Times of each set and of a whole answer, by precision."""
    for precision, defines in build.PRECISIONS.items():
        sources = (*SOURCES, "check_monitor.c")
        program = build.build("gcc", folder, "check_monitor", sources, (*build.PLAIN, *defines))
        *sets, answer = latency(design_cases, program)
        for one, times in zip(monitor.sets, sets, strict=True):
            levels = " and ".join(map(str, one.levels))
            asked = f"<= {ASKED_US[one.levels[0]]:g}"
            show(f"{precision}, level {levels}: p50, p99 us", f"{times.p50}, {times.p99}", asked)
        show(f"{precision}, whole answer: p50, p99 us", f"{answer.p50}, {answer.p99}")


def _watched(run: Run, law: str | Fblin, start: Literal["fixed-point", "region"]) -> None:
    """Shares of ticks of a walk in MuJoCo in each set."""
    done = simulate(run, controller=law, steps=STEPS, start=start, episodes=4, monitor=True).summary
    seen = done.monitor
    assert seen is not None
    name = law if isinstance(law, str) else f"fblin, w = {law.bandwidth:g}"
    for levels, one in seen.by_set:
        last = "none" if one.last_outside is None else one.last_outside.name
        what = f"{name}, {start}: ticks in the set of level {levels}"
        show(what, f"{one.inside:.2%}", f"least {one.margin:.3g} {one.name}; last {last}")


if __name__ == "__main__":
    main()
