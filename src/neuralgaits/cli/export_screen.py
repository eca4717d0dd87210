"""The result of an export as tables for a person, on stdout."""

from collections.abc import Mapping
from typing import Any

from rich.text import Text

from neuralgaits.cli.tables import show_sentence, show_table

Result = Mapping[str, Any]


def show_export(result: Result) -> None:
    """Whether what was written does what Python does, how close, how fast, how large."""
    count = f"{len(result['files'])} files in {result['out']}"
    for warning in result["warnings"]:
        show_sentence(Text("warning", "yellow"), f": {warning}")
    if not result["checked"]:
        show_sentence(Text("not checked", "yellow"), f": {result['reason']}")
        show_sentence(count)
        return
    states = f"{result['states']} states"
    show_sentence(Text("agrees", "green"), f" with Python on {states}; {count}")
    if result["format"] == "onnx":
        _show_models(result)
    else:
        _show_controller(result)


def _show_controller(result: Result) -> None:
    laws = [name for name in result["builds"][0]["latency_us"] if name in result["laws"]]
    head = ("build", "y_d", "torque", "policy us")
    rows = []
    for build in result["builds"]:
        agreement, times = build["agreement"], build["latency_us"]
        rows.append(
            (
                f"{build['precision']}, {build['compiler']} {build['flags'].split()[0]}",
                _worst_output(agreement),
                f"{agreement['torque']:.2g}",
                f"{times['policy']['p99']:.3g}",
                *(f"{times[name]['p99']:.3g}" for name in laws),
            )
        )
    show_table((*head, *(f"{name} us" for name in laws)), rows)
    show_sentence("Largest distances are shares of range and limit; times are p99, of whole ticks.")
    for precision, sizes in result["sizes"].items():
        show_sentence(
            f"{precision}: {sizes['flash_bytes']} bytes of code and weights, "
            f"{sizes['ram_bytes'] or 'unknown'} bytes of RAM with the stack"
        )
    bound = result["float_bound"]
    show_sentence(
        f"float: y_d is proved to be within {bound['output']:.2g} of its range everywhere"
    )


def _show_models(result: Result) -> None:
    rows = [
        (
            f"{build['file']}, {build['precision']}",
            _worst_output(build["agreement"]),
            f"{build['latency_us']['p50']:.3g}",
            f"{build['latency_us']['p99']:.3g}",
            str(build["model_bytes"]),
        )
        for build in result["builds"]
    ]
    show_table(("model", "y_d, of its range", "p50 us", "p99 us", "bytes"), rows)
    show_sentence(f"{result['builds'][0]['runtime']}, one thread, called from Python")


def _worst_output(agreement: Result) -> str:
    return f"{max(agreement['output'], agreement['rate']):.2g}"
