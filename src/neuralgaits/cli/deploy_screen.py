"""Findings about a deployment file, for a person, on stdout."""

from rich.text import Text

from neuralgaits.cli.screen_tables import show_sentence, show_table
from neuralgaits.records.deployed import DeploymentCheck


def show_deployment_check(result: DeploymentCheck) -> None:
    """Show contradictions with their remedies, what was checked, and what was not."""
    if result.agrees:
        show_sentence(
            Text("agrees", "green"), f": nothing in {result.log} contradicts {result.file}"
        )
    else:
        count = len(result.findings)
        show_sentence(Text("differs", "red"), f": {result.log} contradicts {result.file}, {count}x")
    show_table(
        ("about", "found", "likely remedy"),
        [(one.about, one.found, one.remedy) for one in result.findings],
    )
    rows = []
    for name, one in result.joints.items():
        zero = "not checked"
        if one.zero_error_rad is not None:
            spread = "" if one.zero_spread_rad is None else f" +- {one.zero_spread_rad:.1g}"
            zero = f"{one.zero_error_rad:+.2f}{spread} rad"
        rows.append(
            (name, "checked" if one.motor else "not checked", one.sign or "not checked", zero)
        )
    show_table(
        ("joint", "motor", "sign by", "zero is off by"),
        rows,
    )
    for line in result.unchecked:
        show_sentence(Text("not checked", "yellow"), f": {line}")
