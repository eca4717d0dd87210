"""The result of an export as tables for a person, on stdout."""

import contextlib
from collections.abc import Sequence
from pathlib import Path

from rich.text import Text

from neuralgaits._digits import at_most
from neuralgaits.cli.screen_tables import show_facts, show_sentence, show_table
from neuralgaits.errors import RunError
from neuralgaits.records.exported import (
    Agreement,
    ControllerExport,
    ExportRecord,
    Model,
    ModelAgreement,
    ModelExport,
    MonitorExport,
    QueryExport,
    UncheckedExport,
)
from neuralgaits.records.law_proof import summary_of
from neuralgaits.records.level_words import DISTURBED_LEVEL
from neuralgaits.records.training_config import config_of
from neuralgaits.runs import RunFolder
from neuralgaits.runs.shell_words import command, named


def show_export(result: ExportRecord) -> None:
    """Show whether the export agrees with Python, and how close, how fast and how large it is."""
    count = f"{len(result.files)} files in {result.out}"
    for warning in result.warnings:
        show_sentence(Text("warning", "yellow"), f": {warning}")
    if isinstance(result, UncheckedExport):
        show_sentence(Text("not checked", "yellow"), f": {result.reason}")
        show_sentence(count)
    elif isinstance(result, ModelExport):
        _agrees(result.states, count)
        _show_models(result.builds)
    elif isinstance(result, QueryExport):
        _agrees(result.states, count)
        _show_queries(result)
    elif isinstance(result, ControllerExport):
        _agrees(result.states, count)
        _show_controller(result)
    if (words := summary_of(result.law_proofs)) is not None:
        colour = "green" if any(one.proved for one in result.law_proofs) else "yellow"
        show_sentence(Text("level 5", colour), f" of {words}")
    else:
        _show_unproved(result)
    show_facts([("next", _after_export(result))])


def _show_unproved(result: ExportRecord) -> None:
    """Say that no proof is about what was written, and which could be."""
    if isinstance(result, QueryExport):
        # Its queries are what is to be proved.
        return
    if isinstance(result, ModelExport):
        show_sentence(Text("level 5", "yellow"), ": nothing is proved, a policy is no control law")
        return
    looks = ""
    with contextlib.suppress(RunError):
        if config_of(RunFolder.open(Path(result.run))).last_level >= DISTURBED_LEVEL:
            width = result.bandwidth or 50.0
            asked = command(
                "certify", named(result.run), "--level", "5", "--bandwidth", f"{width:g}"
            )
            looks = f" `{asked}` looks for a proof of fblin, which then is the default law."
    show_sentence(
        Text("level 5", "yellow"),
        ": nothing is proved of these laws; a proof of levels 1 to 4 is about the model under "
        f"ideal control.{looks}",
    )


def _after_export(result: ExportRecord) -> str:
    """Return the command to give next: walk what was written, or make that possible."""
    if isinstance(result, UncheckedExport):
        return command("doctor")
    if isinstance(result, QueryExport):
        return command("certify", named(result.run))
    if isinstance(result, ModelExport):
        return command("simulate", named(result.run))
    return command("simulate", named(result.run), "--controller", "c")


def _agrees(states: int, count: str) -> None:
    show_sentence(Text("agrees", "green"), f" with Python on {states} states; {count}")


def _show_controller(result: ControllerExport) -> None:
    laws = [name for name in result.builds[0].latency_us if name in result.laws]
    if result.monitor is not None:
        _show_monitor(result.monitor)
    head = ("build", "y_d", "torque", "policy")
    rows = []
    for build in result.builds:
        times = build.latency_us
        rows.append(
            (
                f"{build.precision}, {build.compiler} {build.flags.split()[0]}",
                _worst_output(build.agreement),
                f"{build.agreement.torque:.2g}",
                *(f"{times[name].p99:.3g}" for name in ("policy", *laws)),
            )
        )
    show_table((*head, *laws), rows)
    show_sentence(
        "Largest distances are shares of range and limit; times are p99 in µs, of whole ticks."
    )
    for precision, sizes in result.sizes.items():
        show_sentence(
            f"{precision}: {sizes.flash_bytes} bytes of code and weights, "
            f"{sizes.ram_bytes or 'unknown'} bytes of RAM with the stack"
        )
    show_sentence(
        "float: by error analysis, y_d is off by no more than "
        f"{at_most(result.float_bound.output, 2)} of its range at any z of the region"
    )


def _show_monitor(monitor: MonitorExport) -> None:
    first = monitor.builds[0]
    show_sentence(
        f"monitor of the sets of level {', '.join(map(str, monitor.levels))}: agrees with "
        f"Python on {monitor.states} states; an answer takes {first.answer_us.p50:.3g} µs"
    )


def _show_models(models: Sequence[Model]) -> None:
    rows = [
        (
            f"{model.file}, {model.precision}",
            _worst_output(model.agreement),
            f"{model.latency_us.p50:.3g}",
            f"{model.latency_us.p99:.3g}",
            str(model.model_bytes),
        )
        for model in models
    ]
    show_table(("model", "y_d, of its range", "p50 µs", "p99 µs", "bytes"), rows)
    show_sentence(f"{models[0].runtime}, one thread, called from Python")


def _show_queries(result: QueryExport) -> None:
    """Show how many queries there are, and how far the models are from Python."""
    queries = sum(len(model.queries) for model in result.models)
    double = max(model.difference for model in result.models)
    single = max(model.float_difference for model in result.models)
    show_sentence(f"{len(result.models)} conditions, {queries} queries: unsat if one holds")
    show_sentence(
        f"margins differ from Python's by up to {double:.1e} of a scale in double precision, as "
        f"written, and {single:.1e} in single ({result.runtime})"
    )
    show_sentence(f"Open {result.out}/README.md for axes, answers and their limits.")


def _worst_output(agreement: Agreement | ModelAgreement) -> str:
    return f"{max(agreement.output, agreement.rate):.2g}"
