"""A robot file for a user to go on with: new, and whole or not at all."""

from pathlib import Path

from neuralgaits.errors import InputError
from neuralgaits.runs.atomic import write_text


def write_robot_file(out: Path, text: str) -> None:
    """Write MJCF text to a file that is not there yet.

    Raises: InputError if it is there: it may be the only copy of somebody's robot.
    """
    if out.exists() or out.is_symlink():
        raise InputError(f"expected a file to make, found that {out} is there: give another name")
    write_text(out, text)
