"""Make a run of a gait from elsewhere: Bézier outputs, and a tube around their orbit."""

import time
from pathlib import Path

from neuralgaits.analysis.run import Run
from neuralgaits.hzd.gait_file import read_gait
from neuralgaits.records.training_config import GaitOrigin
from neuralgaits.robots import PlanarBiped
from neuralgaits.runs import RUNS_ROOT
from neuralgaits.workflows.given_run import given_run


def import_gait(
    file: str | Path,
    robot: PlanarBiped,
    *,
    name: str | None = None,
    out: str | Path | None = None,
    root: Path = RUNS_ROOT,
) -> Run:
    """Make a run of a published gait, which every other verb takes.

    Args:
        file: file of the gait, see `hzd.gait_file`.
        robot: robot that it walks on, of `load_robot`.
        name: name of the gait, if the file has several.
        out: the run folder; `runs/ROBOT/<UTC time>-<seed>` if None.
        root: folder of the runs.

    Raises: InputError on a file for another robot, or a gait without an attracting orbit.
    """
    start_time = time.perf_counter()
    gait = read_gait(Path(file), robot, name)
    given = GaitOrigin("import-gait", gait.degree)
    return given_run(robot, gait, given, start_time=start_time, out=out, root=root)
