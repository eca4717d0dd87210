"""Walks in MuJoCo under the law that level 5 is proved of, with the state's place in its set.

    python benchmarks/proved_walks.py RUN...

Each run is one that `certify RUN --level 5 --bandwidth W` proved. Ticks are 1 ms apart, on a clock
that knows no touchdown, and then with a tick at each touchdown as well. The tick is the C of
exports; MuJoCo takes steps of 50 us, so that a tick is that close to its touchdown. Asked: in the
set at 99 % of the ticks later than 20 ms after a touchdown. WALKS and STEPS shorten it.
"""

import sys
from typing import NamedTuple

import mujoco
import numpy as np
from common import show, whole

from neuralgaits.analysis.run import Run, open_run
from neuralgaits.analysis.state_monitor import StateMonitor
from neuralgaits.certificate.run_certificate.verified_summary import read_certificate
from neuralgaits.control import AbstractLaw
from neuralgaits.control.controlled_gait import ControlledGait, law_for
from neuralgaits.control.law_by_name import at_bandwidth
from neuralgaits.export.design import Design
from neuralgaits.simulation.live import LiveWalk
from neuralgaits.simulation.native.compiled_walk import Library
from neuralgaits.simulation.native_walk import engine_of_trained
from neuralgaits.simulation.setup.starts import full_states, momentum_range
from neuralgaits.simulation.ticks.gauge import SETTLING_S
from neuralgaits.workflows.export import design_of, with_monitor

WALKS, STEPS = whole("WALKS", 10), whole("STEPS", 25)
FINE_S, PERIOD = 5e-5, 20
"""Step of MuJoCo [s], and how many there are between two ticks."""


class Ticks(NamedTuple):
    """Ticks of a walk. N rows each."""

    q: np.ndarray
    dq: np.ndarray
    since: np.ndarray
    """Since the last touchdown [s]; infinite before the first."""
    motors: np.ndarray
    """[N m]"""
    fell: bool


def walked(
    run: Run, law: AbstractLaw, library: Library, start: np.ndarray, *, at_touchdowns: bool
) -> Ticks:
    """Walk from a state and keep what the controller had at its ticks."""
    controlled = ControlledGait(run.robot, run.gait, momentum_range(run.gait))
    walk = LiveWalk(controlled.under(law), start, library=library)
    model, data = walk.plant.model, walk.data
    model.opt.timestep = FINE_S
    threshold = 0.05 * float(run.robot.mass * run.robot.gravity)
    rows, wait, touched, steps, loaded = [], 0, -np.inf, 0, True
    gear = model.actuator_gear[:, 0]
    while steps < STEPS:
        if wait == 0:
            outcome = walk.control.decide(data, np.zeros(2))
            walk.outcome = outcome
            if walk.ending.fell:
                break
            if outcome.touchdown[0]:
                steps, touched = steps + 1, data.time
            state = walk.measured
            assert state is not None
            data.ctrl[:] = outcome.controls[0]
            rows.append((state.q, state.dq, data.time - touched, gear * data.ctrl))
            wait, leg = PERIOD, int(outcome.leg[0])
        mujoco.mj_step(model, data)
        wait -= 1
        was, loaded = loaded, data.sensordata[-2:][1 - leg] > threshold
        if at_touchdowns and loaded and not was and data.time - touched > 0.1:
            wait = 0
    columns = (np.array(column) for column in zip(*rows, strict=True))
    return Ticks(*columns, fell=steps < STEPS)


def shares(monitor: StateMonitor, walks: list[Ticks]) -> tuple[float, float, str]:
    """Shares of ticks in the set, of all and of settled ones, and what is left most often."""
    one = monitor.set_of(5)
    found = [one.membership(one.margins(q=w.q, dq=w.dq)) for w in walks]
    inside = np.concatenate([each.inside for each in found])
    nearest = np.concatenate([each.nearest for each in found])
    settled = np.concatenate([w.since for w in walks]) >= SETTLING_S
    out = nearest[settled & ~inside]
    name = one.names[np.bincount(out).argmax()] if out.size else "none"
    return float(inside.mean()), float(inside[settled].mean()), name


def of_run(run: Run) -> None:
    """Walk the law of a run's proof on both clocks."""
    design: Design = with_monitor(design_of(run), run, read_certificate(run.folder))[0]
    monitor = design.monitor
    assert monitor is not None and design.law_proofs, "expected a run that is proved to level 5"
    subject = design.law_proofs[0].subject
    law = law_for(at_bandwidth(subject, monitor.bandwidth), run.robot, run.gait)
    library = engine_of_trained(run, "native").library
    assert library is not None
    starts = full_states(run.zero_dynamics, run.gait, "region", seed=0, episodes=WALKS)
    for at_touchdowns in (False, True):
        walks = [walked(run, law, library, x, at_touchdowns=at_touchdowns) for x in starts]
        every, settled, name = shares(monitor, walks)
        clock = "and at touchdowns" if at_touchdowns else "on a free clock"
        words = f"{subject} {monitor.bandwidth:g} rad/s, 1 ms {clock}"
        show(f"{words}: falls", f"{sum(one.fell for one in walks)} of {WALKS}", "0")
        show(f"{words}: in the set, all ticks", f"{every:.2%}")
        show(f"{words}: 20 ms after touchdowns", f"{settled:.2%}, {name}", ">= 99 %")
        jump = max(np.abs(np.diff(one.motors, axis=0)).max() for one in walks)
        most = np.abs([one.motors for one in walks[:1]]).max()
        show(f"{words}: largest change and size of a torque", f"{jump:.3g}, {most:.3g} N m")


if __name__ == "__main__":
    for place in sys.argv[1:]:
        of_run(open_run(place))
