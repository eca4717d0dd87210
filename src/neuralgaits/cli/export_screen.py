"""The result of an export as tables for a person, on stdout."""

from collections.abc import Mapping
from typing import Any

from rich.console import Console
from rich.table import Table
from rich.text import Text

Result = Mapping[str, Any]


def show_export(result: Result) -> None:
    """Whether what was written does what Python does, how close, how fast, how large."""
    console = Console(highlight=False)
    count = f"{len(result['files'])} files in {result['out']}"
    if not result["checked"]:
        console.print(Text.assemble(Text("not checked", "yellow"), f": {result['reason']}"))
        console.print(Text(count))
        return
    states = f"{result['states']} states"
    console.print(Text.assemble(Text("agrees", "green"), f" with Python on {states}; {count}"))
    if result["format"] == "onnx":
        _show_models(console, result)
    else:
        _show_controller(console, result)


def _show_controller(console: Console, result: Result) -> None:
    laws = [name for name in result["builds"][0]["latency_us"] if name in result["laws"]]
    table = _table(
        "build",
        "y_d, of its range",
        "torque, of its limit",
        "policy p99 us",
        *(f"{name} p99 us" for name in laws),
    )
    for build in result["builds"]:
        agreement, times = build["agreement"], build["latency_us"]
        table.add_row(
            f"{build['precision']}, {build['compiler']} {build['flags'].split()[0]}",
            _worst_output(agreement),
            f"{agreement['torque']:.2g}",
            f"{times['policy']['p99']:.3g}",
            *(f"{times[name]['p99']:.3g}" for name in laws),
        )
    console.print(table)
    for precision, sizes in result["sizes"].items():
        console.print(
            Text(
                f"{precision}: {sizes['flash_bytes']} bytes of code and weights, "
                f"{sizes['ram_bytes'] or 'unknown'} bytes of RAM with the stack"
            )
        )
    bound = result["float_bound"]
    console.print(
        Text(f"float: y_d is proved to be within {bound['output']:.2g} of its range everywhere")
    )


def _show_models(console: Console, result: Result) -> None:
    table = _table("model", "y_d, of its range", "p50 us", "p99 us", "bytes")
    for build in result["builds"]:
        times = build["latency_us"]
        table.add_row(
            f"{build['file']}, {build['precision']}",
            _worst_output(build["agreement"]),
            f"{times['p50']:.3g}",
            f"{times['p99']:.3g}",
            str(build["model_bytes"]),
        )
    console.print(table)
    console.print(Text(f"{result['builds'][0]['runtime']}, one thread, called from Python"))


def _table(*columns: str) -> Table:
    table = Table(box=None, pad_edge=False, header_style="bold")
    for name in columns:
        table.add_column(name)
    return table


def _worst_output(agreement: Result) -> str:
    return f"{max(agreement['output'], agreement['rate']):.2g}"
