"""Figures of episodes that are brought to rest: two planes of states, and values over time."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure

from neuralgaits.report.drawing import style
from neuralgaits.systems.equilibrium.rest_episodes import RestTrace


@dataclass(frozen=True)
class StateLabels:
    """Words for a state and its limits.

    Attributes:
        names: names of coordinates and rates, with units. [4]
        moved: what the first coordinate is of.
        limit: largest value of the first coordinate.
        force: name of the force, with its unit.
        force_limit: largest force of the motor.
    """

    names: Sequence[str]
    moved: str
    limit: float
    force: str
    force_limit: float


@style.styled
def draw_planes(traces: Sequence[RestTrace], shape: np.ndarray, labels: StateLabels) -> Figure:
    """Draw episodes in both coordinates and in the second's plane, with the set's projection."""
    figure = Figure(figsize=(8.0, 3.6), layout="constrained")
    left, right = figure.subplots(1, 2)
    for one in traces:
        left.plot(one.state[:, 0], one.state[:, 1], color=style.BLUE, lw=0.9)
        right.plot(one.state[:, 1], one.state[:, 3], color=style.BLUE, lw=0.9)
    rows = np.asarray(shape)[:2]
    turn = np.linspace(0.0, 2.0 * np.pi, 200)
    edge = np.linalg.cholesky(rows @ rows.T) @ np.stack([np.cos(turn), np.sin(turn)])
    left.plot(*edge, color=style.RED, ls="--", label="projection of the set")
    for side in (-1.0, 1.0):
        left.axvline(side * labels.limit, color=style.BLACK, lw=1.5)
    left.set(xlabel=labels.names[0], ylabel=labels.names[1])
    left.legend(loc="upper right")
    right.set(xlabel=labels.names[1], ylabel=labels.names[3])
    return figure


@style.styled
def draw_times(traces: Sequence[RestTrace], rate: float, labels: StateLabels) -> Figure:
    """Draw radius, force and first coordinate over time, with the rate that is proved [1/s]."""
    figure = Figure(figsize=(8.0, 5.0), layout="constrained")
    first, second, third = figure.subplots(3, 1, sharex=True)
    for one in traces:
        first.semilogy(one.t, np.maximum(one.radius, 1e-6), color=style.BLUE, lw=0.9)
        second.plot(one.t, one.force, color=style.BLUE, lw=0.9)
        third.plot(one.t, one.state[:, 0], color=style.BLUE, lw=0.9)
    bound = np.exp(-rate * traces[0].t)
    first.semilogy(traces[0].t, bound, color=style.RED, ls="--", label="rate of the conditions")
    first.legend(loc="upper right")
    for axes, limit in ((second, labels.force_limit), (third, labels.limit)):
        for side in (-1.0, 1.0):
            axes.axhline(side * limit, color=style.BLACK, lw=1.5)
    first.set(ylabel="radius")
    second.set(ylabel=labels.force)
    third.set(ylabel=labels.names[0], xlabel="time [s]")
    return figure
