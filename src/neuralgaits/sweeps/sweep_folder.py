"""A sweep on disk: its settings, and a run folder for each row.

sweep.json      the settings            inputs/            robots, and specs of files
rows/NAME/      the run of a row, which every other verb opens, with row.json
failed/NAME.json                        rows that could not be carried out
table.csv, sweep.html, summary.json     the results
"""

import contextlib
import json
import os
import shutil
import tempfile
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from neuralgaits.engine import Files
from neuralgaits.errors import InputError, RunError
from neuralgaits.records.episode_records import FormatVersion
from neuralgaits.records.swept import CONFIG_FILE, FORMAT, ROW, SweepConfig, SweepRow
from neuralgaits.runs import plain, to_json, write_bytes, write_text
from neuralgaits.runs.claim import claimed
from neuralgaits.runs.file_content import file_content
from neuralgaits.runs.hashes import sha256
from neuralgaits.runs.only_writer import only_writer

HOME = "sweeps"
"""Name of the sweeps' folder below the root of the runs."""
INPUTS, ROWS, FAILED = "inputs", "rows", "failed"
_UNFINISHED = "."
"""Prefix of the names of rows that are still being written."""


@dataclass(frozen=True)
class SweepFolder:
    """A sweep that has been started. Attributes: path: its folder; config: its settings."""

    path: Path
    config: SweepConfig

    @classmethod
    def create(
        cls, config: SweepConfig, inputs: Files, *, out: Path | None, root: Path
    ) -> "SweepFolder":
        """Make a folder; `sweep.json` is written last. Raises: RunError if `out` is not empty."""
        seed, what = config.seeds[0], "the sweep"
        with claimed(out, root, HOME, seed, what=what, config=CONFIG_FILE) as path:
            for name, content in inputs.items():
                write_bytes(path / INPUTS / name, content)
            write_text(path / CONFIG_FILE, to_json(config))
        return cls(path, config)

    @classmethod
    def there(cls, path: Path) -> bool:
        """Return whether a folder holds a sweep."""
        return (path / CONFIG_FILE).is_file()

    @classmethod
    def open(cls, path: Path) -> "SweepFolder":
        """Open a sweep. Raises: RunError if there is none, or one of another version."""
        if not cls.there(path):
            raise RunError(
                f"expected {CONFIG_FILE} in {path}, found none: there is no sweep to go on with; "
                "leave --resume out"
            )
        version = FormatVersion.read(path / CONFIG_FILE).format
        if version != FORMAT:
            raise RunError(
                f"expected a sweep of format {FORMAT}, found {version!r} in {path}: sweep anew"
            )
        return cls(path, SweepConfig.read(path / CONFIG_FILE))

    def input(self, name: str) -> bytes:
        """Return an input file of the sweep. Raises: RunError if the file has changed since."""
        path = self.path / INPUTS / name
        content = file_content(path) if path.is_file() else b""
        if sha256(content) != self.config.sha256[name]:
            raise RunError(
                f"expected {path} as it was when the sweep began, found another sha256: restore it"
            )
        return content

    @contextlib.contextmanager
    def alone(self) -> Iterator["SweepFolder"]:
        """Reserve the folder for one command, and drop rows that are half written or failed.

        A command that is killed releases it. Raises: InputError if another command holds it.
        """
        with only_writer(self.path):
            self._clear()
            yield self

    def _clear(self) -> None:
        """Delete rows that are half written, and failed rows, which are tried again."""
        for path in (self.path / ROWS).glob(f"{_UNFINISHED}*"):
            shutil.rmtree(path, ignore_errors=True)
        shutil.rmtree(self.path / FAILED, ignore_errors=True)

    def refuse_other(self, settings: Mapping[str, Any]) -> None:
        """Refuse settings that differ from those of the sweep. Raises: InputError."""
        for name, value in settings.items():
            recorded = getattr(self.config, name)
            if plain(recorded) != plain(value):
                raise InputError(
                    f"expected the {name} that the sweep in {self.path} was asked, "
                    f"{_short(recorded)}, found {_short(value)}: leave them out, or sweep into "
                    "another --out"
                )

    def place(self, name: str) -> Path:
        """Return the run folder of a row."""
        return self.path / ROWS / name

    def has(self, name: str) -> bool:
        """Return whether a row is complete in the folder."""
        return (self.place(name) / ROW).is_file()

    def row(self, name: str) -> SweepRow | None:
        """Read a row that is done or failed; None if it is still to be done. Raises: RunError."""
        failed = self.path / FAILED / f"{name}.json"
        for path in (self.place(name) / ROW, failed):
            if path.is_file():
                return SweepRow.read(path)
        return None

    def rows(self, names: Iterable[str]) -> list[SweepRow]:
        """Read all rows, in the order of `names`. Raises: RunError if one is missing."""
        named_rows = [(name, self.row(name)) for name in names]
        for name, row in named_rows:
            if row is None:
                raise RunError(
                    f"expected the row {name} in {self.path}, found none: it was taken away; "
                    "--resume makes it again"
                )
        return [row for _, row in named_rows if row is not None]

    def keep(self, row: SweepRow, files: Mapping[str, bytes]) -> None:
        """Put a row into the folder with all its files, or not at all."""
        if not row.final:
            write_text(self.path / FAILED / f"{row.name}.json", to_json(row))
            return
        rows = self.path / ROWS
        rows.mkdir(parents=True, exist_ok=True)
        place = Path(tempfile.mkdtemp(dir=rows, prefix=_UNFINISHED))
        try:
            for name, content in files.items():
                write_bytes(place / name, content)
            write_text(place / ROW, to_json(row))
            # mkdtemp keeps others out; a run is as readable as any folder of its user.
            place.chmod(rows.stat().st_mode)
            os.replace(place, self.place(row.name))
        except BaseException:
            shutil.rmtree(place, ignore_errors=True)
            raise


def _short(value: Any) -> str:
    characters = 80
    return json.dumps(plain(value), ensure_ascii=False)[:characters]
