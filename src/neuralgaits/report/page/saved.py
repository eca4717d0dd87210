"""What a run folder holds, read as plain data; a part that is not there is None."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from neuralgaits.errors import RunError
from neuralgaits.report.certificate import (
    FULL_ORDER,
    PROOF,
    SUMMARY,
    proved_level,
    sha256,
    why_not_of_run,
)
from neuralgaits.report.figure import Drawn, Missing
from neuralgaits.report.shapes import CERTIFIED, LEARNED, ROUNDS, SIMULATED, TRAINED, WALKED
from neuralgaits.runs import RunFolder
from neuralgaits.runs.folder import refuse_misshapen
from neuralgaits.runs.shape import COUNT, TEXT, Shape, list_of

Json = Mapping[str, Any]
LEARNING = "residual/summary.json"
_PROOF: Shape = {
    "theorems": list_of({"level": COUNT, "parameters": {"disturbance?": list_of(TEXT)}})
}
"""Of a proof file: what is told of it here."""
_HASHED = (
    "policy.safetensors",
    "robot.xml",
    "spec.py",
    "residual.safetensors",
    "start.safetensors",
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
        certificate, simulation: what `certify` and `simulate` found.
        disturbance: what may be added to dz at level 2 of the proof (m/s, N m).
        residual: what `fit` learned from the logs of this run.
        walks: of this run as a round of episodes.
        episodes: all rounds of them.
        hashes: sha256 of the files that count, by name.
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
    damaged: dict[str, str]

    @property
    def name(self) -> str:
        """The run as commands name it."""
        return str(self.folder.path)

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
        walk: of `workflows.shown_walk`; None if there is none.
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


def read(folder: RunFolder) -> Saved:
    """Read a run. A damaged part is left out and named.

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
    certificate = part(SUMMARY, CERTIFIED)
    residual = folder.path / "residual" / "residual.safetensors"
    found = {file: sha256(folder.path / file) for file in _HASHED}
    hashes = {file: digest for file, digest in found.items() if digest is not None}
    if certificate is not None and (why := why_not_of_run(certificate, folder.path)):
        again = f"prove it again with `neuralgaits certify {folder.path}`"
        certificate, damaged[SUMMARY] = None, f"{why}: {again}"
    learned = part(LEARNING, LEARNED)
    if learned is not None and learned.get("residual_sha256") not in (None, sha256(residual)):
        learned, damaged[LEARNING] = (
            None,
            (
                f"{LEARNING} is about another {residual.name} than the run's: learn it again with "
                f"`neuralgaits fit {folder.path} LOG.csv`"
            ),
        )
    return Saved(
        folder=folder,
        config=folder.config,
        summary=trained(folder) if folder.finished else None,
        metrics=metrics,
        certificate=certificate,
        disturbance=() if certificate is None else _disturbance(part(PROOF, _PROOF)),
        simulation=part("simulation/summary.json", SIMULATED),
        residual=learned,
        walks=part("walks/summary.json", WALKED),
        episodes=rounds,
        hashes=hashes,
        damaged=damaged,
    )


def trained(folder: RunFolder) -> dict[str, Any]:
    """The summary of a finished training.

    Raises: RunError if it is damaged; the last checkpoint can be finished again.
    """
    try:
        found = folder.summary
        refuse_misshapen(found, TRAINED, folder.path / "summary.json")
    except RunError as error:
        again = f"neuralgaits train {folder.config.get('robot', 'ROBOT')} --resume {folder.path}"
        raise RunError(f"{error}; deleted, it is written again by `{again}`") from None
    return found


def _disturbance(proof: Json | None) -> tuple[float, ...]:
    """Bounds in the parameters of level 2; none if there is no such level, or if they are 0."""
    for theorem in (proof or {}).get("theorems") or ():
        bounds = theorem["parameters"].get("disturbance") or ()
        if theorem["level"] == 2 and len(bounds) == 2:
            try:
                values = tuple(float.fromhex(bound) for bound in bounds)
            except (ValueError, OverflowError):
                raise RunError(
                    f"expected bounds as hexadecimal numbers in {PROOF}, found {bounds}: the file "
                    "is damaged; certify the run again"
                ) from None
            return values if any(values) else ()
    return ()
