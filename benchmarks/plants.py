"""Nominal policies on other robots: where a policy trained on the model alone falls.

Asked: falls in 9 of 10 on `amber3m-tail` under pd, 10 starts, 10 seeds. The torso is moved further
and further back; the last table walks the standard set of disturbances. SEEDS, STARTS and
STEPS shorten it.
"""

import os

from common import seeds, show, trained

from neuralgaits.analysis.run import Run
from neuralgaits.robots import load_robot
from neuralgaits.simulation.metrics import summary
from neuralgaits.simulation.setup.disturbance import PlantChanges
from neuralgaits.simulation.setup.disturbance_set import DISTURBANCE_SET
from neuralgaits.simulation.setup.starts import full_states, momentum_range
from neuralgaits.simulation.walk import walk

STARTS = int(os.environ.get("STARTS", 10))
STEPS = int(os.environ.get("STEPS", 200))
SHIFTS_M = (-0.03, -0.04, -0.05, -0.06)
TAIL = "amber3m-tail"
TAIL_SHIFT_M = -0.03


def fallen(
    run: Run, plant: str, disturbance: PlantChanges, controller: str, steps: int = STEPS
) -> tuple[int, list[int]]:
    """Walks that fell, and the steps of all."""
    walked = walk(
        run.robot,
        run.gait.policy,
        full_states(
            run.zero_dynamics, run.gait, "region", seed=run.folder.config["seed"], episodes=STARTS
        ),
        plant=load_robot(plant),
        controller=controller,
        steps=steps,
        z2_range=momentum_range(run.gait),
        disturbance=disturbance,
    )
    figures = summary(walked)
    return sum(figures["fell"]), figures["steps_walked"]


def main() -> None:
    """Print every row."""
    runs = [trained("amber3m", seed) for seed in seeds(10)]
    asked = STARTS * len(runs)
    for shift in SHIFTS_M:
        further = PlantChanges(torso_shift_m=shift - TAIL_SHIFT_M)
        found = [fallen(run, TAIL, further, "pd") for run in runs]
        falls, steps = sum(count for count, _ in found), [s for _, each in found for s in each]
        name = f"pd, torso {-100 * shift:.0f} cm behind: falls within {STEPS} steps"
        note = f">= {9 * asked // 10}" if shift == TAIL_SHIFT_M else ""
        show(name, f"{falls} of {asked}, {min(steps)}-{max(steps)} steps", note)
    first = runs[0]
    for controller in ("pd", "fblin"):
        for name, disturbance in DISTURBANCE_SET.items():
            count, steps = fallen(first, "amber3m", disturbance, controller, 50)
            show(f"{controller}: {name}, falls within 50 steps", f"{count} of {len(steps)}")


if __name__ == "__main__":
    main()
