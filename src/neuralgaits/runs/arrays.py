"""Named arrays as safetensors: a format that holds bytes, shapes and dtypes and can run no code.

Needs no JAX; trees of arrays are in `tree`.
"""

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import safetensors
from safetensors.numpy import save

from neuralgaits.errors import RunError
from neuralgaits.runs.atomic import write_bytes


def write_arrays(path: Path, arrays: Mapping[str, np.ndarray], metadata: Mapping[str, str]) -> None:
    """Save arrays under plain names, with text entries beside them."""
    kept = {name: np.array(array, order="C") for name, array in arrays.items()}
    write_bytes(path, save(kept, metadata=dict(metadata)))


def read_arrays(path: Path) -> tuple[dict[str, np.ndarray], dict[str, str]]:
    """Arrays and text entries of a file, whatever it holds.

    Raises: RunError if it is missing or damaged.
    """
    if not path.is_file():
        raise RunError(f"expected a weights file at {path}, found none: the run is incomplete")
    try:
        with safetensors.safe_open(path, framework="numpy") as file:
            arrays = {name: file.get_tensor(name) for name in file.keys()}
            return arrays, dict(file.metadata() or {})
    except safetensors.SafetensorError as error:
        reason = " ".join(str(error).split())
        raise RunError(
            f"expected safetensors in {path}, found a damaged file ({reason}): train again"
        ) from error
