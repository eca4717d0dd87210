"""JSON files of a run, read or refused in one line."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from neuralgaits.errors import RunError
from neuralgaits.runs.file_content import file_content
from neuralgaits.runs.plain import object_from_json
from neuralgaits.runs.shape import Shape, complaint


def read_object(path: Path) -> dict[str, Any]:
    """Read a JSON object. Raises: RunError if it is missing or damaged."""
    if not path.is_file():
        raise RunError(f"expected {path}, found none: the run is incomplete")
    try:
        return object_from_json(file_content(path))
    except ValueError as error:
        raise RunError(
            f"expected a JSON object in {path}, found {error}: restore it or train again"
        ) from None


def refuse_misshapen(value: Mapping[str, Any], shape: Shape, path: Path) -> None:
    """Raise RunError if a JSON file can be read but has not the shape that its writer gives it."""
    wrong = complaint(value, shape)
    if wrong is not None:
        raise RunError(
            f"{path} is damaged or of another version, {wrong}: restore it, or make it again"
        )
