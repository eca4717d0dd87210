"""Trace a run's own robot, spec and weights to data that a proof of it must match.

A run's spec may be code of its own, and code can reach into the program that imports it. So
`retrace_in_subprocess` traces the spec in a process of its own, and the result is JSON: it can be
wrong, but it can patch no checker.
"""

import contextlib
import json
import subprocess
import sys
import tempfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, TypedDict, cast

from neuralgaits._environment import why_jax_failed
from neuralgaits._families import retrace_module
from neuralgaits._own_process import command_of, environment_of
from neuralgaits.certificate.chart import PLANE_ONLY, Chart
from neuralgaits.certificate.proof_file.theorem_tables import Theorems
from neuralgaits.errors import InputError, NeuralGaitsError, RunError, TimeLimitError
from neuralgaits.records.training_config import config_of
from neuralgaits.runs import RunFolder, plain, write_text


class RunDescription(TypedDict):
    """Data that a proof must match, as JSON: the answer of the process that traces a run.

    Attributes:
        program_hash: hash of the run's Program; None if none was traced.
        model: robot, policy, tube and spec, as a proof file has them; None if none was traced.
        regions, conditions: of the spec, as a model has them, by name.
        barriers, carried: names of the conditions of level 2.
        told: names of the gait's commands.
        chart: chart of all values that the commands may have, as a proof file has it.
        full_order: names of the barriers of level 4.
    """

    program_hash: str | None
    model: Any
    regions: Mapping[str, Any]
    conditions: Mapping[str, Any]
    barriers: list[str]
    carried: list[str]
    told: list[str]
    chart: Any
    full_order: Sequence[str]


LONGEST_S = 300.0
"""Longest time for tracing a spec [s]; the largest takes seconds."""


def retrace_in_subprocess(
    run: Path, theorems: Theorems, chart: Chart = PLANE_ONLY
) -> RunDescription:
    """Have a process of its own run `describe_run`.

    Raises: TimeLimitError if the spec does not come to an end within `LONGEST_S`; RunError if it
        ends the process; InputError if the run cannot be opened or traced.
    """
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "answer.json"
        try:
            process = subprocess.run(
                command_of(_module_of(run), str(run), str(file)),
                input=json.dumps({"theorems": theorems.tables(), "chart": chart.table()}),
                stdout=subprocess.DEVNULL,
                stderr=subprocess.PIPE,
                text=True,
                errors="replace",
                check=False,
                env=environment_of(JAX_ENABLE_X64="1"),
                timeout=LONGEST_S,
            )
        except subprocess.TimeoutExpired:
            raise TimeLimitError(
                f"expected the conditions of {run} to be traced within {LONGEST_S:g} s, found no "
                "answer by then: look in its spec.py for what never ends"
            ) from None
        description = _read(file)
    if description is None or process.returncode != 0:
        last_lines = " | ".join(process.stderr.strip().splitlines()[-3:])
        raise RunError(
            f"expected the conditions of {run}, traced again, found that the process that traces "
            f"them ended with code {process.returncode} and no answer: "
            f"{last_lines or 'it said nothing'}"
        )
    if "error" in description:
        raise InputError(str(description["error"]))
    # Whoever reads it meets what is missing or of another type: the process may have been patched.
    return cast(RunDescription, description)


def _module_of(run: Path) -> str:
    """Return the module that a process of its own runs for a run's family."""
    return (
        retrace_module(RunFolder.open(run).config)
        or "neuralgaits.certificate.run_certificate.retrace"
    )


def refuse_endless(folder: RunFolder) -> None:
    """Have a process of its own open and trace a run of a user's spec, before this one opens it.

    Raises: TimeLimitError if the spec does not come to an end; RunError if it ends the process.
        All other faults are left to the caller, who meets them again.
    """
    if ".py:" not in config_of(folder).spec:
        return
    try:
        retrace_in_subprocess(folder.path, Theorems())
    except RunError:
        raise
    except InputError:
        pass


def here_if_built_in(run: Path, theorems: Theorems, chart: Chart = PLANE_ONLY) -> RunDescription:
    """Describe a run of a built-in spec in this process, any other in one of its own."""
    from neuralgaits.barriers import specs  # Brings JAX.

    built_in = specs.is_built_in(config_of(RunFolder.open(run)).spec)
    return (describe_run if built_in else retrace_in_subprocess)(run, theorems, chart)


def _read(file: Path) -> dict[str, Any] | None:
    try:
        table = json.loads(file.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None
    return table if isinstance(table, dict) else None


def describe_run(run: Path, theorems: Theorems, chart: Chart = PLANE_ONLY) -> RunDescription:
    """Describe what a proof with these theorems must be about, in this process.

    Args:
        run: its folder.
        theorems: theorems of the proof.
        chart: chart of the proof: which parameters of the robot are inputs of its Program.

    If the barriers of level 4 are not the theorems', no Program is traced.

    Raises: InputError if the run cannot be opened or traced.
    """
    # These import JAX, and the run's spec.
    from neuralgaits.analysis.run import open_run
    from neuralgaits.certificate.levels.full_order.model import FullOrderModel
    from neuralgaits.certificate.levels.level_search import LevelSets
    from neuralgaits.certificate.levels.problems import trace_certificate
    from neuralgaits.certificate.levels.walking_set.find import names_of
    from neuralgaits.certificate.proof_file.model_data import model_data
    from neuralgaits.certificate.provable import why_not_of_beliefs, why_not_robust
    from neuralgaits.robots.mjcf.parameters import box_of

    opened = open_run(run)
    spec, robot, gait, residuals = opened.spec, opened.robot, opened.trained, opened.residuals
    full = theorems.full
    if full is not None and opened.learned is not None:
        raise InputError(
            "expected a run of the rigid model for a proof of level 4, found one whose "
            f"dynamics carry a learned residual, {run}: level 4 is not about it"
        )
    spec = replace(spec, parameters=_errors(robot, chart, 2 * len(spec.commands)))
    kinds = box_of(robot, spec.parameters) if spec.parameters else {}
    if why := why_not_of_beliefs(spec.commands, kinds):
        raise InputError(f"expected a proof about the robots of the run's gait, found {why}")
    if spec.parameters and (why := why_not_robust(opened)):
        raise InputError(f"expected a run that can be proved for a box of robots, found {why}")
    described = plain(spec.describe())
    barriers, carried = names_of(spec)
    description: RunDescription = {
        "program_hash": None,
        "model": None,
        "regions": described["regions"],
        "conditions": {row["name"]: row for row in described["conditions"]},
        "barriers": list(barriers),
        "carried": list(carried),
        "told": [command.name for command in spec.commands],
        "chart": Chart.of(spec.commands, spec.parameters).table(),
        "full_order": FullOrderModel(robot, opened.gait, spec).names if full is not None else [],
    }
    if full is None or [barrier.name for barrier in full.barriers] == description["full_order"]:
        program = trace_certificate(spec, robot, gait, LevelSets(theorems.parameters), residuals)
        model = model_data(robot, gait, spec, program, residuals)
        description["program_hash"], description["model"] = program.hash, plain(model)
    return description


def _errors(robot: Any, chart: Chart, command_axes: int) -> Any:
    """Return a chart's axes of robot parameters, behind those of commands; () for none.

    A box whose middle is not the file's robot, or that holds impossible robots, gives () as well.
    """
    from neuralgaits.robots.mjcf.parameters import ParameterAxis, box_of

    errors = chart.parameters[command_axes:]
    axes = tuple(ParameterAxis(axis.name, axis.high) for axis in errors)
    if not axes or any(axis.low != -axis.high or axis.change is not None for axis in errors):
        return ()
    with contextlib.suppress(ValueError, NeuralGaitsError):
        box_of(robot, axes)
        return axes
    return ()


def answer(describe: Callable[[Path, Theorems, Chart], RunDescription]) -> None:
    """Describe a run as the process that `retrace_in_subprocess` starts: JSON in, JSON out.

    Args:
        describe: the family's own function, with the arguments of `describe_run`.
    """
    run, file = sys.argv[1:]
    try:
        request = json.load(sys.stdin)
        description = describe(
            Path(run), Theorems.read(request["theorems"]), Chart.read(request["chart"])
        )
    except (NeuralGaitsError, OSError) as error:
        description = {"error": str(error)}
    except Exception as error:
        if (setting := why_jax_failed(error)) is None:
            raise
        description = {"error": setting}
    write_text(Path(file), json.dumps(description))


if __name__ == "__main__":
    answer(describe_run)
