"""Read a deployment file, and name all that is wrong in it at once."""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

from neuralgaits._printable import printable
from neuralgaits.deployment.deployed_robot import DeployedRobot
from neuralgaits.deployment.deployment_checks import (
    contact_problems,
    hash_problems,
    joint_problems,
)
from neuralgaits.deployment.deployment_file import (
    FORMAT,
    ContactChannel,
    DeployedJoint,
    DeploymentFile,
    FileHash,
    ImuMount,
)
from neuralgaits.deployment.yaml_fields import FieldReader
from neuralgaits.deployment.yaml_tree import YamlNode, yaml_tree
from neuralgaits.errors import InputError, ManyProblems
from neuralgaits.runs.hashes import sha256

JOINT_FIELDS = {
    "joint": "text",
    "motor": "index",
    "sign": "sign",
    "zero_rad": "number",
    "gear": "positive",
    "lower_rad": "number",
    "upper_rad": "number",
    "torque_limit_nm": "positive",
    "kp_nm_rad": "not negative",
    "kd_nms_rad": "not negative",
}
"""Keys of a joint, and what each must be."""


def run_of_deployment(path: str | Path) -> str:
    """Return the run that a deployment file names.

    Raises: InputError as `yaml_tree`, or if the file names none.
    """
    tree = yaml_tree(Path(path))
    value = tree.value.get("run") if isinstance(tree.value, dict) else None
    if value is None or not isinstance(value.value, str) or not value.value:
        raise InputError(
            f"{printable(Path(path))}: expected the key run with the folder of a run, found none: "
            "name the run beside the file"
        )
    return value.value


def read_deployment(path: str | Path, about: DeployedRobot) -> DeploymentFile:
    """Read a deployment file of a run.

    Args:
        path: the YAML file.
        about: robot, files and period that it must match.

    Returns: `DeploymentFile`.
    Raises: InputError for one problem, ManyProblems with all of them otherwise, one line each.
    """
    file = printable(Path(path))
    reader = FieldReader(file)
    deployment = _deployment(reader, yaml_tree(Path(path)))
    problems = list(reader.problems)
    if deployment is not None:
        problems += hash_problems(file, deployment, about)
        problems += joint_problems(file, deployment.joints, about, whole=not reader.problems)
        problems += contact_problems(file, deployment.contacts, about, whole=not reader.problems)
    if len(problems) > 1:
        raise ManyProblems(problems)
    if problems:
        raise InputError(problems[0])
    assert deployment is not None
    return replace(deployment, sha256=sha256(Path(path).read_bytes()))


def _deployment(reader: FieldReader, tree: YamlNode) -> DeploymentFile | None:
    """Return what could be read; None if the file is no mapping."""
    kinds = {
        "deployment": "index",
        "run": "text",
        "files": "keys",
        "period_s": "positive",
        "imu": "keys",
        "contacts": "list",
        "joints": "list",
    }
    top = reader.fields(tree, "the file", kinds)
    if top is None:
        return None
    version = top.get("deployment", FORMAT)
    if version != FORMAT:
        reader.note(tree.line, "deployment", f"{FORMAT}", f"{version}", "update the package")
    files = _files(reader, top.get("files"))
    imu = reader.fields(top.get("imu"), "imu", {"pitch_sign": "sign", "pitch_zero_rad": "number"})
    mount = ImuMount(**imu) if imu is not None and len(imu) == 2 else ImuMount(1, 0.0)
    joints = reader.rows(top.get("joints"), "joints", JOINT_FIELDS)
    contact_fields = {
        "foot": "text",
        "channel": "index",
        "newton_per_unit": "number",
        "zero_unit": "number",
    }
    contacts = reader.rows(top.get("contacts"), "contacts", contact_fields)
    return DeploymentFile(
        run=top.get("run", ""),
        robot=files.get("robot") or FileHash("", ""),
        policy=files.get("policy") or FileHash("", ""),
        proof=files.get("proof"),
        period_s=top.get("period_s", 0.0),
        imu=mount,
        contacts=tuple(ContactChannel(**row) for row in contacts),
        joints=tuple(DeployedJoint(**row) for row in joints),
    )


def _files(reader: FieldReader, node: YamlNode | None) -> Mapping[str, FileHash | None]:
    """Return the files of the run by what they are."""
    files: dict[str, FileHash | None] = {}
    rows = reader.fields(
        node, "files", {"robot": "keys", "policy": "keys", "proof": "keys or null"}
    )
    for name, one in (rows or {}).items():
        if one is None:
            files[name] = None
            continue
        inner = reader.fields(one, f"files.{name}", {"name": "text", "sha256": "sha256"})
        if inner is not None and len(inner) == 2:
            files[name] = FileHash(**inner)
    return files
