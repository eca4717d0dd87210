"""Compare a proof file with its run, whose conditions are traced again."""

from pathlib import Path
from typing import NamedTuple

from neuralgaits.certificate.chart import Chart
from neuralgaits.certificate.proof_file.coverage import SpecOutline
from neuralgaits.certificate.proof_file.reader import Claims
from neuralgaits.certificate.run_certificate import retrace
from neuralgaits.certificate.run_certificate.retrace import RunDescription
from neuralgaits.errors import RunError


class RunComparison(NamedTuple):
    """Differences between a proof file and a run, and the requirements of the run's spec.

    Attributes:
        wrong: differences, one sentence each.
        outline: conditions and regions of the run's spec.
        chart: every command that the run's gait takes, and the proof's axes of robots.
        command_names: names of these commands.
    """

    wrong: tuple[str, ...]
    outline: SpecOutline
    chart: Chart
    command_names: tuple[str, ...]


def compare_with_run(claims: Claims, folder: Path, *, own_process: bool = True) -> RunComparison:
    """Trace a run's conditions again and compare them with a proof file.

    Args:
        claims: claims of the file.
        folder: folder of the run.
        own_process: trace in a process of its own even if the spec is one of this package's; the
            run's own spec always is.

    Raises: InputError if the run cannot be opened or traced.
    """
    describe = retrace.retrace_in_subprocess if own_process else retrace.here_if_built_in
    description = describe(folder, claims.theorems, claims.chart)
    try:
        wrong = differences_of_program(claims, description)
        chart = Chart.read(description["chart"])
        outline = SpecOutline.read(
            description["regions"], description["conditions"], ends=chart.region_ends
        )
    except (KeyError, TypeError, ValueError) as error:
        raise RunError(
            f"expected the conditions of {folder}, traced again, found an answer that is none "
            f"({error!r}): its spec meddles with the process that traces it"
        ) from None
    if not wrong and not chart.holds(claims.chart):
        wrong = [
            "the file's chart is not that of the commands of the run's gait, and of its robots"
        ]
    return RunComparison(tuple(wrong), outline, chart, tuple(description["told"]))


def differences_of_program(claims: Claims, description: RunDescription) -> list[str]:
    """List the differences between a proof and the run's own conditions, traced again."""
    walking, full = claims.theorems.walking, claims.theorems.full
    if (
        full is not None
        and [barrier.name for barrier in full.barriers] != description["full_order"]
    ):
        return [
            f"the run's barriers are {', '.join(description['full_order'])}, not those of level 4"
        ]
    if description["program_hash"] != claims.program_hash:
        return [
            f"the run's conditions have the hash {description['program_hash']}, "
            f"not {claims.program_hash}"
        ]
    wrong = []
    if walking is not None:
        for what in ("barriers", "carried", "told"):
            if list(getattr(walking, what)) != description[what]:
                wrong.append(f"{what} of level 2 are not all those of the run's spec")
    # The C++ checker starts from the model, and this program from nothing but the Program.
    if claims.model is not None and claims.model != description.get("model"):
        wrong.append("the file's model is not the run's robot, policy, tube and spec")
    return wrong
