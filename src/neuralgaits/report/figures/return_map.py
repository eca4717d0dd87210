"""Poincaré map of the step: momentum as the hip passes over the foot, one step later.

The section is z1 = 0. A certificate uses the section at phase 1/2, where z2 has another value.
The slope at the orbit is the same on every section, and so is its bound on the walking set.
"""

from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from neuralgaits._digits import at_least, at_most
from neuralgaits._types import Float
from neuralgaits.analysis.data import GaitData
from neuralgaits.report.drawing.style import (
    BLACK,
    BLUE,
    GREEN,
    GREY,
    RED,
    new_figure,
    panel,
    styled,
)

STEPS = 12
"""Number of steps for which walks are followed."""


@dataclass(frozen=True)
class ProvedOrbit:
    """Results of a certificate of level 3 about the orbit.

    Attributes:
        z2: enclosure of the orbit's z2 at z1 = 0 [kg m^2/s].
        multiplier: enclosure of the slope of the return map at the orbit.
        contraction: upper bound on the contraction factor of the map of z2^2 / 2 on the whole
            walking set; None if the proof shows that nested tubes shrink instead.
    """

    z2: tuple[float, float]
    multiplier: tuple[float, float]
    contraction: float | None


def caption(data: GaitData, proved: ProvedOrbit | None) -> str:
    """Return the caption of the figure, with the proved results if there are any."""
    text = (
        "The curve says with how much momentum the hip passes over the standing foot one step "
        "later. Where it crosses the diagonal the robot repeats itself."
    )
    if abs(data.numbers.multiplier) < 1.0:
        text += (
            " It is flatter than the diagonal there, so a deviation shrinks, to "
            f"{abs(data.numbers.multiplier):.2f} of itself with each step."
        )
    if proved is not None:
        text += (
            " That such an orbit exists, is the only one and attracts the whole walking set is "
            "proved, for joints that follow the policy exactly."
        )
    return text


@styled
def draw(data: GaitData, proved: ProvedOrbit | None = None) -> Figure:
    """Draw the map with its fixed point, and how walks approach it."""
    figure = new_figure(5.0)
    left, right = figure.subplots(1, 2)
    _map(left, data, proved)
    _approach(right, data, proved)
    return figure


def _map(axes: Axes, data: GaitData, proved: ProvedOrbit | None) -> None:
    z2, after, numbers = data["map/z2"], data["map/z2_after"], data.numbers
    axes.plot(z2, z2, "--", color=GREY, linewidth=1.0, label="the same again")
    axes.plot(z2, after, color=BLUE, label="Poincaré map")
    reach = 0.16 * np.ptp(z2)
    near = numbers.z2 + np.array([-reach, reach])
    slope = numbers.z2 + numbers.multiplier * (near - numbers.z2)
    label = f"slope {numbers.multiplier:.3f}"
    if proved is not None:
        low, high = proved.multiplier
        label += f", proved {at_least(low, 3)} to {at_most(high, 3)}"
    axes.plot(near, slope, color=RED, linewidth=4.0, alpha=0.45, label=label, zorder=2.5)
    for start, colour in ((z2[0], GREEN), (z2[-1], GREEN)):
        points = np.repeat(_iterates(data, float(start)), 2)
        axes.plot(points[:-2], points[1:-1], "-.", color=colour, linewidth=1.0)
    axes.plot([], [], "-.", color=GREEN, linewidth=1.0, label="step after step")
    label = f"fixed point, {numbers.z2:.2f} kg m²/s"
    axes.plot(numbers.z2, numbers.z2, "o", color=BLACK, ms=6, label=label, zorder=4)
    axes.set(xlabel="z2 with the hip over the foot [kg m²/s]", ylabel="z2 one step later [kg m²/s]")
    # Room above the curve for its names.
    axes.set_ylim(top=float(np.max(after)) + 0.75 * float(np.ptp(after)))
    axes.legend(loc="upper left", fontsize=9)
    panel(axes, "a", "from one step to the next")
    if proved is not None:
        low, high = proved.z2
        middle, room = 0.5 * (low + high), 3.0 * (high - low)
        inset = axes.inset_axes((0.6, 0.15, 0.36, 0.2))
        inset.axvspan(1e3 * (low - middle), 1e3 * (high - middle), color="#cfe8dd")
        offset = 1e3 * (z2 - middle)
        inset.plot(offset, offset, "--", color=GREY, linewidth=1.0)
        inset.plot(1e3 * (numbers.z2 - middle), 1e3 * (numbers.z2 - middle), "o", color=BLACK, ms=5)
        inset.set_xlim(-1e3 * room / 2, 1e3 * room / 2)
        inset.set_ylim(-1e3 * room / 2, 1e3 * room / 2)
        inset.set_xlabel(f"z2 − {middle:.4f} [10⁻³ kg m²/s]", fontsize=9)
        inset.set_yticks([])
        inset.tick_params(labelsize=9)
        inset.set_title("proved: in the band", fontsize=9)


def _approach(axes: Axes, data: GaitData, proved: ProvedOrbit | None) -> None:
    numbers, steps = data.numbers, np.arange(STEPS + 1)
    z2 = data["map/z2"]
    for start, mark, label in (
        (z2[0], "v", "from the lower fence"),
        (z2[-1], "^", "from the upper fence"),
    ):
        away = np.abs(_iterates(data, float(start)) - numbers.z2)
        distances = np.where(away > 1e-5, away, np.nan)
        axes.plot(steps, distances, marker=mark, ms=5, linestyle="none", color=BLACK, label=label)
    first = float(np.max(np.abs(z2[[0, -1]] - numbers.z2)))
    label = f"multiplier {numbers.multiplier:.3f}, each step"
    axes.plot(steps, first * numbers.multiplier**steps, "--", color=RED, linewidth=1.2, label=label)
    if proved is not None and proved.contraction is not None:
        slowest = farthest(numbers.z2, z2[[0, -1]], proved.contraction**steps)
        label = f"proved: nearer than this, {at_most(proved.contraction, 3)} a step"
        axes.plot(steps, slowest, color=BLUE, linewidth=2.0, label=label)
    axes.set(yscale="log", xlabel="steps taken", ylabel="distance from the orbit [kg m²/s]")
    axes.set_ylim(bottom=first * min(abs(numbers.multiplier), 0.9) ** (STEPS + 1))
    low, high = axes.get_ylim()
    axes.set_ylim(top=high * (high / low) ** 0.45)
    axes.legend(loc="upper right", fontsize=9)
    panel(axes, "b", "walks come to the orbit")


def farthest(
    orbit: float, starts: Float[np.ndarray, "2"], shrunk: Float[np.ndarray, " k"]
) -> Float[np.ndarray, " k"]:
    """Return the largest distance from the orbit after zeta = z2^2 / 2 has contracted.

    The map contracts in zeta. At equal distance in zeta, a state below the orbit is farther from it
    in z2 than one above.

    Args:
        orbit: z2 of the fixed point [kg m^2/s].
        starts: initial z2 of the walks [kg m^2/s].
        shrunk: remaining share of the initial distance in zeta.
    """
    most = float(np.max(np.abs(starts**2 - orbit**2)))
    return orbit - np.sqrt(np.maximum(orbit**2 - most * shrunk, 0.0))


def _iterates(data: GaitData, start: float) -> np.ndarray:
    """Iterate the sampled map from a start. [STEPS + 1]."""
    z2, after = data["map/z2"], data["map/z2_after"]
    states = [start]
    for _ in range(STEPS):
        states.append(float(np.interp(states[-1], z2, after)))
    return np.array(states)
