"""The output folder: all files at once, or none."""

import os
import shutil
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from importlib import resources
from pathlib import Path

from neuralgaits.errors import InputError

_EXPORTER_ONLY = frozenset(("check.c",))


def shipped() -> dict[str, str]:
    """C files that are the same for every gait."""
    folder = resources.files("neuralgaits.export") / "c"
    return {
        entry.name: entry.read_text()
        for entry in sorted(folder.iterdir(), key=lambda entry: entry.name)
        if entry.is_file() and entry.name not in _EXPORTER_ONLY
    }


def harness() -> dict[str, str]:
    """C files that only the exporter compiles."""
    folder = resources.files("neuralgaits.export") / "c"
    return {name: (folder / name).read_text() for name in sorted(_EXPORTER_ONLY)}


def refuse_used(out: Path, *, force: bool) -> None:
    """Check the output folder. Raises: InputError if it is a file or holds something."""
    if out.exists() and not out.is_dir():
        raise InputError(f"expected a folder to write to, found a file at {out}: name another")
    if not force and out.is_dir() and any(out.iterdir()):
        raise InputError(
            f"expected an empty folder at {out}, found files in it: name another, or --force to "
            "replace the files of an export"
        )


@contextmanager
def scratch(files: Mapping[str, str]) -> Iterator[Path]:
    """A folder with these files that is gone afterwards."""
    with tempfile.TemporaryDirectory(prefix="neuralgaits-") as name:
        folder = Path(name)
        for file, text in files.items():
            (folder / file).write_text(text)
        yield folder


def publish(out: Path, files: Mapping[str, str | bytes]) -> list[str]:
    """Put files into a folder: a new folder appears whole, each replaced file too.

    Returns: paths of the files.
    """
    out.parent.mkdir(parents=True, exist_ok=True)
    made = Path(tempfile.mkdtemp(prefix=f".{out.name}.", suffix=".tmp", dir=out.parent))
    try:
        for file, content in files.items():
            data = content.encode() if isinstance(content, str) else content
            (made / file).write_bytes(data)
        made.chmod(0o755)
        if out.is_dir() and any(out.iterdir()):
            # Killed here, this leaves an export that lacks files, and none that is mixed from two.
            for file in files:
                (out / file).unlink(missing_ok=True)
            for file in files:
                os.replace(made / file, out / file)
            made.rmdir()
        else:
            os.replace(made, out)
    except BaseException:
        shutil.rmtree(made, ignore_errors=True)
        raise
    return [str(out / file) for file in sorted(files)]
