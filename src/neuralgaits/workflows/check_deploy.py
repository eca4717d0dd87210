"""Compare a deployment file with the log of a robot that hangs in a stand."""

import time
from pathlib import Path

from neuralgaits.analysis.run import open_run
from neuralgaits.deployment.deployment_reader import read_deployment, run_of_deployment
from neuralgaits.deployment.hung_log import read_hung_log
from neuralgaits.deployment.log_comparison import compared
from neuralgaits.records.deployed import DeploymentCheck
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
        run = run_of_deployment(settings.file)
    trained = open_run(run)
    about = deployed_robot(trained)
    file = read_deployment(settings.file, about)
    joints = [one.joint for one in file.joints]
    log = read_hung_log(settings.log, (*joints, *about.feet, "pitch", "zero"))
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
