"""Starts from random standing postures, and stops at random ticks, under the exported supervisor.

Asked: 50 of 50 starts walk 50 steps; 200 of 200 stops end without a fault, on two feet or damped.
Starts are at rest, in MuJoCo, full order, no boom, of two kinds: the centre of mass between the
feet, over a range of feet, heights and leans; and every joint at random about the standing posture,
turned so that both feet touch, where some cannot be held. Each stop is followed by five more steps.
STARTS, STOPS, STEPS, SENSING, ROBOTS and RUN (a run folder, else the shipped one) change it.
"""

import os
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np
from common import show, trained, whole

import neuralgaits
from neuralgaits.analysis.run import Run, open_run
from neuralgaits.robots import PlanarBiped
from neuralgaits.robots.dynamics import swing_foot
from neuralgaits.robots.standing import Stand, centre_of_mass, posture, standing_postures
from neuralgaits.simulation.setup.disturbance import PlantChanges
from neuralgaits.simulation.setup.sensing import sensed
from neuralgaits.simulation.supervised.supervised_robot import (
    Mode,
    Reason,
    Request,
    SupervisedRobot,
)
from neuralgaits.workflows.export import design_of

STARTS, STOPS, STEPS = whole("STARTS", 50), whole("STOPS", 200), whole("STEPS", 50)
SHIPPED = Path(neuralgaits.__file__).parent / "demo_run"
LONGEST_S = 60.0
"""After which a walk that does not come has not come."""
AGAIN = 5
"""Steps after a stop."""
JOINTS = 0.2
"""Largest change of a joint from the standing posture, either way [rad]."""


class Start(NamedTuple):
    """A posture on two feet."""

    q: np.ndarray
    """Coordinates, the front leg in stance [rad]."""
    front: int
    """The leg in front."""
    balanced: bool
    """Whether the centre of mass is between the feet."""


def stands(robot: PlanarBiped, rng: np.random.Generator) -> Iterator[Start]:
    """Postures with the centre of mass between the feet."""
    while True:
        stand = Stand(
            spacing=rng.uniform(0.1, 0.48),
            height=rng.uniform(0.85, 0.95),
            ahead=rng.uniform(-0.85, -0.15),
            lean=rng.uniform(-0.25, 0.1),
        )
        q = posture(robot, stand)
        if q is not None:
            yield Start(q, int(rng.integers(2)), True)


def jittered(robot: PlanarBiped, rng: np.random.Generator) -> Iterator[Start]:
    """The standing posture with each joint at random, both feet on the floor."""
    found = standing_postures(robot)
    assert found is not None
    while True:
        q = found.path[0].copy()
        q[1:] = np.clip(
            q[1:] + rng.uniform(-JOINTS, JOINTS, len(q) - 1), robot.joint_lower, robot.joint_upper
        )
        x, z = np.asarray(swing_foot(robot, q))
        q[0] += np.arctan2(z, -x)
        behind, _ = np.asarray(swing_foot(robot, q))
        ahead = centre_of_mass(robot, q)[0]
        yield Start(q, int(rng.integers(2)), bool(behind < ahead < 0.0))


def walked(robot: SupervisedRobot, start: Start) -> tuple[int, Counter[str]]:
    """Steps of a start, and why modes have changed."""
    robot.start(start.q, front=start.front)
    steps, why = 0, Counter[str]()
    for _ in range(int(1000 * LONGEST_S)):
        tick = robot.tick(Request.WALK)
        steps += tick.touchdown
        if tick.reason != Reason.NO_CHANGE:
            why[f"{tick.mode.name} {tick.reason.name}"] += 1
        if steps >= STEPS or tick.mode == Mode.DAMP:
            break
    return steps, why


def stopped(robot: SupervisedRobot, ticks: int) -> tuple[str, float, bool]:
    """How a stop after so many ticks ends, after how long (s), and whether it walks again."""
    robot.start()
    while robot.tick(Request.WALK).mode != Mode.WALK:
        pass
    for _ in range(ticks):
        tick = robot.tick(Request.WALK)
    took = 0
    while tick.mode not in (Mode.STAND, Mode.DAMP):
        tick = robot.tick(Request.STAND)
        took += 1
    how = f"{tick.mode.name} {tick.reason.name}" + (f" {tick.fault.name}" if tick.fault else "")
    for more in range(8000):
        tick = robot.tick(Request.STAND)
        if more >= 2000 and tick.mode != Mode.STOP:
            break
    if tick.mode != Mode.STAND:
        return f"{how}, then {tick.mode.name}", 1e-3 * took, False
    steps = 0
    for _ in range(int(1000 * LONGEST_S)):
        steps += robot.tick(Request.WALK).touchdown
        if steps >= AGAIN:
            break
    return how, 1e-3 * took, steps >= AGAIN


def measure(name: str, run: Run, sensing: str | None) -> None:
    """Print the rows of a robot with some sensors."""
    robot = SupervisedRobot(design_of(run), sensed(PlantChanges(), sensing))
    for kind, postures in (("stands", stands), ("joints at random", jittered)):
        draws = postures(run.robot, np.random.default_rng(0))
        starts = [next(draws) for _ in range(STARTS)]
        for balanced in (True, False):
            these = [start for start in starts if start.balanced == balanced]
            done = [walked(robot, start) for start in these]
            if not these:
                continue
            well = sum(steps >= STEPS for steps, _ in done)
            of = "" if balanced else ", centre of mass outside of the feet"
            asked = f"{len(these)} of {len(these)}" if balanced else ""
            show(f"{name}: {kind}{of}, {STEPS} steps", f"{well} of {len(these)}", asked)
            for steps, why in done:
                if steps < STEPS:
                    print(f"    {steps} steps: {', '.join(why)}")
    rng = np.random.default_rng(1)
    ends, times, again = Counter[str](), [], 0
    for _ in range(STOPS):
        how, took, walks = stopped(robot, int(rng.integers(1, 8000)))
        ends[how] += 1
        times.append(took)
        again += walks
    for how, count in ends.most_common():
        show(f"{name}: stops that end {how}", f"{count} of {STOPS}", "no fault")
    show(f"{name}: seconds to a stop, mean and longest", f"{np.mean(times):.2f}, {max(times):.2f}")
    show(f"{name}: walk {AGAIN} steps again", f"{again} of {STOPS}")


def main() -> None:
    """Measure the shipped gait with each sensing, then gaits that are trained for it."""
    shipped = open_run(os.environ.get("RUN", SHIPPED))
    for sensing in filter(None, os.environ.get("SENSING", "perfect,encoders").split(",")):
        measure(f"{shipped.robot.name}, {sensing}", shipped, sensing)
    for name in filter(None, os.environ.get("ROBOTS", "rabbit,amber3m-feet").split(",")):
        spec = "walking-flat-feet" if "feet" in name else "walking"
        measure(name, trained(name, 0, spec), None)


if __name__ == "__main__":
    main()
