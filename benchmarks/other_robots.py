"""The default spec on other robots: RABBIT and random bipeds, trained and walked.

Asked: no violation, 100 steps walked; RABBIT's mechanical cost of transport at most 0.35.
"""

from common import show, trained
from random_robot import random_robot

from neuralgaits.robots import load_robot
from neuralgaits.robots.loader import robot_from_text
from neuralgaits.simulation.metrics import summary
from neuralgaits.simulation.starts import full_states, momentum_range
from neuralgaits.simulation.walk import walk


def main() -> None:
    """Print rows for each robot and both controllers."""
    robots = [load_robot("rabbit")]
    robots += [robot_from_text(random_robot(seed), f"random{seed}") for seed in range(3)]
    for robot in robots:
        run = trained(robot, 0)
        conditions = run.summary["conditions"]
        worst = max(conditions, key=lambda name: conditions[name]["max_violation"])
        violation = conditions[worst]["max_violation"]
        name = f"{robot.name} ({float(robot.mass):.0f} kg, leg {robot.leg_length:.2f} m)"
        show(f"{name}: largest violation ({worst})", violation, "0")
        start = full_states(run.zero_dynamics, run.gait, "centre", seed=0, episodes=1)
        for controller in ("fblin", "pd"):
            result = walk(
                robot,
                run.gait.policy,
                start,
                controller=controller,
                steps=100,
                z2_range=momentum_range(run.gait),
            )
            figures = summary(result)
            reason = figures["fall_reasons"][0] or ""
            show(f"  {controller}: steps walked", f"{figures['steps_walked'][0]} {reason}", "100")
            if figures["speed_m_s"] is not None:
                show(f"  {controller}: speed m/s", figures["speed_m_s"])
                show(f"  {controller}: cost of transport", figures["cost_of_transport"], "<= 0.35")


if __name__ == "__main__":
    main()
