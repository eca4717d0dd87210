r"""Equations for friction and rotors from the torques of a walk, one a window and joint.

On a foot that does not move, the coordinates q of the stance leg need no ground force. With p the
momenta and L the Lagrangian of the links alone, joint j with rotor inertia a, dry friction f,
viscous friction d and torques that act a short time s after the log has them obeys

    d/dt (p_j + a dq_j) = dL/dq_j + tau_j - s dtau_j/dt - f sign(dq_j) - d dq_j.

Multiplied by a weight w(t) that vanishes at both ends of a window and integrated by parts, that is
an equation without any acceleration, linear in (a, f, d, s):

    -a int w' dq_j + f int w sign(dq_j) + d int w dq_j - s int w' tau_j
        = int w (dL/dq_j + tau_j) + int w' p_j.

Source: the weak form, as in Messenger and Bortz (2021), doi:10.1137/20M1343166.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import jax
import numpy as np

from neuralgaits._blocks import in_blocks_of
from neuralgaits._types import Actuated, Array, Coordinates, Float, Int
from neuralgaits.logs import Log, Stride
from neuralgaits.robots.layout import MjcfLayout

WINDOW_S = 0.15
"""Length of a window [s]."""
SLOWEST_RAD_S = 0.1
"""A joint turns at least this fast all through a window: below, friction may be anything up to dry
friction, and noise decides about its sign."""

LinkMomenta = Callable[[Coordinates, Coordinates], tuple[Actuated, Actuated]]
"""Momenta and generalised forces dL/dq of the actuated joints without rotors, at (q, dq): see
`robots.link_momenta`. A pytree, as of `equinox.Partial`, so that robots share compiled code."""


@dataclass(frozen=True, eq=False)
class JointWindows:
    """Equations of one joint of both legs: N windows.

    Attributes:
        names: names of the joint in the robot file, one for each leg.
        features: factors of rotor inertia (rad/s^2), dry friction (sign), damping (rad/s), and the
            delay of the torques (N m/s). [N, 4]
        torque: torque that rotor and friction account for [N m]. [N]
        stride: index of each window's stride. [N]
        phase: number that is the same for windows at the same place of a stride. [N]
    """

    names: tuple[str, ...]
    features: Float[np.ndarray, "N 4"]
    torque: Float[np.ndarray, " N"]
    stride: Int[np.ndarray, " N"]
    phase: Int[np.ndarray, " N"]

    def of(self, strides: Sequence[int]) -> "JointWindows":
        """Return the windows of some strides."""
        which = np.isin(self.stride, strides)
        return JointWindows(
            self.names,
            self.features[which],
            self.torque[which],
            self.stride[which],
            self.phase[which],
        )


def joint_windows(
    layout: MjcfLayout, links: LinkMomenta, strides: Sequence[tuple[Log, Stride]]
) -> tuple[JointWindows, ...]:
    """Return the equations of every joint, lowest first, left and right joint together.

    Args:
        layout: layout of a robot file on point feet.
        links: model of the links.
        strides: pieces of walks with the logs that they are from.
    """
    parts = [
        _stride_windows(links, log, stride, number) for number, (log, stride) in enumerate(strides)
    ]
    first, second = layout.leg_joints
    windows = []
    for place, (one, other) in enumerate(zip(first, second, strict=True)):
        # Stance joints go up the leg and swing joints down: both ends belong to one joint.
        actuated = sorted({place, len(parts[0]) - 1 - place})
        rows = [part[j] for part in parts for j in actuated]
        windows.append(
            JointWindows(
                tuple(dict.fromkeys((one, other))),
                *(np.concatenate(column) for column in zip(*rows, strict=True)),
            )
        )
    return tuple(windows)


def _stride_windows(
    links: LinkMomenta, log: Log, stride: Stride, number: int
) -> list[tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]]:
    """Return features, torques, stride and phase of the windows of each actuated joint."""
    t, q, dq = stride.t, stride.q, stride.dq
    tau = log.tau[np.searchsorted(log.t, t)]
    momenta, forces = _momenta_and_forces(links, q, dq)
    starts = _starts(stride)
    # Rows by windows: weights of rows, of their slopes, and of the torque from a row to the next.
    area = 0.5 * (np.diff(t, append=t[-1]) + np.diff(t, prepend=t[0]))
    weight, slope = _weights(t, starts)
    mean_rates = np.append(np.diff(t), 0.0) * _weights(t + 0.5 * stride.period_s, starts)[0]
    whole = 0.375 * WINDOW_S  # Integral of the weight.
    inside = (t >= starts[:, None]) & (t <= starts[:, None] + WINDOW_S)
    windows = []
    fewest_rows = 8  # Least number of rows in a window, for its integrals.
    for j in range(q.shape[1] - 1):
        rate = dq[:, 1 + j]
        slowest = np.min(np.where(inside, np.abs(rate), np.inf), axis=1, initial=np.inf)
        used = (slowest >= SLOWEST_RAD_S) & (np.count_nonzero(inside, axis=1) >= fewest_rows)
        by_slope, by_weight = slope[used] * area, weight[used] * area
        rotor, late = -by_slope @ rate, -by_slope @ tau[:, j]
        features = [rotor, by_weight @ np.sign(rate), by_weight @ rate, late]
        torque = by_weight @ forces[:, j] + by_slope @ momenta[:, j] + mean_rates[used] @ tau[:, j]
        # A joint of the stance leg and of the swing leg move differently.
        phase = 2 * np.flatnonzero(used) + int(j >= q.shape[1] // 2)
        column = np.full(len(phase), number)
        windows.append((np.column_stack(features) / whole, torque / whole, column, phase))
    return windows


def _starts(stride: Stride) -> Float[np.ndarray, " w"]:
    """Return the times at which windows start that have no gap [s]."""
    t = stride.t
    slack = 0.5 * stride.period_s
    every_s = 0.02  # Time from the start of one window to that of the next [s].
    starts = np.arange(t[0], t[-1] - WINDOW_S + slack, every_s)
    first = np.searchsorted(t, starts - slack)
    last = np.clip(np.searchsorted(t, starts + WINDOW_S + slack) - 1, 0, len(t) - 1)
    return starts[stride.piece[first] == stride.piece[last]]


def _weights(
    t: Float[np.ndarray, " k"], starts: Float[np.ndarray, " w"]
) -> tuple[Float[np.ndarray, "w k"], Float[np.ndarray, "w k"]]:
    """Return sin^4 over each window, which is 0 outside, and its slope [1/s].

    Three derivatives vanish at its ends, so that sums over rows are accurate as integrals.
    """
    share = np.clip((t - starts[:, None]) / WINDOW_S, 0.0, 1.0)
    sine, cosine = np.sin(np.pi * share), np.cos(np.pi * share)
    return sine**4, 4.0 * np.pi / WINDOW_S * sine**3 * cosine


@in_blocks_of(4096)
def _momenta_and_forces(
    links: LinkMomenta, q: Float[Array, "k n"], dq: Float[Array, "k n"]
) -> tuple[Float[Array, "k m"], Float[Array, "k m"]]:
    """Return momenta and generalised forces dL/dq of the actuated joints, without rotors."""
    return jax.vmap(links)(q, dq)
