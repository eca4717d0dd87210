"""The quadratic program in place of clipping: falls under weak motors, ticks that gave up, time.

Asked at a torque limit of 20 N m: at most half of the falls of `fblin`, over 20 seeds; no tick in
the set of the full-order theorem that gives anything up; at most 100 us a tick in C.

SEEDS=5 takes fewer gaits, LIMIT=30 other motors, PARTS=falls,inside,time some of the parts,
LAWS=fblin,clf-qp,pd other laws.
"""

import os
import time
from dataclasses import replace
from pathlib import Path

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from common import seeds, show, trained

from neuralgaits._types import Array
from neuralgaits.analysis.run import Run
from neuralgaits.barriers import Gait
from neuralgaits.control import AbstractLaw, ClfQp
from neuralgaits.control.controlled_gait import ControlledGait, law_for
from neuralgaits.records.simulated import WalkFigures
from neuralgaits.simulation.live import LiveWalk
from neuralgaits.simulation.metrics import summary
from neuralgaits.simulation.native.compiled_walk import Library
from neuralgaits.simulation.native_walk import engine_of_run
from neuralgaits.simulation.setup.disturbance import PlantChanges
from neuralgaits.simulation.setup.disturbance_set import DISTURBANCE_SET
from neuralgaits.simulation.setup.starts import full_states, momentum_range
from neuralgaits.simulation.walk import Walk, walk

LIMIT = float(os.environ.get("LIMIT", 20.0))
CHOSEN = os.environ.get("LAWS", "fblin,clf-qp").split(",")
PARTS = os.environ.get("PARTS", "falls,inside,time").split(",")
STEPS = 25
TICKS = 20_000
LOOKED_AT = 9000
"""Ticks of a walk that are looked at: as many of all, so that it compiles once."""
RADIUS = 0.009
"""sqrt V at the start of a step up to which level 4 is proved of default gaits [rad]."""
PUSHES = {"push -12 N s": -12.0, "push +20 N s": 20.0}


_libraries: dict[Path, Library] = {}


def library_of(run: Run) -> Library:
    """The compiled walk of a gait, written once."""
    if run.path not in _libraries:
        library = engine_of_run(run, "native").library
        assert library is not None
        _libraries[run.path] = library
    return _libraries[run.path]


def walked(
    run: Run,
    law: str | AbstractLaw,
    disturbance: PlantChanges,
    *,
    push: float = 0.0,
    longest: int = 0,
) -> Walk:
    """One walk from somewhere in the tube, as compiled code."""
    seed = run.summary.seed
    return walk(
        run.robot,
        run.gait.policy,
        full_states(run.zero_dynamics, run.gait, "region", seed=1, episodes=1),
        controller=law_for(law, run.robot, run.gait),
        steps=STEPS,
        z2_range=momentum_range(run.gait),
        disturbance=disturbance,
        push=push,
        seed=seed,
        longest=longest,
        library=library_of(run),
        threads=1,
    )


def falls(runs: list[Run]) -> None:
    """Falls of every law under every disturbance, all with the same motors."""
    weak = PlantChanges(torque_limit=LIMIT)
    cases = {"none": (weak, 0.0)} | {name: (weak, push) for name, push in PUSHES.items()}
    for name, disturbance in DISTURBANCE_SET.items():
        if disturbance.torque_limit is None:
            cases[name] = (replace(disturbance, torque_limit=LIMIT), 0.0)
    totals = dict.fromkeys(CHOSEN, 0)
    for name, (disturbance, push) in cases.items():
        for law in CHOSEN:
            found = [summary(walked(run, law, disturbance, push=push)) for run in runs]
            fell = sum(sum(one.fell) for one in found)
            totals[law] += fell
            show(f"{LIMIT:g} N m, {name}: {law}", f"{fell} of {len(runs)} fell", figures(found))
    for law, fell in totals.items():
        show(f"{LIMIT:g} N m, all of these: {law}", f"{fell} of {len(cases) * len(runs)} fell")


def figures(found: list[WalkFigures]) -> str:
    """Cost of transport, and what was given up."""
    costs = [one.cost_of_transport for one in found if one.cost_of_transport is not None]
    text = f"cost of transport {np.mean(costs):.3f}" if costs else ""
    relaxed = [one.relaxed for one in found if one.relaxed is not None]
    if relaxed:
        slower, out = np.mean([(one.decrease, one.contact) for one in relaxed], axis=0)
        text += f", decrease missed {slower:.2%}, contact {out:.2%}"
    return text


def inside(runs: list[Run]) -> None:
    """Ticks inside the set of the full-order theorem, and those of them that gave something up."""
    for limit in (LIMIT, 41.0):
        ticks, relaxed, made = 0, np.zeros(2, int), []
        for run in runs:
            disturbance = PlantChanges(torque_limit=limit)
            one = walked(run, "clf-qp", disturbance, longest=LOOKED_AT)
            made.append(summary(one))
            found = one.episodes.records[0].result
            w = ClfQp().bandwidth
            y, dy = found.q[:, 1:] - found.y_d, found.dq[:, 1:] - found.dy_d
            root = np.sqrt(np.sum((dy / w) ** 2, 1) + 4.0 * np.sum((y + dy / w) ** 2, 1))
            phase, level = np.asarray(_places(run.gait, found.z)).T
            there = (root <= RADIUS) & (phase >= 0.0) & (phase <= 1.0) & (level >= 0) & (level <= 1)
            ticks += int(np.sum(there))
            relaxed += np.sum(found.relaxed[there], axis=0)
        fell = sum(sum(one.fell) for one in made)
        show(f"{limit:g} N m: walks", f"{fell} of {len(runs)} fell", figures(made))
        show(f"{limit:g} N m: ticks with outputs and z in the set", ticks)
        show(f"{limit:g} N m: of these, decrease missed, contact", str(relaxed), "0, 0")


@eqx.filter_jit
def _places(gait: Gait, z: Array) -> Array:
    """Phase and level of many states."""
    return jax.vmap(lambda one: jnp.stack([gait.phase(one[0]), gait.level(one)]))(z)


def tick_times(
    run: Run, law: str | AbstractLaw, torque_limit: float = LIMIT, ticks: int = TICKS
) -> np.ndarray:
    """Processor time of each tick of a walk in C, policy and a call from Python included (us)."""
    library = library_of(run)
    start = full_states(run.zero_dynamics, run.gait, "centre", seed=0, episodes=1)[0]
    controlled = ControlledGait(run.robot, run.gait, momentum_range(run.gait))
    live = LiveWalk(controlled.under(law), start, library=library)
    live.disturb(torque_limit=torque_limit)
    call, times = library.tick, []

    def timed(*arguments: object) -> None:
        before = time.thread_time_ns()
        call(*arguments)
        times.append(1e-3 * (time.thread_time_ns() - before))

    library.tick = timed  # pyright: ignore[reportAttributeAccessIssue]
    for _ in range(ticks):
        live.tick()
        if live.ending.fell:
            live.place(start)
    library.tick = call
    return np.array(times)


def main() -> None:
    """Print the parts that are asked for."""
    runs = [trained("amber3m", seed) for seed in seeds()]
    if "falls" in PARTS:
        falls(runs)
    if "inside" in PARTS:
        inside(runs)
    if "time" in PARTS:
        for law in CHOSEN:
            for limit in (LIMIT, 41.0):
                half, most = np.percentile(tick_times(runs[0], law, limit), [50, 99])
                asked = "p99 <= 100 us" if law == "clf-qp" else ""
                show(f"{limit:g} N m, {law}: tick, p50, p99", f"{half:.1f}, {most:.1f} us", asked)


if __name__ == "__main__":
    main()
