"""The exported controller: agreement, times, memory, hostile inputs, walks through UDP; ONNX.

Asked: double 1e-12 and single 2e-6 (64 wide) or 1e-5 (256 wide) of the output's range, torques
5e-5 of the limit; y_d and rate p99 2 us (64 wide) and 15 us (256 wide) with -O3 -march=native,
5 us (64 wide) with -O2; a whole step p99 10 us; 4 kB of RAM and stack; 1000 steps walked through
the process boundary, 1 % of the packets lost and 2 ms of jitter survived; 10^6 hostile inputs
under sanitizers. Environment: STEPS walking steps of the long walks, REAL_TIME=0 leaves out the
walk that takes ten minutes of the clock.
"""

import os
from pathlib import Path
from tempfile import TemporaryDirectory

from common import show, trained

from neuralgaits.analysis.run import Run
from neuralgaits.export import build, output_folder
from neuralgaits.export.reference import Reference
from neuralgaits.workflows.export import design_of, export_controller
from neuralgaits.workflows.export_formats import controller_files
from neuralgaits.workflows.simulate import simulate

STEPS = int(os.environ.get("STEPS", "1000"))
FUZZED = 1_000_000
SANITIZERS = {
    "gcc": ("-fsanitize=address,undefined", "-fno-sanitize-recover=all"),
    # Its address sanitizer needs a library that many distributions leave out.
    "clang": ("-fsanitize=undefined", "-fsanitize-trap=undefined"),
}
HARSH = {"loss": 0.01, "jitter_ms": 2.0}
WIDTHS = {
    32: ("<= 2e-06", "", ""),
    64: ("<= 2e-06", "<= 2", "<= 5"),
    256: ("<= 1e-05", "<= 15", ""),
}
"""By width of the two hidden layers, what is asked: agreement in single precision, y_d and rate at
-O3 -march=native and at -O2 [us]."""


def main() -> None:
    """Print every row."""
    for width, asked in WIDTHS.items():
        _exported(trained("amber3m", 0, hidden=(width, width)), width, asked)
    run = trained("amber3m", 0)
    _fuzzed(run)
    _walked(run)


def _exported(run: Run, width: int, asked: tuple[str, str, str]) -> None:
    with TemporaryDirectory() as folder:
        summary = export_controller(run, Path(folder) / "c").summary
        models = export_controller(run, Path(folder) / "onnx", format="onnx").summary
    single, native, plain = asked
    for row in summary["builds"]:
        name = f"{width} wide, {row['compiler']} {row['flags']}, {row['precision']}"
        agreement, times = row["agreement"], row["latency_us"]
        limit = "<= 1e-12" if row["precision"] == "double" else single
        show(f"{name}: y_d, of its range", agreement["output"], limit)
        show(f"{name}: rate, of its range", agreement["rate"], limit)
        show(f"{name}: torques, of the limit", agreement["torque"], "<= 5e-05")
        target = native if "O3" in row["flags"] else plain
        show(f"{name}: y_d and rate, p50 us", times["policy"]["p50"])
        show(f"{name}: y_d and rate, p99 us", times["policy"]["p99"], target)
        for law in summary["laws"]:
            show(f"{name}: whole step {law}, p99 us", times[law]["p99"], "<= 10")
    for precision, sizes in summary["sizes"].items():
        show(f"{width} wide, {precision}: stack, bytes", sizes["stack_bytes"], "<= 4096")
        show(f"{width} wide, {precision}: RAM with stack, bytes", sizes["ram_bytes"], "<= 4096")
        show(f"{width} wide, {precision}: code and weights, bytes", sizes["flash_bytes"])
    show(f"{width} wide: bound on float, y_d of its range", summary["float_bound"]["output"])
    for row in models["builds"]:
        name = f"{width} wide, {row['runtime']} from Python, {row['precision']}"
        agreement, times = row["agreement"], row["latency_us"]
        limit = "<= 1e-12" if row["precision"] == "double" else single
        show(f"{name}: y_d, of its range", agreement["output"], limit)
        show(f"{name}: rate, of its range", agreement["rate"], limit)
        show(f"{name}: y_d and rate, p50 us", times["p50"])
        show(f"{name}: y_d and rate, p99 us", times["p99"])


def _fuzzed(run: Run) -> None:
    """Sanitizers on, any bits in."""
    design = design_of(run)
    files = (
        output_folder.shipped()
        | output_folder.harness()
        | controller_files(design, Reference(design))
    )
    with output_folder.scratch(files) as folder:
        for compiler in build.compilers():
            for precision, defines in build.PRECISIONS.items():
                flags = ("-O1", "-g1", *SANITIZERS[compiler], *defines)
                program = build.build(compiler, folder, "check", build.CHECKED, flags)
                said = build.run(program, "fuzz", str(FUZZED), "1").decode().strip()
                show(f"hostile inputs, {compiler}, {precision}", said, "broken 0")


def _walked(run: Run) -> None:
    """Through the process boundary."""
    for law in ("pd", "fblin"):
        for extra in ({}, HARSH):
            link = {"law": law, "lockstep": 1, **extra}
            _walk(run, f"lock-step {law} {extra or ''}", link)
    if os.environ.get("REAL_TIME", "1") != "0":
        _walk(run, "real time pd", {"law": "pd"})


def _walk(run: Run, name: str, link: dict) -> None:
    summary = simulate(run, controller="c", steps=STEPS, link=link).summary
    wire = summary["link"]
    show(f"{name}: steps walked", summary["steps_walked"][0], f">= {STEPS}")
    show(f"{name}: packets lost, late", f"{wire['packets_lost']}, {wire['packets_late']}")
    show(f"{name}: deadlines missed of {wire['ticks']} ticks", wire["deadline_misses"])
    show(f"{name}: plant late, ticks", wire["overruns"])
    show(f"{name}: round trip p99 us", wire["round_trip_us"]["p99"])


if __name__ == "__main__":
    main()
