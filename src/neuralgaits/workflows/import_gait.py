"""Make a run of a gait from elsewhere: Bézier outputs, and a tube around their orbit."""

import time
from pathlib import Path

from neuralgaits.analysis.run import Run
from neuralgaits.gait import ZeroDynamics
from neuralgaits.hzd.gait_file import read_gait
from neuralgaits.records.training_config import GaitOrigin
from neuralgaits.settings import ImportGaitSettings, called_with
from neuralgaits.workflows.given_run import given_run
from neuralgaits.workflows.planarise import robot_from


@called_with(ImportGaitSettings)
def import_gait(settings: ImportGaitSettings) -> Run:
    """Make a run of a published gait, which every other verb takes.

    Raises: InputError on a file for another robot, or a gait without an attracting orbit.
    """
    start_time = time.perf_counter()
    robot = robot_from(settings.robot)
    out = settings.out
    root = settings.root
    gait = read_gait(Path(settings.file), robot, settings.name)
    origin = GaitOrigin("import-gait", gait.degree)
    if settings.begun is not None:
        settings.begun()
    return given_run(
        ZeroDynamics(robot, gait.policy), gait, origin, start_time=start_time, out=out, root=root
    )
