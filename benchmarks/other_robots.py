"""Robots of other kinds, by the defaults: trained, proved to level 3, walked 1000 steps.

Asked: RABBIT, every file of examples/robots, and nine of ten random bipeds of 3 to 60 kg with three
to six motors; at most 1 % of ticks at a torque limit. ROBOTS=N takes N random ones; FILES=no leaves
the files out.
"""

import os
import time
from pathlib import Path

from common import show, trained
from random_robot import random_robot

from neuralgaits.errors import NeuralGaitsError
from neuralgaits.robots import PlanarBiped, load_robot
from neuralgaits.robots.mjcf.loader import robot_from_text
from neuralgaits.workflows.certify import certify
from neuralgaits.workflows.simulate import simulate

FILES = Path(__file__).parents[1] / "examples" / "robots"


def main() -> None:
    """Print what became of each robot, and how many came through."""
    robots = [load_robot("rabbit")]
    if os.environ.get("FILES") != "no":
        robots += [load_robot(file) for file in sorted(FILES.glob("*.xml"))]
    random = range(int(os.environ.get("ROBOTS", "10")))
    robots += [robot_from_text(random_robot(seed), f"random{seed}") for seed in random]
    good = 0
    for robot in robots:
        name = f"{robot.name}, {robot.n - 1} motors, {float(robot.mass):.0f} kg"
        show(f"{name}, legs of {robot.leg_length:.2f} m", "")
        try:
            good += _came_through(robot)
        except NeuralGaitsError as error:
            show(f"  {error}"[:150], "")
    show("trained, proved and walked by both laws", f"{good} of {len(robots)}")


def _came_through(robot: PlanarBiped) -> bool:
    begun = time.monotonic()
    run = trained(robot, 0)
    conditions = run.summary["conditions"]
    missed = [name for name, found in conditions.items() if found["max_violation"] > 0.0]
    show("  conditions missed", ", ".join(missed) or "none", "none")
    show("  trained in s", time.monotonic() - begun)
    answer = certify(run, level=3, budget=120.0).summary
    show("  level 3", answer.verdict, "proved")
    walked = []
    for law in ("pd", "fblin"):
        found = simulate(run, controller=law, steps=1000).summary
        why = found.fall_reasons[0] or ""
        walked.append(not why)
        show(f"  {law}: steps", f"{found.steps_walked[0]} {why}", "1000")
        for label, value, asked in (
            ("speed m/s", found.speed_m_s, ""),
            ("share of ticks at a limit", found.saturated_fraction, "<= 0.01"),
            ("largest output error mrad", 1e3 * (found.max_output_error_rad or 0.0), ""),
            ("cost of transport", found.cost_of_transport, ""),
        ):
            if value is not None:
                show(f"  {law}: {label}", value, asked)
    return not missed and answer.verdict == "proved" and all(walked)


if __name__ == "__main__":
    main()
