"""Optimise a gait of Bézier outputs at one speed, by collocation, and make a run of it."""

import time
from pathlib import Path

from neuralgaits._commands import FASTEST
from neuralgaits.analysis.run import Run
from neuralgaits.errors import InputError
from neuralgaits.gait import ZeroDynamics
from neuralgaits.gait.reach import refuse_speed
from neuralgaits.hzd.solver import Optimiser
from neuralgaits.records.training_config import HIGHEST_DEGREE, GaitOrigin
from neuralgaits.runs import RunFolder
from neuralgaits.settings import OptimiseSettings, called_with
from neuralgaits.workflows.given_run import given_run
from neuralgaits.workflows.planarise import robot_from


@called_with(OptimiseSettings)
def optimise(settings: OptimiseSettings) -> Run:
    """Make a run of the gait with the least mechanical cost of transport at a speed.

    The conditions of spec `walking` hold along its orbit: contact, friction, torques, joint rates
    and ranges, clearance of the swing foot, a clean impact.

    Raises: InputError without CasADi (extra `hzd`) or on bad settings; ConvergenceError if the
        solver finds no gait.
    """
    start_time = time.perf_counter()
    robot = robot_from(settings.robot)
    speed = settings.speed
    degree = settings.degree
    out, root = settings.out, settings.root
    if not speed > 0.0:
        raise InputError(f"expected --speed above 0 m/s, found {speed:g}")
    if speed > FASTEST:
        raise InputError(f"expected --speed of at most {FASTEST:g} m/s, found {speed:g}")
    refuse_speed(robot, speed)
    lowest = 3  # The impact fixes the rates at both ends: lower degrees leave no freedom.
    if not lowest <= degree <= HIGHEST_DEGREE:
        raise InputError(f"expected --degree from {lowest} to {HIGHEST_DEGREE}, found {degree}")
    RunFolder.refuse(root, None if out is None else Path(out))
    optimiser = Optimiser(robot, degree)
    if settings.begun is not None:
        settings.begun()
    optimum = optimiser.at(speed)
    origin = GaitOrigin("optimise", degree, speed)
    return given_run(
        ZeroDynamics(robot, optimum.gait.policy),
        optimum.gait,
        origin,
        solve_s=optimum.solve_s,
        start_time=start_time,
        out=out,
        root=root,
    )
