"""A run as its deployment file is about it: robot, files, period and gains."""

import numpy as np

from neuralgaits.analysis.run import Run
from neuralgaits.control import Pd
from neuralgaits.control.controller import Controller
from neuralgaits.control.safeguard import joint_ranges, torque_limits
from neuralgaits.deployment.deployed_robot import DeployedRobot, joint_facts
from neuralgaits.deployment.deployment_file import FileHash
from neuralgaits.deployment.hanging_leg import HangingLeg
from neuralgaits.export.design import Design
from neuralgaits.records.certified import PROOF
from neuralgaits.runs.hashes import file_hashes
from neuralgaits.runs.names import ROBOT, WEIGHTS
from neuralgaits.simulation.setup.starts import momentum_range


def deployed_robot(trained: Run) -> DeployedRobot:
    """Return what a deployment file of a run must match."""
    hashes = file_hashes(trained.path, (ROBOT, WEIGHTS, PROOF))
    by_role = {"robot": ROBOT, "policy": WEIGHTS, "proof": PROOF}
    files = {
        role: None if (digest := hashes[name]) is None else FileHash(name, digest)
        for role, name in by_role.items()
    }
    gait, robot = trained.trained, trained.robot
    controller = Controller.init(robot, gait.policy, Pd(), z2_range=momentum_range(gait))
    return DeployedRobot(
        name=robot.name,
        layout=robot.layout,
        leg=HangingLeg.of(robot.layout, robot.name, float(robot.gravity)),
        weight_n=float(robot.mass * robot.gravity),
        joints=joint_facts(robot.layout, joint_ranges(robot), torque_limits(robot)),
        run=str(trained.path),
        files=files,
        period_s=controller.period_s,
    )


def usual_gains(design: Design) -> tuple[float, float]:
    """Return gains for drives that close the loop of `pd` [N m/rad], [N m s/rad], to 3 digits."""
    law = next(c.law for c in design.controllers.values() if isinstance(c.law, Pd))
    stiffness, damping = (
        float(f"{np.mean(gains or (0.0,)):.3g}") for gains in (law.stiffness, law.damping)
    )
    return stiffness, damping
