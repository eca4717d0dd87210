"""One run on disk: its settings, its training and its results.

A folder is made in this order, each file whole: copies of the inputs, `config.json` (from here on
it is a run), checkpoints, and last `summary.json` (from here on it is finished).
"""

import platform
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from importlib import metadata
from pathlib import Path
from typing import Any, TypeVar

from neuralgaits._names import meant
from neuralgaits._version import __version__
from neuralgaits.errors import RunError
from neuralgaits.runs.atomic import refuse_unwritable, write_bytes, write_text
from neuralgaits.runs.claim import claimed, refuse_taken
from neuralgaits.runs.file_content import MOST_METRICS_BYTES, file_content
from neuralgaits.runs.hashes import sha256
from neuralgaits.runs.json_files import read_object, refuse_misshapen
from neuralgaits.runs.metrics_table import Row, from_csv, to_csv
from neuralgaits.runs.names import CONFIG, METRICS, NAN_STATE, TRAINING_SUMMARY
from neuralgaits.runs.plain import to_json
from neuralgaits.runs.shape import TEXT, may, table_of
from neuralgaits.runs.shell_words import LATEST

FORMAT = 1
"""Version of the layout and meaning of a run folder; other versions are refused."""

_WHAT = "the run"

Tree = TypeVar("Tree")


@dataclass(frozen=True)
class RunFolder:
    """A run folder that exists and can be read.

    Attributes:
        path: the folder.
        config: content of `config.json`: the settings passed to `create`, with the format,
            the versions that wrote it, the time, and the sha256 of every copy.
    """

    path: Path
    config: Mapping[str, Any]

    @staticmethod
    def create(
        config: Mapping[str, Any],
        copies: Mapping[str, str | bytes],
        *,
        name: str,
        seed: int,
        root: Path,
        out: Path | None = None,
    ) -> "RunFolder":
        """Make a new run folder, `root/name/<UTC time>-<seed>` or `out`.

        Args:
            config: resolved configuration of the run; values that JSON can hold.
            copies: file name to content: inputs the run must be able to read again.
            name: name of the robot.
            seed: seed of the run.
            root: folder that holds the runs.
            out: exact place instead; may be an empty folder.

        Raises: RunError if `out` is a file or a folder that is not empty; InputError if it, or
            the pointer to the latest run, cannot be written.
        """
        refuse_unwritable(root / LATEST, own=True)
        contents = {
            file: content.encode() if isinstance(content, str) else content
            for file, content in copies.items()
        }
        hashes = {file: sha256(content) for file, content in contents.items()}
        header = {"format": FORMAT, "written_by": _versions(), "copies": hashes}
        header["created_utc"] = datetime.now(UTC).isoformat(timespec="seconds")
        if clash := sorted(set(header) & set(config)):
            raise ValueError(f"expected a config without the names {clash}: runs writes them")
        with claimed(out, root, name, seed, what=_WHAT, config=CONFIG) as path:
            for file, content in contents.items():
                write_bytes(path / file, content)
            write_text(path / CONFIG, to_json(header | dict(config)))
        return RunFolder.open(path)

    @staticmethod
    def refuse(root: Path, out: Path | None) -> None:
        """Refuse what `create` would, and make nothing. Raises: as `create`."""
        refuse_unwritable(root / LATEST, own=True)
        if out is not None:
            refuse_taken(out, what=_WHAT, config=CONFIG)

    @staticmethod
    def open(path: str | Path) -> "RunFolder":
        """Open an existing run folder, finished or not.

        Raises: RunError if it is missing, half-written or from another version.
        """
        path = Path(path)
        if not path.is_dir():
            kind = "a file" if path.exists() else "nothing"
            hint = meant(path, ["latest"])
            raise RunError(
                f"expected a run folder at {path}, found {kind}: "
                f"{hint or 'give the path of a run or `latest`'}"
            )
        if not (path / CONFIG).is_file():
            raise RunError(
                f"expected {CONFIG} in {path}, found none: it is not a run folder, or its run was "
                "killed while starting; give a run folder or `latest`, or train again"
            )
        config = read_object(path / CONFIG)
        if config.get("format") != FORMAT:
            written = config.get("written_by")
            table = written if isinstance(written, dict) else {}
            writer = table.get("neuralgaits", "an unknown version")
            raise RunError(
                f"expected run format {FORMAT}, found {config.get('format')!r} in {path} written "
                f"by neuralgaits {writer}: use that version, or train again with {__version__}"
            )
        # Fields of a config that this file writes; the stages write the rest.
        layout = {
            "copies": table_of(TEXT),
            "written_by": may(table_of(TEXT)),
            "created_utc": may(TEXT),
        }
        refuse_misshapen(config, layout, path / CONFIG)
        return RunFolder(path, config)

    @property
    def copies(self) -> Mapping[str, str]:
        """Hashes (sha256) of every input that was copied into the run, by file."""
        return self.config["copies"]

    @property
    def created_utc(self) -> str:
        """Start time of the run; empty if its config has none."""
        return self.config.get("created_utc") or ""

    @property
    def written_by(self) -> Mapping[str, str]:
        """Versions of the libraries that wrote the run, as far as its config lists them."""
        return self.config.get("written_by") or {}

    @property
    def finished(self) -> bool:
        """Whether the run's training has ended and its summary is on disk."""
        return (self.path / TRAINING_SUMMARY).is_file()

    @property
    def ended_in_nan(self) -> bool:
        """Whether the training stopped because its loss or weights turned to NaN."""
        return not self.finished and (self.path / NAN_STATE).is_file()

    @property
    def summary(self) -> dict[str, Any]:
        """Content of `summary.json`. Raises: RunError if it is missing or damaged."""
        return self.read_json(TRAINING_SUMMARY)

    def copy(self, file: str) -> str:
        """Return the text of an input copied into the run, exactly as it was.

        Raises: RunError if the copy is missing or no longer has its sha256.
        """
        path = self.copied(file)
        try:
            return file_content(path).decode()
        except UnicodeDecodeError as error:
            raise RunError(f"expected text in {path}, found {error}: train again") from None

    def copied(self, file: str) -> Path:
        """Return the path of the copy of an input. Raises: RunError as `copy` does."""
        expected = self.copies.get(file)
        path = self.path / file
        if expected is None or not path.is_file():
            raise RunError(
                f"expected a copy of {file} in {self.path}, found none: the run is incomplete"
            )
        if sha256(file_content(path)) != expected:
            raise RunError(
                f"expected {path} as it was when the run started, found another sha256: restore "
                "it, or train again with the changed file"
            )
        return path

    def write_tree(self, file: str, tree: Any) -> None:
        """Save a pytree's arrays, whole or not at all. See `runs.array_tree`."""
        # Imports JAX, which most readers of a run do without.
        from neuralgaits.runs.array_tree import write_tree

        write_tree(self.path / file, tree)

    def read_tree(self, file: str, like: Tree) -> Tree:
        """Read arrays into the structure of `like`. Raises: RunError if they do not fit."""
        from neuralgaits.runs.array_tree import read_tree

        return read_tree(self.path / file, like)

    def write_json(self, file: str, value: Any) -> None:
        """Save a result as JSON; `file` may name a sub-folder."""
        write_text(self.path / file, to_json(value))

    def read_json(self, file: str) -> dict[str, Any]:
        """Read a JSON object. Raises: RunError if it is missing or damaged."""
        return read_object(self.path / file)

    def write_metrics(self, rows: Sequence[Row]) -> None:
        """Replace the content of `metrics.csv` by these rows."""
        write_text(self.path / METRICS, to_csv(rows))

    def read_metrics(self) -> list[dict[str, float]]:
        """Read the rows of `metrics.csv`; none if the run has not written any."""
        path = self.path / METRICS
        if not path.is_file():
            return []
        return from_csv(file_content(path, MOST_METRICS_BYTES), str(path))


def _versions() -> dict[str, str]:
    names = ("jax", "jaxlib", "equinox", "optax", "mujoco", "numpy")
    libraries = {library: metadata.version(library) for library in names}
    return {"neuralgaits": __version__, "python": platform.python_version()} | libraries
