"""Full-order walks in MuJoCo: long walks, starts all over the tube, disturbances, the gait itself.

Asked: 20 of 20 seeds walk 1000 steps; 200 of 200 starts walk 100 steps; 20 of 20 survive every
disturbance; figures of the gait as in the table. STEPS=100 shortens the long walks,
CONTROLLERS=pd runs one controller.
"""

import os

import numpy as np
from common import seeds, show, trained

from neuralgaits.simulation.metrics import summary
from neuralgaits.simulation.setup.disturbance import PlantChanges
from neuralgaits.simulation.setup.starts import full_states, momentum_range
from neuralgaits.simulation.walk import Walk, walk

LONG = int(os.environ.get("STEPS", 1000))
DISTURBANCES = {
    "friction 0.4": ({"friction": 0.4}, 0.0),
    "torque limit 30 N m": ({"torque_limit": 30.0}, 0.0),
    "actuator delay 4 ms": ({"delay_ms": 4.0}, 0.0),
    "push +8 N s": ({}, 8.0),
    "push -8 N s": ({}, -8.0),
}
CONTROLLERS = os.environ.get("CONTROLLERS", "fblin,pd").split(",")


def main() -> None:
    """Print every row for both controllers."""
    runs = [trained("amber3m", seed) for seed in seeds()]
    robot = runs[0].robot
    policies = [run.gait.policy for run in runs]
    centres = np.concatenate(
        [full_states(run.zero_dynamics, run.gait, "centre", seed=0, episodes=1) for run in runs]
    )
    low, high = np.transpose([momentum_range(run.gait) for run in runs])
    bounds = (float(low.min()), float(high.max()))

    def walked(controller: str, starts, policies, steps: int, **settings) -> Walk:
        return walk(
            robot,
            policies,
            starts,
            controller=controller,
            steps=steps,
            z2_range=bounds,
            **settings,
        )

    for controller in CONTROLLERS:
        result = walked(controller, centres, policies, LONG)
        show(f"{controller}: seeds that walk {LONG} steps", up(result), f"{len(runs)}")
        gait(controller, result)
    first = runs[0]
    starts = full_states(first.zero_dynamics, first.gait, "region", seed=1, episodes=200)
    for controller in CONTROLLERS:
        result = walked(controller, starts, first.gait.policy, 100)
        show(f"{controller}: starts in the tube that walk 100 steps", up(result), "200")
    for controller in CONTROLLERS:
        for name, (what, push) in DISTURBANCES.items():
            settings = {"disturbance": PlantChanges(**what), "push": push}
            result = walked(controller, centres, policies, 50, **settings)
            show(f"{controller}: {name}, 50 steps", up(result), f"{len(runs)}")
    for controller in CONTROLLERS:
        starts = full_states(first.zero_dynamics, first.gait, "centre", seed=0, episodes=200)
        rough = PlantChanges(floor_height=0.01)
        result = walked(controller, starts, first.gait.policy, 50, disturbance=rough)
        show(f"{controller}: floor +-1 cm, walks of 50 steps, seed 0", up(result), ">= 190 of 200")


def up(result: Walk) -> str:
    """How many episodes stayed up."""
    stayed = [not ending.fell for ending in result.episodes.endings]
    return f"{sum(stayed)} of {len(stayed)}"


def gait(controller: str, result: Walk) -> None:
    """Figures of the gait over all seeds."""
    figures = summary(result)
    gauge, asked = result.episodes.gauge, 2 if controller == "fblin" else 25
    error = figures["max_output_error_rad"]
    show(f"{controller}: speed m/s, mean", figures["speed_m_s"], "0.5-0.9")
    show(f"{controller}: largest steady torque N m", figures["steady_peak_torque_nm"], "<= 30")
    show(f"{controller}: largest joint rate rad/s", figures["max_joint_rate_rad_s"], "<= 4")
    show(f"{controller}: smallest normal force N", figures["min_normal_force_n"], "> 0")
    show(f"{controller}: largest output error mrad", 1e3 * error, f"<= {asked}")
    show(f"{controller}: mechanical cost of transport", figures["cost_of_transport"], "<= 0.16")
    show(f"{controller}: saturated ticks", int(np.sum(gauge.saturated)))
    show(f"{controller}: simulated seconds per second", figures["real_time_factor"])


if __name__ == "__main__":
    main()
