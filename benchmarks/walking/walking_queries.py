"""Four conditions of the shipped gaits as a benchmark for other provers, and our own answers.

    python benchmarks/walking/walking_queries.py OUT

writes models, queries and `instances.csv` into OUT, by `export --format vnnlib`, and then
`results.csv` with the columns of ARCH-COMP's category AINNCS: benchmark, instance, result, time.
Nothing that it writes is kept in the repository.
"""

import csv
import shutil
import sys
import tempfile
import time
from collections.abc import Mapping, Sequence
from pathlib import Path

import jax

from neuralgaits._environment import prepare
from neuralgaits.analysis.run import Run, open_run
from neuralgaits.certificate.chart import Chart
from neuralgaits.certificate.levels.problems import condition_problems
from neuralgaits.certificate.search.problem import Problem
from neuralgaits.certificate.search.root_turns import explore
from neuralgaits.certificate.traced import trace_spec
from neuralgaits.workflows import demo
from neuralgaits.workflows.export import export_controller

BENCHMARK = "walking"
INSTANCES, RESULTS = "instances.csv", "results.csv"
QUERIES = {
    "one-gait": (demo.FOLDER, ("foot-clears", "torque-lower", "friction-forward")),
    "speeds": (demo.TOLD, ("friction-forward",)),
}
"""Of each run: its folder, and the conditions that are put to provers."""


def make(out: Path, queries: Mapping[str, tuple[Path, Sequence[str]]], states: int = 2000) -> None:
    """Write models and queries of some conditions of some runs, and the list of instances.

    Args:
        out: new folder.
        queries: folder and conditions of each run; files are named after both.
        states: points on which models are compared with Python first, of all conditions of a run.
    """
    out.mkdir(parents=True)
    rows = []
    for label, (folder, names) in queries.items():
        with tempfile.TemporaryDirectory() as scratch:
            whole = Path(scratch) / "all"
            export_controller(open_run(folder), whole, format="vnnlib", states=states)
            wanted = {f"{name}.onnx" for name in names}
            with (whole / INSTANCES).open() as file:
                for model, query, limit_s in csv.reader(file):
                    if model in wanted:
                        for name in (model, query):
                            shutil.copy(whole / name, out / f"{label}-{name}")
                        rows.append((f"{label}-{model}", f"{label}-{query}", limit_s))
    with (out / INSTANCES).open("w", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows(rows)


def solve(out: Path, queries: Mapping[str, tuple[Path, Sequence[str]]]) -> None:
    """Bound every instance's boxes, and write the results beside its files."""
    with (out / RESULTS).open("w", newline="") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(("benchmark", "instance", "result", "time"))
        for label, (folder, names) in queries.items():
            run = open_run(folder)
            for name in names:
                for number, problem in enumerate(problems(run, name)):
                    result, spent = answer(problem)
                    table.writerow((BENCHMARK, f"{label}-{name}-{number}", result, f"{spent:.3f}"))
                    file.flush()


def problems(run: Run, name: str) -> list[Problem]:
    """Return what `certify` searches for one condition, a problem for each box of its region."""
    spec = run.spec.without(*(c.name for c in run.spec.conditions if c.name != name))
    program = trace_spec(spec, run.robot, run.trained, run.residuals)
    return condition_problems(spec, program, Chart.of(spec.commands, spec.parameters))


def answer(problem: Problem) -> tuple[str, float]:
    """Return verified, falsified or unknown, and the processor time of the search [s]."""
    began = time.process_time()
    (state,) = explore([problem], [None], lambda name, u: None)
    spent = time.process_time() - began
    tree = state.tree
    if bool((tree.lower[tree.is_leaf] >= 0.0).all()):
        return "verified", spent
    return "falsified" if bool((tree.upper < 0.0).any()) else "unknown", spent


def main() -> None:
    """Write everything into the folder that the command names."""
    if len(sys.argv) != 2 or Path(sys.argv[1]).exists():
        sys.exit("expected one argument, a folder that does not exist yet: name a new one")
    prepare()
    jax.config.update("jax_enable_x64", True)
    out = Path(sys.argv[1])
    make(out, QUERIES)
    solve(out, QUERIES)
    print((out / RESULTS).read_text(), end="")


if __name__ == "__main__":
    main()
