"""Compare a deployment file with the log of a robot that hangs in a stand."""

import time
from pathlib import Path

from neuralgaits.analysis.run import open_run
from neuralgaits.deployment.deployed_robot import DeployedRobot
from neuralgaits.deployment.deployment_file import DeploymentFile
from neuralgaits.deployment.deployment_reader import read_deployment, run_of_deployment
from neuralgaits.deployment.hung_log import hung_log_text, read_hung_log
from neuralgaits.deployment.hung_robot import HungRobotSettings, hung_log
from neuralgaits.deployment.log_comparison import compared, refuse_without_torso
from neuralgaits.errors import InputError
from neuralgaits.records.deployed import DeploymentCheck
from neuralgaits.runs.atomic import refuse_unwritable, write_bytes
from neuralgaits.runs.outputs import refuse_outputs
from neuralgaits.settings import CheckDeploySettings, called_with
from neuralgaits.workflows.deployed_run import deployed_robot


@called_with(CheckDeploySettings)
def check_deploy(settings: CheckDeploySettings) -> DeploymentCheck:
    """Compare a deployment file with a log of the robot in a stand.

    Returns: `DeploymentCheck`, a mapping of what `check-deploy --json` prints: agrees, findings
        (about, kind, found, remedy), joints (what was checked of each), unchecked, file, log, run,
        robot, wall_s.
    Raises: InputError in one line, or with all problems of the file or log; RunError if the run
        does not exist.
    """
    start_time = time.perf_counter()
    run = settings.run
    if run is None:
        run = run_of_deployment(Path(settings.file))
    trained = open_run(run)
    about = deployed_robot(trained)
    file = read_deployment(Path(settings.file), about)
    if settings.rehearse:
        refuse_outputs([Path(settings.log)], [Path(settings.file)], run=trained.path)
        _rehearse(Path(settings.log), about, file)
    joints = [one.joint for one in file.joints]
    log = read_hung_log(Path(settings.log), (*joints, *about.feet, "pitch", "zero"))
    findings, checks, unchecked = compared(file, about, log)
    return DeploymentCheck(
        file=str(Path(settings.file)),
        log=str(Path(settings.log)),
        run=str(run),
        robot=trained.robot.name,
        agrees=not findings,
        findings=tuple(findings),
        joints=checks,
        unchecked=tuple(unchecked),
        wall_s=time.perf_counter() - start_time,
    )


def _rehearse(path: Path, about: DeployedRobot, file: DeploymentFile) -> None:
    """Write the log of a simulated robot that fits a file.

    Raises: InputError if something is at the path already.
    """
    refuse_without_torso(about)
    if path.exists():
        raise InputError(
            f"--rehearse: expected no file at {path}, found one: name another, or leave --rehearse "
            "out to read it"
        )
    refuse_unwritable(path)
    log = hung_log(about.layout, file, 0, HungRobotSettings(directions=True, zero=True))
    write_bytes(path, hung_log_text(log).encode())
