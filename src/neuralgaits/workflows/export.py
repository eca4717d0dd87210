"""Write a trained gait as a controller in C, compile it, and compare it with Python."""

import hashlib
import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from neuralgaits._version import __version__
from neuralgaits.errors import InputError, MismatchError
from neuralgaits.export import build, writing
from neuralgaits.export.compare import (
    STATES,
    Build,
    agree,
    float_bound,
    latency,
    limits,
    questions,
)
from neuralgaits.export.facts import Design, Origin
from neuralgaits.export.programs import parts
from neuralgaits.export.reference import Reference
from neuralgaits.export.selftest import selftest_file
from neuralgaits.export.source import gait_files
from neuralgaits.runs import plain
from neuralgaits.simulation.starts import momentum_range
from neuralgaits.simulation.walk import LAWS
from neuralgaits.workflows.run import ROBOT, WEIGHTS, Run, open_run

PROOF, CERTIFICATE = "certificate/proof.json", "certificate/summary.json"
FORMATS = ("c",)
NO_COMPILER = "no C compiler: the files are written and not checked; install gcc or clang"


@dataclass(frozen=True)
class Export:
    """What was written, and whether it was checked.

    Attributes:
        summary: what `export --json` prints.
        checked: False if there was no compiler to check it with.
    """

    summary: dict[str, Any]
    checked: bool


def export(
    run: Run | str | Path,
    out: str | Path,
    *,
    format: str = "c",
    force: bool = False,
    states: int = STATES,
) -> Export:
    """Write a run's gait for a robot.

    Args:
        run: a run, its folder, or `latest`.
        out: folder to write to; new or empty unless `force`.
        format: `c`.
        force: replace the files of an earlier export.
        states: random states on which C and Python are compared.

    Returns: `Export`.
    Raises: InputError, SpecError or RunError with one line for bad input; MismatchError if what
        was written does not compile or is not what Python computes: then nothing is written.
    """
    if format not in FORMATS:
        raise InputError(f"unknown format {format!r}: expected one of {', '.join(FORMATS)}")
    trained, folder = open_run(run), Path(out)
    writing.refuse_used(folder, force=force)
    design = design_of(trained)
    reference = Reference(design)
    files = writing.shipped() | controller_files(design, reference)
    compilers = build.compilers()
    found: dict[str, Any] = {"checked": bool(compilers)}
    if compilers:
        with writing.scratch(files | writing.harness()) as place:
            found |= _check(design, reference, place, compilers, states)
    else:
        found |= {"reason": NO_COMPILER, "max_abs_error": None, "latency_us": None}
        found |= {"flash_bytes": None, "ram_bytes": None}
    written = writing.publish(folder, files)
    about = {"run": str(trained.path), "format": format, "out": str(folder), "files": written}
    about |= {"laws": list(design.controllers)}
    return Export(plain(about | found), bool(compilers))


def design_of(trained: Run) -> Design:
    """Everything the exported controller of a run is made of."""
    return Design.of(
        trained.robot, trained.gait, LAWS, momentum_range(trained.gait), _origin(trained)
    )


def controller_files(design: Design, reference: Reference) -> dict[str, str]:
    """The files that are this gait's own."""
    return gait_files(design) | {"gait_selftest.h": selftest_file(design, reference)}


def _origin(trained: Run) -> Origin:
    weights = _sha256(trained.path / WEIGHTS)
    proof, verdict = trained.path / PROOF, None
    if proof.is_file() and json.loads(proof.read_bytes()).get("weights_sha256") == weights:
        about = trained.folder.read_json(CERTIFICATE)
        verdict = f"{about['verdict']} at level {about['level']}"
    return Origin(
        robot_sha256=_sha256(trained.path / ROBOT),
        policy_sha256=weights,
        proof_sha256=None if verdict is None else _sha256(proof),
        proof_verdict=verdict,
        spec=str(trained.folder.config["spec"]),
        version=__version__,
    )


def _sha256(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()


def _check(
    design: Design, reference: Reference, place: Path, compilers: list[str], states: int
) -> dict[str, Any]:
    """Compile with every compiler in both precisions, compare, and measure."""
    asked = questions(design, reference, states)
    builds: list[Build] = []
    for compiler in compilers:
        for precision, defines in build.PRECISIONS.items():
            flags = (*build.PLAIN, *defines)
            program = build.build(compiler, place, "check", build.CHECKED, flags)
            one = Build(compiler, precision, " ".join(build.PLAIN))
            one.agreement = agree(design, asked, program, precision)
            one.latency_us = latency(asked, program)
            builds.append(one)
            program = build.build(
                compiler, place, "check", build.CHECKED, (*build.NATIVE, *defines)
            )
            fast = Build(compiler, precision, " ".join(build.NATIVE))
            fast.agreement = agree(design, asked, program, precision)
            fast.latency_us = latency(asked, program)
            builds.append(fast)
    sizes = {
        precision: _sizes(place, compilers[0], defines)
        for precision, defines in build.PRECISIONS.items()
    }
    first = builds[0]
    assert first.agreement is not None
    steps = [first.latency_us[name] for name in design.controllers]
    rates = next(
        part
        for part in parts(design.robot, design.gait.policy)
        if part.function == "ng_policy_rate"
    )
    return {
        "max_abs_error": first.agreement.absolute,
        "latency_us": max(steps, key=lambda step: step["p99"]),
        "flash_bytes": sizes["double"]["flash_bytes"],
        "ram_bytes": sizes["double"]["ram_bytes"],
        "states": asked.cases.count,
        "limits": {precision: vars(limits(design, precision)) for precision in build.PRECISIONS},
        "float_bound": float_bound(design, rates, asked),
        "sizes": sizes,
        "builds": builds,
    }


def _sizes(place: Path, compiler: str, defines: tuple[str, ...]) -> dict[str, Any]:
    """Memory of one precision. Raises: MismatchError for a heap call or memory that is kept."""
    core = build.inspect(compiler, place, (*build.PLAIN, *defines))
    if core.foreign or core.static_bytes:
        raise MismatchError(
            "expected a controller that calls no library and keeps no memory, found "
            f"{', '.join(core.foreign) or 'no calls'} and {core.static_bytes} bytes: report it"
        )
    program = build.build(compiler, place, "check", build.CHECKED, (*build.PLAIN, *defines))
    rows = build.run(program, "sizes").decode().split()
    structs = dict(zip(rows[::2], map(int, rows[1::2]), strict=True))
    kept = sum(structs.values())
    stack = core.stack_bytes
    return {
        "flash_bytes": core.flash_bytes,
        "ram_bytes": None if stack is None else kept + stack,
        "stack_bytes": stack,
        "structs": structs,
    }
