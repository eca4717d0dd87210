"""The result of an export as tables for a person, on stdout."""

from collections.abc import Mapping
from typing import Any

from rich.console import Console
from rich.table import Table
from rich.text import Text


def show_export(result: Mapping[str, Any]) -> None:
    """Whether C does what Python does, how close, how fast, how large."""
    console = Console(highlight=False)
    count = f"{len(result['files'])} files in {result['out']}"
    if not result["checked"]:
        console.print(Text.assemble(Text("not checked", "yellow"), f": {result['reason']}"))
        console.print(Text(count))
        return
    states = f"{result['states']} states"
    console.print(Text.assemble(Text("agrees", "green"), f" with Python on {states}; {count}"))
    table = Table(box=None, pad_edge=False, header_style="bold")
    for name in ("build", "y_d, of its range", "torque, of its limit", "policy p99 us"):
        table.add_column(name)
    laws = [name for name in result["builds"][0]["latency_us"] if name in result["laws"]]
    for name in laws:
        table.add_column(f"{name} p99 us")
    for build in result["builds"]:
        agreement, times = build["agreement"], build["latency_us"]
        table.add_row(
            f"{build['precision']}, {build['compiler']} {build['flags'].split()[0]}",
            f"{max(agreement['output'], agreement['rate']):.2g}",
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
