"""Permuted, flipped and offset joints: how many does a log of a robot in a stand show?

    .venv/bin/python benchmarks/deploy.py

Asked: 40 of 40 caught, no correct file refused. Environment: CASES.

Each case is a simulated robot whose masses are off by up to 10 % a body, with dry friction and
noise, and hardware of any motor order, signs, zeros and gears. Half of the files have one mistake.
"""

import os
from collections import Counter
from dataclasses import replace
from pathlib import Path

import common  # noqa: F401 - tests/support is found by it
import jax
import numpy as np

from neuralgaits.deployment.deployed_robot import DeployedRobot
from neuralgaits.deployment.deployment_file import DeploymentFile, ImuMount
from neuralgaits.deployment.deployment_template import template
from neuralgaits.deployment.hung_robot import HungRobotSettings, hung_log
from neuralgaits.deployment.log_comparison import compared
from neuralgaits.robots import load_robot
from support.deployments import about

jax.config.update("jax_enable_x64", True)
CASES = int(os.environ.get("CASES", "40"))
EXAMPLES = Path(__file__).parents[1] / "examples" / "robots"
ROBOTS = (
    "amber3m",
    "rabbit",
    "amber3m-feet",
    str(EXAMPLES / "dm-walker-point-feet.xml"),
    str(EXAMPLES / "h1-section.xml"),
)
PROCEDURES = {
    "labels alone, no torques": HungRobotSettings(directions=True, zero=True),
    "torques, plain labels": HungRobotSettings(),
    "all": HungRobotSettings(directions=True, zero=True),
}


def hardware(known: DeployedRobot, rng: np.random.Generator) -> DeploymentFile:
    """Motors in any order, with any signs, zeros and gears."""
    plain = template(known, (100.0, 3.0))
    motors = rng.permutation(len(plain.joints))
    joints = tuple(
        replace(
            one,
            motor=int(motor),
            sign=int(rng.choice((-1, 1))),
            zero_rad=float(rng.uniform(-1.0, 1.0)),
            gear=float(rng.choice((1.0, 6.0, 9.0))),
        )
        for one, motor in zip(plain.joints, motors, strict=True)
    )
    imu = ImuMount(int(rng.choice((-1, 1))), float(rng.uniform(-0.3, 0.3)))
    return replace(plain, joints=joints, imu=imu)


def mistaken(
    true: DeploymentFile, kind: str, rng: np.random.Generator
) -> tuple[DeploymentFile, set[str]]:
    """A file with one mistake, and the joints that it is about."""
    joints = list(true.joints)
    first, second = (int(one) for one in rng.choice(len(joints), 2, replace=False))
    a, b = joints[first], joints[second]
    if kind == "motor":
        joints[first], joints[second] = replace(a, motor=b.motor), replace(b, motor=a.motor)
        return replace(true, joints=tuple(joints)), {a.joint, b.joint}
    if kind == "sign":
        joints[first] = replace(a, sign=-a.sign)
    else:
        error = float(rng.uniform(0.2, 0.6) * rng.choice((-1, 1)))
        joints[first] = replace(a, zero_rad=a.zero_rad + error)
    return replace(true, joints=tuple(joints)), {a.joint}


def outcomes(settings: HungRobotSettings, *, torques: bool) -> Counter[str]:
    """Counts of cases: caught, named, false alarms, by kind."""
    counts: Counter[str] = Counter()
    robots = [load_robot(name) for name in ROBOTS]
    for case in range(CASES):
        rng = np.random.default_rng(case)
        robot = robots[case % len(robots)]
        known = about(robot)
        true = hardware(known, rng)
        log = hung_log(robot.layout, true, case, settings)
        if not torques:
            log = replace(log, torque=None)
        alarms, _, _ = compared(true, known, log)
        counts["false alarms"] += bool(alarms)
        kind = ("motor", "sign", "zero")[case % 3]
        wrong, joints = mistaken(true, kind, rng)
        findings, checks, _ = compared(wrong, known, log)
        counts[f"{kind}: cases"] += 1
        counts[f"{kind}: caught"] += bool(findings)
        if not findings:
            open_zeros = all(checks[one].zero_error_rad is None for one in joints)
            counts["missed, and said to be unchecked"] += kind == "zero" and open_zeros
        named = {(one.about, one.kind) for one in findings}
        counts[f"{kind}: joint and kind named"] += named == {(one, kind) for one in joints}
    return counts


def main() -> None:
    """Print a line for each procedure."""
    for name, settings in PROCEDURES.items():
        found = outcomes(settings, torques="no torques" not in name)
        caught = sum(count for key, count in found.items() if key.endswith("caught"))
        alarms = found["false alarms"]
        print(f"{name}: {caught} of {CASES} caught, {alarms} of {CASES} correct files refused")
        for key in sorted(found):
            print(f"    {key}: {found[key]}")


if __name__ == "__main__":
    main()
