"""Write the output folder: all files at once, or none."""

import os
import shutil
import tempfile
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from importlib import resources
from pathlib import Path

from neuralgaits.errors import InputError
from neuralgaits.runs.atomic import (
    folder_destination,
    refuse_unwritable,
    write_bytes,
    write_together,
)
from neuralgaits.runs.outputs import refuse_folder_of_run

_EXPORTER_ONLY = frozenset(("check.c", "check_monitor.c"))
"""Files with which an export is compared with Python; no controller has them."""
_MONITOR_FILES = frozenset(("monitor.h", "monitor.c"))
"""Files that only a gait with a proof has."""
_ADAPTATION_FILES = frozenset(("adapt.h", "adapt.c"))
"""Files that only a gait with a commanded speed has."""
_BOARD_FILES = frozenset(("board_map.h", "board_map.c"))
"""Files that only an export with a deployment file has, but for its numbers."""


def shipped() -> dict[str, str]:
    """Return C files that are the same for every gait."""
    folder = resources.files("neuralgaits.export") / "c"
    apart = _EXPORTER_ONLY | _MONITOR_FILES | _ADAPTATION_FILES | _BOARD_FILES
    return {
        entry.name: entry.read_text(encoding="utf-8")
        for entry in sorted(folder.iterdir(), key=lambda entry: entry.name)
        if entry.is_file() and entry.name not in apart
    }


def harness() -> dict[str, str]:
    """Return C files that only the exporter compiles."""
    return _files(_EXPORTER_ONLY)


def monitor() -> dict[str, str]:
    """Return C files of the monitor that are the same for every gait that has one."""
    return _files(_MONITOR_FILES)


def adaptation() -> dict[str, str]:
    """Return C files that adapt a commanded speed."""
    return _files(_ADAPTATION_FILES)


def board() -> dict[str, str]:
    """Return C files of the map between joints and motors that are the same for every board."""
    return _files(_BOARD_FILES)


def _files(names: Iterable[str]) -> dict[str, str]:
    folder = resources.files("neuralgaits.export") / "c"
    return {name: (folder / name).read_text(encoding="utf-8") for name in sorted(names)}


def refuse_used(out: Path, *, force: bool) -> None:
    """Check the output folder.

    Raises: InputError if it is no folder, not empty, or a run's own with or without `force`.
    """
    place = folder_destination(out)
    refuse_folder_of_run(out)
    if not force and place.is_dir() and any(place.iterdir()):
        raise InputError(
            f"expected an empty folder at {out}, found files in it: name another, or --force to "
            "replace the files of an export"
        )
    there = sorted(place.iterdir()) if place.is_dir() else []
    # Suffixes of the files of an export.
    suffixes = ".c .h .onnx .fmu .cpp .hpp .xml .txt .vnnlib .csv .md".split()
    ours = [out / entry.name for entry in there if entry.suffix in suffixes]
    refuse_unwritable(*ours, own=True)
    refuse_unwritable(out / "gait.h")


def refuse_stale_map(out: Path) -> None:
    """Refuse a folder with the map of an earlier export, beside a controller that has none.

    Raises: InputError if there is such a file.
    """
    board_facts = frozenset(("board_facts.h", "board_facts.c"))
    stale = sorted(name for name in _BOARD_FILES | board_facts if (out / name).exists())
    if stale:
        raise InputError(
            f"expected no {stale[0]} in {out}, found that of an export with --config, whose map "
            f"would stay beside this controller: give --config again, or delete {', '.join(stale)}"
        )


def refuse_stale_queries(out: Path, files: Iterable[str]) -> None:
    """Refuse a folder with queries of an earlier export that queries among these do not replace.

    Raises: InputError if there is such a file.
    """
    new = {name for name in files if name.endswith(".vnnlib")}
    stale = sorted(file.name for file in out.glob("*.vnnlib") if file.name not in new)
    if new and stale:
        raise InputError(
            f"expected queries of this run alone in {out}, found {stale[0]}"
            f"{f' and {len(stale) - 1} more' if stale[1:] else ''} of another: name another "
            "folder, or delete them"
        )


def differs(file: Path, text: str) -> bool:
    """Return whether there is a file with another text."""
    return file.is_file() and file.read_bytes() != text.encode()


@contextmanager
def scratch(files: Mapping[str, str]) -> Iterator[Path]:
    """Provide a folder with these files, which is deleted afterwards."""
    with tempfile.TemporaryDirectory(prefix="neuralgaits-") as name:
        folder = Path(name)
        for file, text in files.items():
            (folder / file).write_text(text, encoding="utf-8")
        yield folder


def publish(out: Path, files: Mapping[str, str | bytes]) -> list[str]:
    """Put files into a folder: a new folder appears in one piece, and so does each replaced file.

    Returns: paths of the files.
    Raises: InputError or OSError, as in `runs.atomic`; the folder is unchanged then.
    """
    contents = {
        file: content.encode() if isinstance(content, str) else content
        for file, content in files.items()
    }
    place = folder_destination(out)
    if place.is_dir():
        # Killed here, this leaves an export that lacks files, and none that is mixed from two.
        write_together({place / file: data for file, data in contents.items()}, clear=True)
    else:
        _publish_new(place, contents)
    return [str(out / file) for file in sorted(files)]


def _publish_new(place: Path, contents: Mapping[str, bytes]) -> None:
    """Make a folder with these files, in one piece or not at all."""
    place.parent.mkdir(parents=True, exist_ok=True)
    temporary = Path(
        tempfile.mkdtemp(prefix=f".{place.name[:40]}.", suffix=".tmp", dir=place.parent)
    )
    try:
        for file, data in contents.items():
            write_bytes(temporary / file, data)
        temporary.chmod(0o755)
        os.replace(temporary, place)
    except BaseException:
        shutil.rmtree(temporary, ignore_errors=True)
        raise
