"""What the checkers answer, in one word and all that they print."""

import hashlib
import json
import subprocess
import sys
import unicodedata
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from neuralgaits.analysis.run import Run, open_run
from neuralgaits.certificate.proof_file.reader import read_claims
from neuralgaits.certificate.run_certificate.proved_law import law_proofs
from neuralgaits.certificate.run_certificate.verified_summary import (
    CertificateReading,
    read_certificate,
)
from neuralgaits.errors import NeuralGaitsError, RunError
from neuralgaits.export.design import Design
from neuralgaits.records.certified import PROOF
from neuralgaits.report.certificate import ProvedOfGait, certificate_of
from neuralgaits.report.shown_walk import kept_walk, request_of
from neuralgaits.runs import RunFolder
from neuralgaits.workflows.check_proof import check_proof
from neuralgaits.workflows.export import design_of, with_monitor
from neuralgaits.workflows.report import saved_of
from support.forgeries.base import Forged, Forgery

CODES = {0: "proved", 1: "rejected", 2: "unreadable", 3: "undecided"}
TIMEOUT_S = 1200


@dataclass(frozen=True)
class Heard:
    """A checker's answer.

    Attributes:
        word: as in `base.EXIT`; of a report, the level it shows.
        text: everything it printed.
    """

    word: str
    text: str

    @property
    def controls(self) -> str:
        """Characters in the output that a screen obeys and a reader does not see."""
        found = {c for c in self.text if unicodedata.category(c) in ("Cc", "Cf", "Zl", "Zp", "Cs")}
        return "".join(sorted(found - {"\n"}))


def ask_cpp(program: Path, file: Path) -> Heard:
    """The C++ checker."""
    found = subprocess.run([program, file], capture_output=True, timeout=TIMEOUT_S)
    text = (found.stdout + found.stderr).decode(errors="surrogateescape")
    return Heard(CODES.get(found.returncode, "crashed"), text)


def ask_python(file: Path, run: Path | None = None) -> Heard:
    """The Python checker in this process; it must not run a hostile spec."""
    try:
        answer = check_proof(file, run=run)
    except NeuralGaitsError as error:
        return Heard("unreadable", str(error))
    except Exception as error:
        return Heard("crashed", f"{type(error).__name__}: {error}")
    return Heard(answer["verdict"], "\n".join(_texts(answer)))


def ask_process(file: Path, run: Path) -> Heard:
    """The Python checker in a process of its own, by its exit code and what `--json` says.

    Exit code 0 alone is taken for `proved`: whoever asks in a script looks at nothing else.
    """
    command = [sys.executable, "-m", "neuralgaits", "check-proof", str(file), "--run", str(run)]
    found = subprocess.run([*command, "--json"], capture_output=True, timeout=TIMEOUT_S)
    text = (found.stdout + found.stderr).decode(errors="surrogateescape")
    if found.returncode not in CODES:
        return Heard("crashed", text)
    return Heard(CODES[found.returncode], text)


def ask_report(run: Path) -> Heard:
    """The highest level that figures or page show as proved, or `none`; or what is boasted."""
    page = saved_of(RunFolder.open(run))
    try:
        certificate = certificate_of(open_run(run))
    except RunError:  # No figure and no export then.
        certificate = ProvedOfGait()
    level = max(certificate.level, page.proved_level, 4 if certificate.full is not None else 0)
    margins = max(certificate.margins.values(), default=0.0)
    multiplier = certificate.orbit.multiplier if certificate.orbit is not None else None
    boast = f"; margins up to {margins}; multiplier in {multiplier}"
    if page.measured and page.summary is not None:
        of = "" if page.summary.tied else " of unnamed weights"
        boast += f"; figures of training{of}"
    word = str(level) if level else "none"
    refuted = [] if page.certificate is None else page.certificate.named("refuted")
    boast += f"; {', '.join(refuted)} refuted" if refuted else ""
    boast += _walk_kept(run)
    if margins > 90.0 or (multiplier is not None and multiplier[1] < 0.01):
        word = "boast"
    return Heard(word, f"level {level}{boast}")


def ask_header(run: Path) -> Heard:
    """What the comment of `gait.h` says of its laws; `proved` if that of one is.

    The laws have the bandwidth that the proof file states, as who exports it would ask for.
    """
    opened, certificate = open_run(run), read_certificate(RunFolder.open(run))
    try:
        full = read_claims(run / PROOF).theorems.full
    except NeuralGaitsError:
        full = None
    design = _design(opened, None if full is None else full.bandwidth)
    monitor = with_monitor(design, opened, certificate)[0].monitor
    proofs = law_proofs(opened, certificate, design.controllers)
    words = [one.words for one in proofs]
    if monitor is not None:
        hold = "none" if monitor.hold_s is None else f"{1e3 * monitor.hold_s:.7g} ms"
        words.append(f"monitor of levels {monitor.levels}, hold {hold}")
    proved = any(one.proved for one in proofs)
    return Heard("proved" if proved else "none", "\n".join(words))


def _design(run: Run, bandwidth: float | None) -> Design:
    """The exported controller of a run, made once for each gait and bandwidth: seconds."""
    weights = (run.path / "policy.safetensors").read_bytes()
    key = hashlib.sha256(weights).hexdigest(), bandwidth
    if key not in _DESIGNS:
        _DESIGNS[key] = design_of(run, CertificateReading(), bandwidth=bandwidth)
    return _DESIGNS[key]


_DESIGNS: dict[tuple[str, float | None], Design] = {}


def _walk_kept(path: Path) -> str:
    """What the page would show of a walk without walking it; empty if it would walk."""
    try:
        run = open_run(path)
        kept = kept_walk(run, request_of(run))
    except RunError:
        return ""
    return "" if kept is None else f"; keeps a walk that {kept.origin}"


def answers(
    forgery: Forgery, forged: Forged, folder: Path | str, program: Path, checkers: tuple[str, ...]
) -> dict[str, Heard]:
    """Of every checker that a forgery is for, among those asked."""
    file = Path(folder) / "proof.json"
    if forgery.process:
        file = forged.run / "forged.json"
    file.write_bytes(forged.content)
    heard = {}
    for checker in forgery.answers:
        if checker not in checkers:
            continue
        if checker == "cpp":
            heard[checker] = ask_cpp(program, file)
        elif checker == "report":
            heard[checker] = ask_report(forged.run)
        elif checker == "header":
            heard[checker] = ask_header(forged.run)
        elif checker == "run" and forgery.process:
            heard[checker] = ask_process(file, forged.run)
        else:
            heard[checker] = ask_python(file, forged.run if checker == "run" else None)
    return heard


def complaints(forgery: Forgery, heard: dict[str, Heard]) -> list[str]:
    """What is wrong with answers, one sentence each."""
    found = []
    for checker, answer in heard.items():
        wrong = forgery.answers[checker].wrong(checker, answer.word, answer.text)
        if wrong:
            last = answer.text.strip().splitlines()[-1:] or [""]
            found.append(f"{checker} {wrong}: {last[0][:200]!r}")
        if answer.controls:
            found.append(f"{checker} wrote {answer.controls!r}")
    return found


def _texts(value: Any) -> list[str]:
    """Every text of an answer."""
    if isinstance(value, str):
        return [value]
    if isinstance(value, Mapping):
        return [text for item in value.values() for text in _texts(item)]
    if isinstance(value, list | tuple):
        return [text for item in value for text in _texts(item)]
    return [json.dumps(value)]
