"""Write a log in the format that its file's name asks for."""

from pathlib import Path

from neuralgaits.logs.formats import mcap_walk, si
from neuralgaits.logs.formats.mcap_reader import SUFFIX, refuse_without_extra
from neuralgaits.logs.walk_table import Log


def refuse_unwritable_log(path: Path) -> None:
    """Refuse a log that could not be written later. Raises: InputError without the extra."""
    if path.suffix.lower() == SUFFIX:
        refuse_without_extra(path)


def write(path: Path, log: Log) -> None:
    """Write a log, whole or not at all: as MCAP if the name ends in .mcap, else as CSV.

    Raises: InputError for a log without z, which both formats require, and without the extra
        for MCAP.
    """
    refuse_unwritable_log(path)
    (mcap_walk if path.suffix.lower() == SUFFIX else si).write(path, log)
