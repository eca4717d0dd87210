"""A robot that changes while it walks: torso or slope, learned again on the way.

Asked: within 0.03 m/s of what is told again after 10 steps, and no fall. Live walks in MuJoCo from
the middle of the region, everything adapted that the gait takes; after 10 to 14 steps the plant
changes, and its mean speed from the tenth touchdown after that on is printed. RUN is a run;
CHANGES, TOLD, LAWS and WALKS choose others.
"""

import os

import numpy as np
from common import whole

from neuralgaits.analysis.run import Run, open_run
from neuralgaits.control.controlled_gait import ControlledGait
from neuralgaits.simulation.live import LiveWalk
from neuralgaits.simulation.native.compiled_walk import Library
from neuralgaits.simulation.setup.starts import full_states, momentum_range
from neuralgaits.simulation.trained_walks import walk_engine_for

CHANGES = "torso_shift_m=0.03 torso_shift_m=-0.03 slope_deg=3 slope_deg=-3"
BEFORE, SETTLED, AFTER = 10, 10, 16
"""Touchdowns before the change, and after it until speeds count and until the end."""
ASKED_M_S, WALKS = 0.03, whole("WALKS", 5)


def main() -> None:
    """Print a row for each law, change and told speed."""
    run = open_run(os.environ["RUN"])
    changes = os.environ.get("CHANGES", CHANGES).split(" ")
    speeds = [float(one) for one in os.environ.get("TOLD", "0.60,0.70,0.80").split(",")]
    print("| law | change | told | walked after it, falls | |")
    for law in os.environ.get("LAWS", "pd,fblin").split(","):
        library = walk_engine_for(run, law, None).library
        for change in changes:
            for told in speeds:
                walked = [_speed(run, library, law, told, change, k) for k in range(WALKS)]
                means, falls = [one for one in walked if one is not None], walked.count(None)
                mean = float(np.mean(means)) if means else np.nan
                good = abs(mean - told) <= ASKED_M_S and not falls
                answer = "as asked" if good else "NOT as asked"
                print(
                    f"| {law} | {change} | {told:.2f} | {mean:.3f}, {falls} | {answer} |",
                    flush=True,
                )


def _speed(
    run: Run, library: Library | None, law: str, told: float, change: str, later: int
) -> float | None:
    """Walk, change the plant after some touchdowns; return the mean speed (m/s), None if it fell.

    Args:
        run: run of the gait.
        library: compiled tick.
        law: control law.
        told: speed that the robot is told (m/s).
        change: disturbance, as in `slope_deg=3`.
        later: touchdowns more before the change.
    """
    gait = run.trained
    start = full_states(run.zero_dynamics, run.gait, "centre", seed=0, episodes=1)[0]
    controlled = ControlledGait(run.robot, gait, momentum_range(gait))
    live = LiveWalk(controlled.under(law), start, library=library)
    live.tell(speed=told)
    live.control.adapt(True)
    name, _, size = change.partition("=")
    steps, ends = 0, []
    while steps < BEFORE + later + AFTER:
        if not live.tick() or live.outcome is None:
            return None
        if live.outcome.touchdown[0]:
            steps += 1
            if steps == BEFORE + later:
                live.disturb(**{name: float(size)})
            if steps >= BEFORE + later + SETTLED:
                ends.append((live.time, float(live.hip[0])))
    (begun, first), (ended, last) = ends[0], ends[-1]
    return (last - first) / (ended - begun)


if __name__ == "__main__":
    main()
