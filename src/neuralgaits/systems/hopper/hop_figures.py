"""Figures of a hopper's run: the tube with touchdowns of episodes, and one episode over time."""

from collections.abc import Sequence

import jax
import jax.numpy as jnp
import numpy as np
from matplotlib.figure import Figure

from neuralgaits.report.drawing import style
from neuralgaits.systems.hopper.hop_conditions import HopController
from neuralgaits.systems.hopper.hop_episodes import HopTrace
from neuralgaits.systems.hopper.hopper_model import Hopper


@style.styled
def draw_tube(robot: Hopper, controller: HopController, traces: Sequence[HopTrace]) -> Figure:
    """Draw the fences over a stance, the policy's lengths there, and levels at touchdowns."""
    figure = Figure(figsize=(8.0, 3.2), layout="constrained")
    fences, lengths, levels = figure.subplots(1, 3)
    s = np.linspace(0.0, 1.0, 101)
    lean = np.asarray(jax.vmap(controller.policy.lean)(jnp.asarray(s)))
    for level, color in ((0.0, style.RED), (1.0, style.RED), (0.5, style.BLUE)):
        sigma = jax.vmap(lambda x, one=level: controller.tube.momentum(x, jnp.asarray(one)))(s)
        fences.plot(lean, sigma, color=color, lw=1.2)
        length = jax.vmap(lambda x, z: controller.policy.length(robot, x, z))(s, sigma)
        lengths.plot(lean, length, color=color, lw=1.2)
    fences.set(xlabel="lean [rad]", ylabel="momentum about the foot [kg m^2/s]")
    lengths.set(xlabel="lean [rad]", ylabel="length of the leg [m]")
    for one in traces:
        levels.plot(one.touchdowns[:, 2], color=style.BLUE, lw=0.9)
    for level in (0.0, 1.0):
        levels.axhline(level, color=style.RED, lw=1.2)
    levels.set(xlabel="hop", ylabel="level at touchdown")
    return figure


@style.styled
def draw_hops(trace: HopTrace) -> Figure:
    """Draw height of the hub, lean, length and force of an episode over time."""
    figure = Figure(figsize=(8.0, 5.0), layout="constrained")
    rows = (("hub [m]", 2), ("lean [rad]", 3), ("length [m]", 4), ("force [N]", 5))
    for axes, (words, column) in zip(figure.subplots(4, 1, sharex=True), rows, strict=True):
        axes.plot(trace.ticks[:, 0], trace.ticks[:, column], color=style.BLUE, lw=0.9)
        axes.set(ylabel=words)
    axes.set(xlabel="time [s]")
    return figure
