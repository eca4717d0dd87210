"""Named arrays as safetensors: a format that holds bytes, shapes and dtypes and can run no code.

A written file carries the sha256 of its content, so that a flipped bit is not taken for a number.
This file needs no JAX; trees of arrays are in `tree`.
"""

import hashlib
import json
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import safetensors
from safetensors.numpy import save

from neuralgaits.errors import RunError
from neuralgaits.runs.atomic import write_bytes
from neuralgaits.runs.file_content import refuse_large

SHA256 = "sha256"
"""Name of a file's text entry with the hash of all its arrays and other entries."""


def packed(arrays: Mapping[str, np.ndarray], metadata: Mapping[str, str]) -> bytes:
    """Return the content of a file. The same arrays and entries give the same bytes."""
    # safetensors writes the buffer as it lies in memory.
    contiguous = {name: np.array(array, order="C") for name, array in arrays.items()}
    data = save(contiguous, metadata=dict(metadata) | {SHA256: _digest(contiguous, metadata)})
    # The library writes the entries in an order of its own, another one each time.
    length = 8  # Bytes of a header's length, and the multiple to which the header is padded.
    end = length + int.from_bytes(data[:length], "little")
    table = json.loads(data[length:end])
    header = json.dumps(table, sort_keys=True, separators=(",", ":"), ensure_ascii=False).encode()
    header += b" " * (-len(header) % length)
    return len(header).to_bytes(length, "little") + header + data[end:]


def _digest(arrays: Mapping[str, np.ndarray], metadata: Mapping[str, str]) -> str:
    digest = hashlib.sha256(json.dumps(sorted(metadata.items())).encode())
    for name, array in sorted(arrays.items()):
        digest.update(json.dumps([name, array.dtype.str, array.shape]).encode())
        digest.update(array.tobytes())
    return digest.hexdigest()


def write_arrays(path: Path, arrays: Mapping[str, np.ndarray], metadata: Mapping[str, str]) -> None:
    """Save arrays under plain names, with text entries beside them."""
    write_bytes(path, packed(arrays, metadata))


def read_arrays(path: Path) -> tuple[dict[str, np.ndarray], dict[str, str]]:
    """Read arrays and text entries of a file, of any names and shapes.

    Raises: RunError if it is missing or damaged.
    """
    if not path.is_file():
        raise RunError(f"expected a weights file at {path}, found none: the run is incomplete")
    refuse_large(path)
    try:
        with safetensors.safe_open(path, framework="numpy") as file:
            arrays = {name: file.get_tensor(name) for name in file.keys()}
            metadata = dict(file.metadata() or {})
        rest = {name: text for name, text in metadata.items() if name != SHA256}
        # Files of other programs, and of earlier versions, have none.
        if metadata.get(SHA256, "") not in ("", _digest(arrays, rest)):
            raise ValueError("its sha256 is another")
        return arrays, metadata
    except (safetensors.SafetensorError, ValueError, TypeError) as error:
        reason = " ".join(str(error).split())
        raise RunError(
            f"expected safetensors in {path}, found a damaged file ({reason}): train again"
        ) from error
