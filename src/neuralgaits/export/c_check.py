"""Compile a controller in C with every compiler, compare it with Python, time and weigh it."""

from functools import partial
from pathlib import Path

from neuralgaits.errors import MismatchError
from neuralgaits.export import build
from neuralgaits.export.board_source import BOARD_SOURCES
from neuralgaits.export.compare import (
    STEP_TIME,
    Questions,
    agree,
    float_bound,
    latency,
    limits,
    questions,
)
from neuralgaits.export.design import Design
from neuralgaits.export.monitor_check import STATES as MONITOR_STATES
from neuralgaits.export.monitor_check import check_monitor
from neuralgaits.export.programs import policy_rate
from neuralgaits.export.reference import Reference
from neuralgaits.records.exported import Build, ControllerExport, Memory, MonitorExport


def check_controller(
    design: Design, reference: Reference, folder: Path, compilers: list[str], states: int
) -> "partial[ControllerExport]":
    """Compile with every compiler in both precisions, compare, and measure.

    Args:
        design: source of the files.
        reference: Python's side of it.
        folder: the files, with those of the exporter.
        compilers: names of programs.
        states: random states of the region.

    Returns: a record without the place of the files; `max_abs_error`, `latency_us` and
        sizes are those of the first compiler in double precision at -O2.
    Raises: MismatchError if C does not compile, or its results differ from Python's.
    """
    inputs = questions(design, reference, states)
    compiled = [
        _built(design, inputs, folder, compiler, precision, flags)
        for compiler in compilers
        for precision in build.PRECISIONS
        for flags in (build.PLAIN, build.NATIVE)
    ]
    builds = tuple(one for one, _ in compiled)
    # Structs are as large under every compiler and every flag.
    structs = {one.precision: sizes for one, sizes in compiled}
    sizes = {
        precision: _sizes(folder, compilers[0], defines, structs[precision])
        for precision, defines in build.PRECISIONS.items()
    }
    if design.deployment is not None:
        for compiler in compilers:
            for defines in build.PRECISIONS.values():
                _sizes_of(folder, compiler, defines, (*build.CORE, *BOARD_SOURCES))
    monitor = None
    if design.monitor is not None:
        # No more states than were asked for.
        checked = min(states, MONITOR_STATES)
        answers = check_monitor(design, folder, compilers, checked)
        monitor = MonitorExport(design.monitor.levels, checked, answers)
    first = builds[0]
    steps = [first.latency_us[name] for name in design.controllers]
    return partial(
        ControllerExport,
        max_abs_error=first.agreement.absolute,
        latency_us=max(steps, key=lambda step: step.p99),
        flash_bytes=sizes["double"].flash_bytes,
        ram_bytes=sizes["double"].ram_bytes,
        states=inputs.cases.count,
        limits={precision: limits(design, precision) for precision in build.PRECISIONS},
        float_bound=float_bound(design, policy_rate(design.gait.policy), inputs),
        sizes=sizes,
        builds=builds,
        step_latency_us=first.latency_us.get(STEP_TIME),
        monitor=monitor,
    )


def _built(
    design: Design,
    questions: Questions,
    folder: Path,
    compiler: str,
    precision: str,
    flags: tuple[str, ...],
) -> tuple[Build, dict[str, int]]:
    """Compile, compare and time one build. Returns: it, and the size of each struct (bytes)."""
    defines = build.PRECISIONS[precision]
    program = build.build(compiler, folder, "check", build.CHECKED, (*flags, *defines))
    made = Build(
        compiler,
        precision,
        " ".join(flags),
        agree(design, questions, program, precision),
        latency(questions, program),
    )
    rows = build.run(program, "sizes").decode().split()
    return made, dict(zip(rows[::2], map(int, rows[1::2]), strict=True))


def _sizes(
    folder: Path, compiler: str, defines: tuple[str, ...], structs: dict[str, int]
) -> Memory:
    """Return the memory of one precision. Raises: MismatchError for heap calls or static memory."""
    core = _sizes_of(folder, compiler, defines, build.CORE)
    ram = sum(structs.values())
    stack = core.stack_bytes
    return Memory(core.flash_bytes, None if stack is None else ram + stack, stack, structs)


def _sizes_of(
    folder: Path, compiler: str, defines: tuple[str, ...], sources: tuple[str, ...]
) -> build.Inspection:
    """Inspect sources. Raises: MismatchError for heap calls or static memory."""
    core = build.inspect(compiler, folder, (*build.PLAIN, *defines), sources)
    if core.foreign or core.static_bytes:
        raise MismatchError(
            "expected a controller that calls no library and keeps no memory, found "
            f"{', '.join(core.foreign) or 'no calls'} and {core.static_bytes} bytes: report it"
        )
    return core
