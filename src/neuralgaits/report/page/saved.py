"""What a run folder holds, read as plain data; a part that is not there is None."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from neuralgaits.errors import RunError
from neuralgaits.report.certificate import (
    FULL_ORDER,
    PROOF,
    SUMMARY,
    proved_level,
)
from neuralgaits.report.drawn import Drawn, Missing
from neuralgaits.report.shapes import LEARNED, ROUNDS, SIMULATED, WALKED
from neuralgaits.runs import RunFolder
from neuralgaits.runs.commands import command, learning, named
from neuralgaits.runs.folder import NAN, file_hashes, refuse_misshapen
from neuralgaits.runs.names import RESIDUAL, ROBOT, SPEC, START, WEIGHTS
from neuralgaits.runs.shape import COUNT, TEXT, Shape, list_of
from neuralgaits.runs.trained import trained

Json = Mapping[str, Any]
LEARNING, WALK = "residual/summary.json", "simulation/summary.json"
_NAN: Shape = {"step": COUNT, "conditions": list_of(TEXT)}
"""Of `nan.json`: where a training ended."""
_HASHED = (
    WEIGHTS,
    ROBOT,
    SPEC,
    RESIDUAL,
    START,
    PROOF,
    FULL_ORDER,
)


@dataclass(frozen=True)
class Saved:
    """A run as its files say.

    Attributes:
        folder: of the run.
        config: what was asked.
        summary: what `train` or `refine` found; None if training has not ended.
        metrics: rows of the training's course.
        certificate: what `certify` found, as the run's proof files bear it out.
        simulation: what `simulate` found.
        disturbance: what may be added to dz at level 2 of the proof (m/s, N m).
        residual: what `fit` learned from the logs of this run.
        walks: of this run as a round of episodes.
        episodes: all rounds of them.
        hashes: sha256 of the files that count, by name.
        nan: that the training ended in NaN, and where, in a sentence; None if it did not.
        damaged: why a part could not be read, by file.
    """

    folder: RunFolder
    config: Json
    summary: Json | None
    metrics: list[dict[str, float]]
    certificate: Json | None
    disturbance: tuple[float, ...]
    simulation: Json | None
    residual: Json | None
    walks: Json | None
    episodes: Json | None
    hashes: dict[str, str]
    nan: str | None
    damaged: dict[str, str]

    @property
    def name(self) -> str:
        """The run as commands name it."""
        return named(self.folder.path)

    @property
    def robot(self) -> str:
        """Name of the robot."""
        return str(self.config.get("robot", "the robot"))

    @property
    def proved_level(self) -> int:
        """The highest level that is proved with all below it; 0 if not even the first."""
        return proved_level(self.certificate)


@dataclass(frozen=True)
class Contents:
    """All that a page is made from.

    Attributes:
        saved: files of the run.
        robot: as `inspect` describes it.
        walk: of `report.shown_walk`; None if there is none.
        no_walk: why there is none, in a sentence.
        figures: drawn and missing.
        assumptions: of a proof, as `check-proof` lists them.
    """

    saved: Saved
    robot: Json
    walk: Json | None
    no_walk: str | None
    figures: list[Drawn | Missing]
    assumptions: tuple[str, ...]


def read(
    folder: RunFolder,
    certificate: Json | None,
    no_certificate: str | None = None,
    disturbance: tuple[float, ...] = (),
) -> Saved:
    """Read a run. A damaged part is left out and named.

    Args:
        folder: of the run.
        certificate: what `certify` found, as the run's proof files bear it out.
        no_certificate: why a certificate that is there says nothing of the run.
        disturbance: of level 2.

    Raises: RunError if what was asked or found in training is damaged: pages are about these.
    """
    damaged: dict[str, str] = {}

    def part(file: str, shape: Shape, base: Path = folder.path) -> Json | None:
        if not (base / file).is_file():
            return None
        try:
            found = RunFolder(base, {}).read_json(file)
            refuse_misshapen(found, shape, base / file)
            return found
        except RunError as error:
            damaged[file] = str(error)
            return None

    try:
        metrics = folder.read_metrics()
    except RunError as error:
        metrics, damaged["metrics.csv"] = [], str(error)
    above = folder.path.resolve().parent
    rounds = part("summary.json", ROUNDS, above) if (above / "episodes.json").is_file() else None
    found = file_hashes(folder.path, _HASHED)
    hashes = {file: digest for file, digest in found.items() if digest is not None}
    if no_certificate is not None:
        again = f"prove it again with `{command('certify', named(folder.path))}`"
        damaged[SUMMARY] = f"{no_certificate}: {again}"
    learned, walked = part(LEARNING, LEARNED), part(WALK, SIMULATED)
    if learned is not None and learned.get("residual_sha256") not in (None, *_learned(folder)):
        learned = None
        damaged[LEARNING] = (
            f"{LEARNING} is about another residual.safetensors than the run's: learn it again with "
            f"`{learning(folder)}`"
        )
    for file, digest in ((walked or {}).get("sha256") or {}).items():
        if digest != hashes.get(file):
            again = command("simulate", named(folder.path))
            walked = None
            damaged[WALK] = f"{WALK} is about another {file} than the run's: walk with `{again}`"
            break
    return Saved(
        folder=folder,
        config=folder.config,
        summary=trained(folder) if folder.finished else None,
        metrics=metrics,
        certificate=certificate,
        disturbance=disturbance,
        simulation=walked,
        residual=learned,
        walks=part("walks/summary.json", WALKED),
        episodes=rounds,
        hashes=hashes,
        nan=_nan(part(NAN, _NAN)) if folder.ended_in_nan else None,
        damaged=damaged,
    )


def _learned(folder: RunFolder) -> Iterable[str | None]:
    """The sha256 of what `fit` learned."""
    return file_hashes(folder.path, ("residual/residual.safetensors",)).values()


def _nan(found: Json | None) -> str:
    """Where a training ended in NaN, as far as it is known."""
    if found is None:
        return "The training ended in NaN: its loss or its weights were no longer finite."
    names = ", ".join(found["conditions"]) or "no condition alone: the sum, or its gradient"
    return (
        f"The training ended in NaN at step {found['step']}: its loss or its weights were no "
        f"longer finite (conditions: {names})."
    )
