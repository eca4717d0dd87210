"""What a run folder holds, read as plain data; a part that is not there is None."""

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from neuralgaits.errors import RunError
from neuralgaits.report.figure import Drawn, Missing
from neuralgaits.runs import RunFolder

Json = Mapping[str, Any]
_HASHED = (
    "policy.safetensors",
    "robot.xml",
    "spec.py",
    "residual.safetensors",
    "start.safetensors",
    "certificate/proof.json",
    "certificate/full-order.json",
)
PROOF, FULL_ORDER = "certificate/proof.json", "certificate/full-order.json"
LEVELS = (1, 2, 3, 4)


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


def proved_level(certificate: Json | None) -> int:
    """As `Saved.proved_level`."""
    if certificate is None:
        return 0
    conditions = certificate.get("conditions") or {}
    if not conditions or any(c["verdict"] != "proved" for c in conditions.values()):
        return 0
    proved = {entry["level"] for entry in certificate["levels"] if entry["verdict"] == "proved"}
    return max((n for n in LEVELS if set(range(2, n + 1)) <= proved), default=1)


def read(folder: RunFolder) -> Saved:
    """Read a run. A damaged part is left out and named; only a damaged config is an error."""
    damaged: dict[str, str] = {}

    def part(file: str, base: Path = folder.path) -> Json | None:
        if not (base / file).is_file():
            return None
        try:
            return RunFolder(base, {}).read_json(file)
        except RunError as error:
            damaged[file] = str(error)
            return None

    try:
        metrics = folder.read_metrics()
    except RunError as error:
        metrics, damaged["metrics.csv"] = [], str(error)
    above = folder.path.resolve().parent
    rounds = part("summary.json", above) if (above / "episodes.json").is_file() else None
    certificate = part("certificate/summary.json")
    hashes = {
        file: hashlib.sha256((folder.path / file).read_bytes()).hexdigest()
        for file in _HASHED
        if (folder.path / file).is_file()
    }
    if certificate is not None and (why := _not_of_run(folder, hashes, part)):
        certificate, damaged["certificate/summary.json"] = None, why
    return Saved(
        folder=folder,
        config=folder.config,
        summary=part("summary.json"),
        metrics=metrics,
        certificate=certificate,
        disturbance=() if certificate is None else _disturbance(part(PROOF)),
        simulation=part("simulation/summary.json"),
        residual=part("residual/summary.json"),
        walks=part("walks/summary.json"),
        episodes=rounds,
        hashes=hashes,
        damaged=damaged,
    )


def _disturbance(proof: Json | None) -> tuple[float, ...]:
    """Bounds in the parameters of level 2; none if there is no such level, or if they are 0."""
    for theorem in (proof or {}).get("theorems") or ():
        bounds = (theorem.get("parameters") or {}).get("disturbance") or ()
        if theorem.get("level") == 2 and len(bounds) == 2:
            values = tuple(float.fromhex(str(bound)) for bound in bounds)
            return values if any(values) else ()
    return ()


def _not_of_run(folder: RunFolder, hashes: Mapping[str, str], part) -> str | None:
    """Why a certificate is not about the files that lie in the run now; None if it is."""
    for file in (PROOF, FULL_ORDER):
        proof = part(file)
        if proof is None:
            continue
        expected = {
            "policy.safetensors": proof.get("weights_sha256"),
            "robot.xml": (proof.get("robot") or {}).get("sha256"),
            "spec.py": (proof.get("spec") or {}).get("sha256"),
        }
        for name, digest in expected.items():
            if hashes.get(name) != digest:
                return (
                    f"expected a proof about the run's own {name}, found another sha256 in {file}: "
                    f"prove it again with `neuralgaits certify {folder.path}`"
                )
    return None
