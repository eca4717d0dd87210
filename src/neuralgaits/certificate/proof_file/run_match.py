"""Compare a proof with a run: names, files of robot, weights and spec, and the weights used.

Reads the run's files as bytes, its weights as safetensors and the robot's name as XML, with the
standard library and NumPy only.
"""

import hashlib
import json
from pathlib import Path
from xml.etree import ElementTree

import numpy as np

from neuralgaits.certificate.proof_file.reader import Claims
from neuralgaits.errors import RunError
from neuralgaits.runs.file_content import MOST_ARRAYS_BYTES, file_content
from neuralgaits.runs.names import CONFIG, ROBOT, SPEC, WEIGHTS


def differences(claims: Claims, run: Path) -> list[str]:
    """List the differences between the proof and the run, one sentence each; empty if none.

    Raises: RunError if a file of the run is missing or its weights cannot be read.
    """
    messages = _names_that_differ(claims, run / CONFIG)
    named = robot_name(_bytes(run / ROBOT))
    if named is not None and named != _without_blanks(claims.robot[0]):
        messages.append(f"robot: {ROBOT} names its model {named!r}, the proof {claims.robot[0]!r}")
    expected = {ROBOT: claims.robot[1], WEIGHTS: claims.weights_sha256, SPEC: claims.spec[1]}
    for file, proved in expected.items():
        digest = hashlib.sha256(_bytes(run / file)).hexdigest()
        if digest != proved:
            messages.append(f"{file}: the run has sha256 {digest}, the proof {proved}")
    return messages + _weights_that_differ(claims, run / WEIGHTS)


def robot_name(text: bytes) -> str | None:
    """Return the name that a robot file gives its model; None if it gives none."""
    try:
        name = ElementTree.fromstring(text).get("model", "")
    except (ElementTree.ParseError, ValueError, LookupError):
        return None  # No robot: who loads it says so.
    # Name that MuJoCo gives a model without one; the robot is then called as its file was.
    unnamed = "MuJoCo Model"
    return None if name in ("", unnamed) else _without_blanks(name)


def _without_blanks(name: str) -> str:
    """Return a name as XML readers agree on it: they read breaks and tabs in different ways."""
    return " ".join(name.split())


def _names_that_differ(claims: Claims, path: Path) -> list[str]:
    try:
        config = json.loads(_bytes(path))
        names = {"robot": config["robot"], "spec": config["spec"]}
    except (ValueError, KeyError, TypeError) as error:
        raise RunError(
            f"expected {CONFIG} of a run at {path}, found a damaged file ({error!r}): train again"
        ) from None
    proof_names = {"robot": claims.robot[0], "spec": claims.spec[0]}
    return [
        f"the proof is about {what} {proof_names[what]!r}, the run about {names[what]!r}"
        for what in names
        if names[what] != proof_names[what]
    ]


def _weights_that_differ(claims: Claims, path: Path) -> list[str]:
    """List named constants of the Program that differ from the run's arrays in any bit."""
    stored = _read_tensors(path)
    wrong = []
    # Prefixes of constants that are parameters of a theorem and not the gait's.
    sets = ("walking.", "orbit.", "full.", "disturbed.")
    for constant in claims.program.constants:
        if constant.name is None or constant.name.startswith(sets):
            continue
        array = stored.get(constant.name)
        same = (
            array is not None
            and array.shape == constant.array.shape
            and array.dtype == constant.array.dtype
            and array.tobytes() == constant.array.tobytes()
        )
        if not same:
            wrong.append(f"{constant.name}: the Program's numbers are not those of {path.name}")
    return wrong


def _read_tensors(path: Path) -> dict[str, np.ndarray]:
    """Return the float64 arrays of a safetensors file. Raises: RunError if it is damaged."""
    data = _bytes(path)
    try:
        size = int.from_bytes(data[:8], "little")
        table = json.loads(data[8 : 8 + size])
        body = data[8 + size :]
        tensors = {}
        for name, entry in table.items():
            if name != "__metadata__" and entry["dtype"] == "F64":
                start, end = entry["data_offsets"]
                array = np.frombuffer(body[start:end], dtype="<f8").astype(np.float64)
                tensors[name] = array.reshape(entry["shape"])
        return tensors
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        raise RunError(
            f"expected safetensors in {path}, found a damaged file ({error}): train again"
        ) from None


def _bytes(path: Path) -> bytes:
    if not path.is_file():
        raise RunError(f"expected {path} of the run to compare with, found none: give a run folder")
    return file_content(path, MOST_ARRAYS_BYTES)
