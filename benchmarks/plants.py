"""Nominal policies on other robots: where a policy trained on the model alone falls.

Asked: falls in 9 of 10 on `amber3m-tail` under pd, 10 starts, 10 seeds. The torso is moved further
and further back; the last table walks the standard set of disturbances under several laws, STARTS
walks of 25 steps of each of the first three seeds. Asked of scheduled-pd there: no more falls than
pd; undisturbed at most 2 mrad of output error, no tick at a torque limit, 5 us a tick in C.

SEEDS, STARTS and STEPS shorten it; PARTS=torso,set some of the parts; LAWS=pd,fblin other laws,
LAWS=scheduled-pd@55 a law with a bandwidth of 55 rad/s.
"""

import os

import numpy as np
from clf_qp import library_of, tick_times
from common import seeds, show, trained

from neuralgaits.analysis.run import Run
from neuralgaits.control import AbstractLaw
from neuralgaits.control.controlled_gait import law_for
from neuralgaits.control.law_by_name import at_bandwidth
from neuralgaits.records.simulated import WalkFigures
from neuralgaits.robots import load_robot
from neuralgaits.simulation.metrics import summary
from neuralgaits.simulation.setup.disturbance import PlantChanges
from neuralgaits.simulation.setup.disturbance_set import DISTURBANCE_SET
from neuralgaits.simulation.setup.starts import full_states, momentum_range
from neuralgaits.simulation.walk import walk

STARTS = int(os.environ.get("STARTS", 10))
STEPS = int(os.environ.get("STEPS", 200))
SHIFTS_M = (-0.03, -0.04, -0.05, -0.06)
PARTS = os.environ.get("PARTS", "torso,set").split(",")
LAWS = os.environ.get("LAWS", "pd,fblin,scheduled-pd").split(",")
SET_STEPS = 25
"""Steps of walks under the standard disturbances."""
TAIL = "amber3m-tail"
TAIL_SHIFT_M = -0.03


def named(law: str) -> AbstractLaw:
    """A law by name, or by name and bandwidth [rad/s] as in scheduled-pd@55."""
    name, _, bandwidth = law.partition("@")
    return at_bandwidth(name, float(bandwidth) if bandwidth else None)


def walked(
    run: Run, plant: str, disturbance: PlantChanges, controller: str, steps: int = STEPS
) -> WalkFigures:
    """Figures of walks from random states of the tube, as compiled code."""
    result = walk(
        run.robot,
        run.gait.policy,
        full_states(
            run.zero_dynamics, run.gait, "region", seed=run.folder.config["seed"], episodes=STARTS
        ),
        plant=load_robot(plant),
        controller=law_for(named(controller), run.robot, run.gait),
        steps=steps,
        z2_range=momentum_range(run.gait),
        disturbance=disturbance,
        library=library_of(run),
    )
    return summary(result)


def torso(runs: list[Run]) -> None:
    """Falls with the torso's load further and further behind."""
    asked = STARTS * len(runs)
    for shift in SHIFTS_M:
        further = PlantChanges(torso_shift_m=shift - TAIL_SHIFT_M)
        found = [walked(run, TAIL, further, "pd") for run in runs]
        falls, steps = (
            sum(sum(one.fell) for one in found),
            [s for o in found for s in o.steps_walked],
        )
        name = f"pd, torso {-100 * shift:.0f} cm behind: falls within {STEPS} steps"
        note = f">= {9 * asked // 10}" if shift == TAIL_SHIFT_M else ""
        show(name, f"{falls} of {asked}, {min(steps)}-{max(steps)} steps", note)


def standard_set(runs: list[Run]) -> None:
    """Falls, output errors and saturated ticks under every law and standard disturbance."""
    falls = dict.fromkeys(LAWS, 0)
    for name, disturbance in {"undisturbed": PlantChanges(), **DISTURBANCE_SET}.items():
        for law in LAWS:
            found = [walked(run, "amber3m", disturbance, law, SET_STEPS) for run in runs]
            fell = sum(sum(one.fell) for one in found)
            falls[law] += fell if name != "undisturbed" else 0
            error = 1e3 * max(one.max_output_error_rad or np.nan for one in found)
            limited = float(np.mean([one.saturated_fraction or 0.0 for one in found]))
            told = f"{fell} of {STARTS * len(runs)} fell, {error:.2f} mrad, {limited:.3%}"
            show(f"{name}: {law}", told)
    for law, fell in falls.items():
        show(f"all disturbances: {law}", f"{fell} of {len(DISTURBANCE_SET) * STARTS * len(runs)}")
    for law in LAWS:
        half, most = np.percentile(tick_times(runs[0], named(law), 41.0), [50, 99])
        show(f"{law}: tick, p50, p99", f"{half:.1f}, {most:.1f} us")


def main() -> None:
    """Print the parts that are asked for."""
    runs = [trained("amber3m", seed) for seed in seeds(10)]
    if "torso" in PARTS:
        torso(runs)
    if "set" in PARTS:
        standard_set(runs[:3])


if __name__ == "__main__":
    main()
