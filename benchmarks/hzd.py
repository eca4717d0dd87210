"""Gaits by trajectory optimisation, ten speeds from 0.4 to 0.95 m/s, and beside published ones.

Asked: every speed converges, in at most 2 s each (the program's derivatives, made once for all of
them, left out); at the speed of each published gait a cost of transport that is not above its own,
both on the zero dynamics, both in MuJoCo under `pd`; all walk 50 steps. Levels are those proved by
`certify`. Times are a processor's. Needs the extra hzd.
"""

import shutil
import time
from pathlib import Path

import numpy as np
from common import ROOT, show

from neuralgaits.analysis.run import Run
from neuralgaits.gait import ZeroDynamics
from neuralgaits.hzd.solver import DEGREE, Optimiser
from neuralgaits.records.training_config import GaitOrigin
from neuralgaits.robots import load_robot
from neuralgaits.workflows.certify import certify
from neuralgaits.workflows.given_run import given_run
from neuralgaits.workflows.import_gait import import_gait
from neuralgaits.workflows.simulate import simulate

PUBLISHED = Path(__file__).parents[1] / "examples" / "gaits" / "amber3m.json"
NAMES = "0.51", "0.67", "0.84"
SPEEDS = np.linspace(0.4, 0.95, 10)
STEPS = 50


def main() -> None:
    """Print the published gaits, then three lines a speed."""
    robot = load_robot("amber3m")
    costs = {}
    for name in NAMES:
        run = import_gait(PUBLISHED, robot, name=name, out=_fresh(f"published-{name}"), root=ROOT)
        costs[run.summary.speed_m_s] = _show(f"published {name}", run)
    start_time = time.process_time()
    optimiser = Optimiser(robot)
    show("making the program and its derivatives [s]", time.process_time() - start_time)
    for speed in sorted([*SPEEDS.tolist(), *costs]):
        start_time = time.process_time()
        found = optimiser.at(speed)
        taken = time.process_time() - start_time
        show(f"{speed:.3f} m/s: {found.iterations} iterations, time [s]", taken, "<= 2")
        given = GaitOrigin("optimise", DEGREE, speed)
        run = given_run(
            ZeroDynamics(robot, found.gait.policy),
            found.gait,
            given,
            start_time=time.perf_counter(),
            out=_fresh(f"optimised-{speed:.3f}"),
            root=ROOT,
        )
        _show(f"{speed:.3f} m/s", run, costs.get(speed))


def _fresh(name: str) -> Path:
    folder = ROOT / name
    shutil.rmtree(folder, ignore_errors=True)
    return folder


def _show(what: str, run: Run, most: tuple[float, float] | None = None) -> tuple[float, float]:
    """Print what is proved of a gait and what it costs. Returns: on the model and in MuJoCo."""
    proof, orbit = certify(run).summary, run.summary
    broken = ", ".join(name for name, one in proof.conditions.items() if one.verdict != "proved")
    show(f"{what}: {proof.verdict}, level", f"{proof.proved_level}", broken)
    assert orbit.cost_of_transport is not None
    walk = simulate(run, steps=STEPS).summary
    cost = walk.cost_of_transport or np.inf
    asked = ["", ""] if most is None else [f"<= {one:.4f}" for one in most]
    show(f"{what}: cost of transport on the zero dynamics", orbit.cost_of_transport, asked[0])
    steps = f"{walk.steps_walked[0]} steps at {walk.speed_m_s:.3f} m/s"
    show(f"{what}: in MuJoCo, {steps}", cost, asked[1])
    return orbit.cost_of_transport, cost


main()
