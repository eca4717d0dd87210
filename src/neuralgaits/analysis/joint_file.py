"""The file of identified joints that a controller is to know of."""

from pathlib import Path
from typing import NamedTuple

from neuralgaits._inputs import refuse_unreadable
from neuralgaits.analysis.run import Run
from neuralgaits.control.joint_model import JointModel
from neuralgaits.errors import InputError, RunError
from neuralgaits.records.identified_joints import IdentifiedJoints
from neuralgaits.runs.hashes import file_hashes, sha256
from neuralgaits.runs.latest import LATEST
from neuralgaits.runs.names import JOINTS, ROBOT
from neuralgaits.runs.shell_words import command, named


class JointFile(NamedTuple):
    """Identified joints of a run's robot.

    Attributes:
        model: rotors and friction.
        sha256: hash of the file.
    """

    model: JointModel
    sha256: str


def read_joints(run: Run, joints: str | Path) -> JointFile:
    """Read the joints that `fit --joints` identified for a run's robot.

    Args:
        run: the run.
        joints: file, or `latest` for the run's own.

    Raises: InputError if it is missing, damaged, or of another robot.
    """
    own = str(joints) == LATEST
    path = run.path / JOINTS if own else Path(joints)
    fit = command("fit", named(run.path), "LOG.csv", "--joints")
    refuse_unreadable(path, remedy="is it a file of `fit --joints`?")
    try:
        content = path.read_bytes()
        identified = IdentifiedJoints.read(path)
    except (OSError, RunError):
        what = "another file" if path.is_file() else "none"
        raise InputError(
            f"--joints: expected identified joints in {path}, found {what}: write them with `{fit}`"
        ) from None
    pairs = zip(*run.robot.layout.leg_joints, strict=True)
    names = tuple(tuple(dict.fromkeys(pair)) for pair in pairs)
    same = identified.sha256.get(ROBOT) == file_hashes(run.path, (ROBOT,))[ROBOT]
    if not same or tuple(joint.names for joint in identified.joints) != names:
        raise InputError(
            f"--joints: expected joints of the robot file of {run.path}, found those of another "
            f"in {path}: identify its own with `{fit}`"
        )
    columns = [
        [getattr(joint, name).value for joint in identified.joints]
        for name in ("armature_kg_m2", "damping_nms_rad", "friction_nm")
    ]
    most = 1e6  # Largest rotor inertia or friction of a joint, in SI units: no robot has so much.
    if not all(0.0 <= value <= most for column in columns for value in column):
        raise InputError(
            f"--joints: expected rotors and friction from 0 to {most:g}, found others in {path}: "
            f"identify them again with `{fit}`"
        )
    return JointFile(JointModel.of_leg(run.robot.n - 1, *columns), sha256(content))
