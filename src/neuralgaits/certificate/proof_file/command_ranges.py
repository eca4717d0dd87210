"""Compare the chart of a proof with the commands of its model's gait.

Every statement is about the chart. Its first axes behind phase and level are those of the gait's
commands, over their ranges or a part of them. Needs no JAX.
"""

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

from neuralgaits._digits import from_hex
from neuralgaits._names import why_no_name
from neuralgaits.certificate.chart import Chart
from neuralgaits.certificate.proof_file.json_fields import exactly
from neuralgaits.certificate.proof_file.limits import MOST_COMMANDS, limit

OTHER_CHART = "the file's chart is not that of its gait's commands"


class ModelCommand(NamedTuple):
    """A command of a proof's model, see `gait.commands.Command`."""

    name: str
    low: float
    high: float
    largest_change: float | None


def command_ranges(model: Mapping[str, Any]) -> tuple[ModelCommand, ...]:
    """Read the commands of a model's gait. Raises: ValueError on anything else."""
    policy = model.get("policy", {})
    if not isinstance(policy, dict):
        raise ValueError("a policy that is no JSON object")
    if "commands" not in policy:
        return ()
    rows = policy["commands"]
    if not isinstance(rows, list) or not rows:
        raise ValueError("a gait that takes commands, without any")
    limit(len(rows), MOST_COMMANDS, "commands")
    ranges = tuple(map(_command, rows))
    if len({one.name for one in ranges}) < len(ranges):
        raise ValueError("two commands of one name")
    return ranges


def _command(row: Any) -> ModelCommand:
    fields = exactly(row, "a command", ModelCommand._fields)
    if why := why_no_name(fields["name"]):
        raise ValueError(f"a command named {why}")
    low, high, change = (fields[name] for name in ("low", "high", "largest_change"))
    command = ModelCommand(
        fields["name"],
        from_hex(low, fields["name"]),
        from_hex(high, fields["name"]),
        None if change is None else from_hex(change, fields["name"]),
    )
    if not command.low < command.high or (change is not None and not command.largest_change):
        raise ValueError(
            f"the command {command.name} without a range, or with a change that is none"
        )
    return command


def refuse_other_family(chart: Chart, model: Mapping[str, Any] | None, *, theorems: bool) -> None:
    """Refuse a walker's model or theorems on the chart of another family, and the reverse.

    Raises: ValueError.
    """
    if theorems and not chart.walks:
        raise ValueError("theorems about walks on a chart without phase and level")
    if model is not None and chart.walks is ("family" in model):
        raise ValueError("a model of another family than the chart's")


def is_beyond(chart: Chart, commands: Sequence[ModelCommand]) -> bool:
    """Return whether a chart's first axes are those of the commands, beyond their ranges."""
    return _alike(chart, commands) and not Chart.of(commands).holds(
        chart.of_commands(len(commands))
    )


def why_part(chart: Chart, commands: Sequence[ModelCommand]) -> str | None:
    """Describe the part of the commands that a chart covers; None if it covers all of them."""
    if not _alike(chart, commands):
        return "every statement holds, on a chart without the axes of the gait's commands"
    first = chart.of_commands(len(commands))
    if first == Chart.of(commands):
        return None
    axes = " and ".join(first.intervals())
    return f"every statement holds, for {axes} only: part of the gait's commands"


def _alike(chart: Chart, commands: Sequence[ModelCommand]) -> bool:
    expected = Chart.of(commands).parameters
    own = chart.of_commands(len(commands)).parameters
    return [axis.name for axis in expected] == [axis.name for axis in own]
