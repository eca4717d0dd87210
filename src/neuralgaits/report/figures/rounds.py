"""Figure of episodes: changes from round to round."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from neuralgaits.records.episode_records import EpisodesSummary, Round
from neuralgaits.report.drawing.figure import png
from neuralgaits.report.drawing.style import BLUE, GREEN, GREY, ORANGE, new_figure, styled
from neuralgaits.runs import write_bytes


def draw_file(summary: EpisodesSummary, figure: Path) -> Path:
    """Draw a summary of episodes. Returns: the path of the PNG file."""
    write_bytes(figure, png(draw(summary)))
    return figure


@styled
def draw(summary: EpisodesSummary) -> Figure:
    """Draw steps walked, speeds held, barriers held and held-out error over the rounds."""
    rounds = summary.rounds
    numbers = [entry.round for entry in rounds]
    figure = new_figure(6.0)
    axes = figure.subplots(2, 2)
    _steps(axes[0, 0], rounds)
    _speeds(axes[0, 1], rounds)
    _barriers(axes[1, 0], rounds)
    _errors(axes[1, 1], rounds)
    for part in axes.flat:
        part.set(xlabel="round [1], 0: trained on the model alone", xticks=numbers)
        part.set_xlim(min(numbers, default=0) - 0.5, max(numbers, default=0) + 0.5)
    figure.suptitle(_title(summary), fontsize=11)
    return figure


def _title(summary: EpisodesSummary) -> str:
    where = summary.plant or f"logs of {summary.logs}"
    changed = [f"{name}={value:g}" for name, value in (summary.disturb or {}).items() if value]
    extra = [part for part in changed if part != "mass_scale=1"]
    more = f" with {', '.join(extra)}" if extra else ""
    return f"policy for {summary.robot} on {where}{more}, controller {summary.controller}"


def _steps(axes: Axes, rounds: Sequence[Round]) -> None:
    for entry in rounds:
        steps = np.asarray(entry.steps_walked)
        spread = np.linspace(-0.2, 0.2, len(steps))
        axes.plot(entry.round + spread, steps, "o", color=BLUE, markersize=4)
    axes.set(title="one dot a walk", ylabel="steps walked")
    axes.set_ylim(bottom=0)


def _speeds(axes: Axes, rounds: Sequence[Round]) -> None:
    for entry in rounds:
        span = entry.speed_range_m_s
        if span is not None:
            axes.plot([entry.round] * 2, span, "-_", color=GREEN, linewidth=4, markersize=14)
        else:
            axes.annotate("none", (entry.round, 0.02), ha="center", color=GREY)
    axes.set(title="speeds at mid-step it walks on from", ylabel="hip speed dz1 [m/s]")
    axes.set_ylim(bottom=0)


def _barriers(axes: Axes, rounds: Sequence[Round]) -> None:
    numbers = [entry.round for entry in rounds]
    lowest = [min(entry.barriers.conditions.values(), default=0.0) for entry in rounds]
    # The second may lie on the first: dashes let it through.
    for label, style, colour, shares in (
        ("inside the region", "o-", BLUE, [entry.barriers.tube for entry in rounds]),
        ("and all conditions", "s--", GREEN, [entry.barriers.all for entry in rounds]),
        ("the worst condition", "^:", ORANGE, lowest),
    ):
        axes.plot(numbers, 100.0 * np.asarray(shares), style, color=colour, label=label)
    axes.set(title="measured on the robot", ylabel="share of logged time [%]", ylim=(0, 105))
    axes.legend(loc="lower right")


def _errors(axes: Axes, rounds: Sequence[Round]) -> None:
    for name, label, style, colour in (
        ("nominal_heldout_error", "model alone", "o-", GREY),
        ("binned_floor", "best table over z", "^:", ORANGE),
        ("heldout_error", "with what was learned", "s--", BLUE),
    ):
        values = [(entry.round, getattr(entry, name)) for entry in rounds]
        points = [(number, value) for number, value in values if value is not None]
        if points:
            axes.plot(*np.transpose(points), style, color=colour, label=label)
    axes.set(title="held-out strides, 0.1 s ahead", ylabel="error of scaled z [1]")
    axes.set_ylim(bottom=0)
    if axes.lines:
        axes.legend(loc="center left")
