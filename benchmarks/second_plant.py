"""Drake against MuJoCo: the same walks in both, under the standard set of disturbances.

Asked: the same verdict in at least 90 % of 18 disturbances x 10 walks, speeds within 3 %, z2 after
the impact within 1 %. Speeds and z2 are means over walks that stay up in both; beside them z2 after
the first impact, to which both come from one state. Before that one walk on the orbit, with
contact and time step of Drake changed. EPISODES, STEPS, LAWS and RUN (a run folder; the shipped
one if not given) change it. Needs the drake extra.
"""

import os
import sys
from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path
from typing import Any, NamedTuple
from unittest import mock

import numpy as np
from common import show

import neuralgaits
from neuralgaits.analysis.run import Run, open_run
from neuralgaits.simulation.native_walk import engine_of_run
from neuralgaits.simulation.setup.disturbance import PlantChanges
from neuralgaits.simulation.setup.disturbance_set import DISTURBANCE_SET
from neuralgaits.simulation.setup.starts import full_states, momentum_range
from neuralgaits.simulation.simulators import DRAKE, MUJOCO, Simulator
from neuralgaits.simulation.ticks.gauge import SETTLING_S, START_UP_STEPS
from neuralgaits.simulation.walk import walk

EPISODES, STEPS = int(os.environ.get("EPISODES", 10)), int(os.environ.get("STEPS", 20))
SHIPPED = Path(neuralgaits.__file__).parent / "demo_run"
ALL = 2**31 - 1
"""Ticks of a record."""


class Walked(NamedTuple):
    """Walks in one simulator, a row each."""

    fell: np.ndarray
    speed: np.ndarray
    """Mean over completed steps after the first ones [m/s]."""
    momentum: np.ndarray
    """Mean of z2 where the contact has settled after an impact [kg m^2/s]."""
    first: np.ndarray
    """The same after the first impact [kg m^2/s]."""


def walked(
    run: Run,
    simulator: Simulator,
    disturbance: PlantChanges,
    law: str,
    start: str = "region",
    episodes: int = EPISODES,
) -> Walked:
    """Walk, and read speeds and momenta."""
    starts = full_states(run.zero_dynamics, run.gait, start, seed=0, episodes=episodes)
    done = walk(
        run.robot,
        run.gait.policy,
        starts,
        controller=law,
        steps=STEPS,
        z2_range=momentum_range(run.gait),
        disturbance=disturbance,
        library=engine_of_run(run).library,
        longest=ALL,
        simulator=simulator,
    ).episodes
    gauge = done.gauge
    with np.errstate(divide="ignore", invalid="ignore"):
        speed = (gauge.last.hip - gauge.first.hip) / (gauge.last.time - gauge.first.time)
    momenta = [_settled(record) for record in done.records]
    later = [_mean(found[START_UP_STEPS:]) for found in momenta]
    first = [_mean(found[:1]) for found in momenta]
    fell = np.array([end.fell for end in done.endings])
    return Walked(fell, np.asarray(speed), np.array(later), np.array(first))


def _settled(record: Any) -> np.ndarray:
    """Z2 of a walk at SETTLING_S after each impact (kg m^2/s)."""
    since = np.asarray(record.result.since_touchdown)
    ticks = np.flatnonzero((since[1:] >= SETTLING_S) & (since[:-1] < SETTLING_S)) + 1
    return np.asarray(record.z_plant)[ticks, 1]


def compare(
    name: str, run: Run, disturbance: PlantChanges, law: str
) -> tuple[int, float, float, float]:
    """A row.

    Returns: walks of the same verdict, relative differences of speed and of z2, and the largest
    of z2 after a first impact.
    """
    one, other = (walked(run, where, disturbance, law) for where in (MUJOCO, DRAKE))
    same = int(np.sum(one.fell == other.fell))
    both = ~one.fell & ~other.fell
    speed = _off(one.speed[both], other.speed[both])
    momentum = _off(one.momentum[both], other.momentum[both])
    falls = f"{one.fell.sum()} / {other.fell.sum()}"
    speeds = f"{_mean(one.speed[both]):.4f} / {_mean(other.speed[both]):.4f}"
    momenta = f"{_mean(one.momentum[both]):.3f} / {_mean(other.momentum[both]):.3f}"
    print(
        f"| {name} | {falls} | {same} of {EPISODES} | {speeds} | {100 * speed:+.2f} % | "
        f"{momenta} | {100 * momentum:+.2f} % |",
        flush=True,
    )
    return same, speed, momentum, float(np.nanmax(np.abs(other.first / one.first - 1.0)))


def _mean(values: np.ndarray) -> float:
    return float(np.mean(values)) if values.size else np.nan


def _off(one: np.ndarray, other: np.ndarray) -> float:
    """Difference of means, relative."""
    return _mean(other) / _mean(one) - 1.0


def disturbed(run: Run, law: str) -> None:
    """The table, and what was asked of it."""
    print(f"\n{law}, {EPISODES} walks of {STEPS} steps: MuJoCo / Drake")
    print("| | fell | same verdict | speed [m/s] | | z2 after impact [kg m²/s] | |")
    print("|---|---|---|---|---|---|---|", flush=True)
    compare("nothing", run, PlantChanges(), law)
    rows = [compare(name, run, one, law) for name, one in DISTURBANCE_SET.items()]
    same, speeds, momenta, first = zip(*rows, strict=True)
    share = sum(same) / (EPISODES * len(rows))
    show(f"{law}: same verdict", share, ">= 0.9")
    show(f"{law}: speed, largest difference", float(np.nanmax(np.abs(speeds))), "<= 0.03")
    worst = float(np.nanmax(np.abs(momenta)))
    show(f"{law}: z2 after impact, largest difference", worst, "<= 0.01")
    show(f"{law}: z2 after the first impact, largest of all walks", float(np.nanmax(first)))


def contacts(run: Run) -> None:
    """One walk on the orbit for each kind of contact and time step."""
    from neuralgaits.simulation.drake import drake_world
    from neuralgaits.simulation.drake.ground import ContactConfig
    from neuralgaits.simulation.setup.plant import TIMESTEP_S

    own = ContactConfig()
    kinds = {
        "as it is": (own, TIMESTEP_S),
        "a fifth of the time step": (own, TIMESTEP_S / 5),
        "ten times as stiff": (ContactConfig(stiffness=10 * own.stiffness), TIMESTEP_S),
        "a tenth as stiff": (ContactConfig(stiffness=own.stiffness / 10), TIMESTEP_S),
        "ten times the dissipation": (
            ContactConfig(dissipation_s_m=10 * own.dissipation_s_m),
            TIMESTEP_S,
        ),
        "a tenth of the dissipation": (
            ContactConfig(dissipation_s_m=own.dissipation_s_m / 10),
            TIMESTEP_S,
        ),
        "similar": (ContactConfig("similar"), TIMESTEP_S),
        "sap": (ContactConfig("sap"), TIMESTEP_S),
    }
    build: Callable[..., Any] = drake_world.drake_plant
    quiet = PlantChanges()
    print("\npd, one walk from the periodic orbit, against MuJoCo")
    print("| contact in Drake | fell | speed | z2 after impact |")
    print("|---|---|---|---|", flush=True)
    one = walked(run, MUJOCO, quiet, "pd", "fixed-point", 1)
    for name, (contact, step) in kinds.items():
        as_said = mock.Mock(side_effect=lambda plant, *_, c=contact, s=step: build(plant, c, s))
        with mock.patch.object(drake_world, "drake_plant", as_said):
            other = walked(run, DRAKE, quiet, "pd", "fixed-point", 1)
        speed, momentum = _off(one.speed, other.speed), _off(one.momentum, other.momentum)
        fell = "yes" if other.fell[0] else "no"
        print(f"| {name} | {fell} | {100 * speed:+.2f} % | {100 * momentum:+.2f} % |", flush=True)


def main() -> None:
    """Print the tables."""
    if find_spec("pydrake") is None:
        sys.exit("expected Drake, found none: pip install 'neuralgaits[drake]'")
    run = open_run(Path(os.environ.get("RUN", SHIPPED)))
    contacts(run)
    for law in os.environ.get("LAWS", "pd").split(","):
        disturbed(run, law)


if __name__ == "__main__":
    main()
