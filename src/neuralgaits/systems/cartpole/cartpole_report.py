"""The page of a cart-pole's run: its set, an episode from the face, and what is proved."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from neuralgaits._digits import at_least
from neuralgaits._printable import printable
from neuralgaits.errors import InputError
from neuralgaits.records.record import Count, Record
from neuralgaits.report.drawing import style
from neuralgaits.report.drawing.figure import svg
from neuralgaits.report.page.html_shell import inline_image, whole
from neuralgaits.report.page.markup import Html, items, join, paragraph, tag
from neuralgaits.runs import write_text
from neuralgaits.runs.outputs import refuse_outputs
from neuralgaits.systems.cartpole.cartpole_certify import trace_conditions
from neuralgaits.systems.cartpole.cartpole_run import CartPoleRun, widths
from neuralgaits.systems.cartpole.cartpole_simulate import Trace, starts, trace_of
from neuralgaits.systems.cartpole.cartpole_theorem import conclude
from neuralgaits.systems.cartpole.state_regions import CONDITIONS
from neuralgaits.systems.cartpole.stated import stated_bounds, why_nothing_is_stated

EPISODES = 12
"""Episodes in the pictures, each from the set's face."""
SHOWN_S = 8.0
"""Length of the episodes [s]."""
FILE = "report.html"


@dataclass(frozen=True, eq=False, kw_only=True)
class CartPoleReport(Record):
    """Result of `report`.

    Attributes:
        report: the page.
        bytes: its size.
        damaged: why a proof file that is there counts for nothing; None if it counts.
    """

    run: str
    report: str
    bytes: Count
    damaged: str | None = None


def report_cartpole(run: CartPoleRun, out: Path | None = None) -> CartPoleReport:
    """Write the page of a run. Returns: where it is."""
    place = run.path / FILE if out is None else out
    refuse_outputs([place], run=run.path)
    if place.suffix.lower() not in ("", ".html", ".htm"):
        raise InputError(f"expected --out as a file *.html, found {place}: the report is a page")
    stated = stated_bounds(run, trace_conditions(run))
    traces = [trace_of(run, start, SHOWN_S) for start in starts(run, EPISODES, seed=0)]
    figures = (
        (_planes(run, traces), "Episodes of MuJoCo from the set's face, in two planes"),
        (_times(run, traces), "Radius, force and cart of the same episodes over time"),
    )
    main = join(
        [
            _about(run),
            *(
                tag("figure", inline_image("svg+xml", svg(figure), words), tag("figcaption", words))
                for figure, words in figures
            ),
            _proof(run, stated),
        ]
    )
    header = tag("header", tag("h1", f"{run.config.robot}: a cart-pole"))
    text = whole(run.config.robot, header, tag("main", main), printable(run.path), ())
    write_text(place, text)
    return CartPoleReport(
        run=str(run.path),
        report=str(place),
        bytes=len(text.encode()),
        damaged=why_nothing_is_stated(run) if stated is None else None,
    )


def _about(run: CartPoleRun) -> Html:
    done, robot = run.summary, run.robot
    x, theta, velocity, turning = widths(run.controller)
    lines = [
        f"Set: cart up to {x:.3g} m from the middle of a rail of +-{robot.rail:g} m, pole up to "
        f"{np.degrees(theta):.3g} degrees from the upright, at up to {velocity:.3g} m/s and "
        f"{turning:.3g} rad/s.",
        f"Force limit: {robot.force_limit:g} N.",
    ]
    margins = [margin for name, margin in done.margins.items() if name in CONDITIONS]
    if margins:
        lines.append(
            f"Recorded in training: at {done.samples} random states the smallest margin of "
            f"{len(margins)} conditions is {min(margins):.3g}."
        )
    return tag("section", tag("h2", "Run"), items(lines))


def _proof(run: CartPoleRun, bounds: Mapping[str, float] | None) -> Html:
    """Return the bounds that the run's proof file states, and what follows."""
    if bounds is None:
        why = why_nothing_is_stated(run)
        said = "No proof of this run." if why is None else f"Nothing is proved: {why}."
        return tag("section", tag("h2", "Proof"), paragraph(said))
    rows = [
        f"{name}, on the {region}: "
        + (f"margin at least {at_least(bounds[name], 2)}" if name in bounds else "not stated")
        for name, region in CONDITIONS.items()
    ]
    for one in conclude(bounds, run.config.rate):
        said = "; ".join(one.words) if one.proved else one.reason
        rows.append(f"level {one.level}: {one.verdict}; {said}")
    note = (
        "According to the proof file, which this page has not checked: about the rigid model in "
        "continuous time. Verify with check-proof or build/proofcheck."
    )
    return tag("section", tag("h2", "Proof"), items(rows), paragraph(note))


@style.styled
def _planes(run: CartPoleRun, traces: list[Trace]) -> Figure:
    """Draw the episodes in (x, theta) and (theta, theta'), with the set's projection on one."""
    figure = Figure(figsize=(8.0, 3.6), layout="constrained")
    left, right = figure.subplots(1, 2)
    for one in traces:
        left.plot(one.state[:, 0], one.state[:, 1], color=style.BLUE, lw=0.9)
        right.plot(one.state[:, 1], one.state[:, 3], color=style.BLUE, lw=0.9)
    shape = np.asarray(run.controller.ball.shape)[:2]
    turn = np.linspace(0.0, 2.0 * np.pi, 200)
    edge = np.linalg.cholesky(shape @ shape.T) @ np.stack([np.cos(turn), np.sin(turn)])
    left.plot(*edge, color=style.RED, ls="--", label="projection of the set")
    for side in (-1.0, 1.0):
        left.axvline(side * run.robot.rail, color=style.BLACK, lw=1.5)
    left.set(xlabel="cart x [m]", ylabel="pole theta [rad]")
    left.legend(loc="upper right")
    right.set(xlabel="pole theta [rad]", ylabel="rate [rad/s]")
    return figure


@style.styled
def _times(run: CartPoleRun, traces: list[Trace]) -> Figure:
    """Draw radius, force and position over time."""
    figure = Figure(figsize=(8.0, 5.0), layout="constrained")
    first, second, third = figure.subplots(3, 1, sharex=True)
    for one in traces:
        first.semilogy(one.t, np.maximum(one.radius, 1e-6), color=style.BLUE, lw=0.9)
        second.plot(one.t, one.force, color=style.BLUE, lw=0.9)
        third.plot(one.t, one.state[:, 0], color=style.BLUE, lw=0.9)
    bound = np.exp(-run.config.rate * traces[0].t)
    first.semilogy(traces[0].t, bound, color=style.RED, ls="--", label="rate of the conditions")
    first.legend(loc="upper right")
    for axes, limit in ((second, run.robot.force_limit), (third, run.robot.rail)):
        for side in (-1.0, 1.0):
            axes.axhline(side * limit, color=style.BLACK, lw=1.5)
    first.set(ylabel="radius")
    second.set(ylabel="force [N]")
    third.set(ylabel="cart x [m]", xlabel="time [s]")
    return figure
