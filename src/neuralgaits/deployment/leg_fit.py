"""Fit signs and zeros of a leg's joints to a log, by the torques that its motion takes.

The residual is tau - (rotors + sum_b s_b links_b + c sign(dq) + v dq), least squares in the zeros'
errors and, with priors, in what a robot's file does not know: factors s of the masses, dry friction
c and viscous friction v. A flipped joint has angle and torque of the other sign, so the file's own
signs explain a log worse than the right ones do, wherever gravity or another joint acts on it.
"""

from dataclasses import dataclass
from itertools import product

import numpy as np
from scipy.ndimage import minimum_filter1d
from scipy.signal import savgol_filter

from neuralgaits._types import Float
from neuralgaits.deployment.hanging_leg import HangingLeg

ZERO_PRIOR, KNOWN_ZERO = 0.5, 0.03
"""Standard deviations of a zero's error before torques are looked at: if nothing is known of it,
and if the log has rows that show it [rad]."""


@dataclass(frozen=True, eq=False)
class LegSeries:
    """Motion and torques of a leg in a log, in the robot file's signs by the deployment file.

    Attributes:
        q, dq, ddq: joints, lowest first [rad], [rad/s], [rad/s^2]. [t, k]
        torque: torques on the joints [N m]. [t, k]
        pitch: pitch of the root [rad]. [t]
    """

    q: Float[np.ndarray, "t k"]
    dq: Float[np.ndarray, "t k"]
    ddq: Float[np.ndarray, "t k"]
    torque: Float[np.ndarray, "t k"]
    pitch: Float[np.ndarray, " t"]

    @classmethod
    def smoothed(
        cls,
        time: Float[np.ndarray, " t"],
        q: Float[np.ndarray, "t k"],
        torque: Float[np.ndarray, "t k"],
        pitch: Float[np.ndarray, " t"],
        driven: Float[np.ndarray, " t"],
    ) -> "LegSeries":
        """Return a leg's series with rates and accelerations, at 25 rows a second.

        Angles and torques pass the same filter, so that their relation stays.

        Args:
            time: time of each row [s].
            q: joints [rad].
            torque: torques on them [N m].
            pitch: pitch of the root [rad].
            driven: 1 where nothing but the drives acts on the leg; other rows are left out.
        """
        step = float(np.median(np.diff(time)))
        even = np.arange(time[0], time[-1], step)
        columns = np.column_stack([q, torque, pitch, driven])
        *rows, alone = (np.interp(even, time, column) for column in columns.T)
        data = np.column_stack(rows)
        window_s = 0.2  # Of the cubic that smooths angles and torques.
        window = max(5, 2 * round(window_s / step / 2.0) + 1)
        k = q.shape[1]
        if len(even) < 3 * window:
            none = np.zeros((0, k))
            return cls(none, none, none, none, np.zeros(0))
        # Rows that are fitted, a second: further ones say nothing more after smoothing.
        rows_hz = 25.0
        every = slice(window, len(even) - window, max(1, round(1.0 / rows_hz / step)))

        def filtered(order: int) -> Float[np.ndarray, "t c"]:
            smooth = savgol_filter(data, window, 3, deriv=order, delta=step, axis=0)
            return np.asarray(smooth)[every]

        steady = minimum_filter1d(alone, window)[every] > 0.999
        values, rates, bends = (filtered(order)[steady] for order in range(3))
        return cls(values[:, :k], rates[:, :k], bends[:, :k], values[:, k:-1], values[:, -1])


@dataclass(frozen=True, eq=False)
class LegFit:
    """Signs and zeros that explain a leg's log, and how well.

    Attributes:
        flips: 1, or -1 for a joint whose angle and torque have the other sign. [k]
        torque_flips: 1, or -1 for a joint whose torque alone has. [k]
        zeros: error of each zero: what is to be added to the joint's angle [rad]. [k]
        spread: their standard deviations [rad]. [k]
        cost: sum of squares of the residual and of the priors.
        unexplained: root mean square of the residual, a share of the torque's. [k]
    """

    flips: np.ndarray
    torque_flips: np.ndarray
    zeros: Float[np.ndarray, " k"]
    spread: Float[np.ndarray, " k"]
    cost: float
    unexplained: Float[np.ndarray, " k"]


@dataclass(frozen=True, eq=False)
class LegFitter:
    """Fit of one leg.

    Attributes:
        leg: its model.
        signs, offsets: from the file's joints to the theory's. [k]
        pitch_sign: sign of the file's pitch.
        lower, upper: ranges of the joints in the robot file [rad]. [k]
        limit: torque limits [N m]. [k]
        prior: standard deviations of the zeros' errors before torques are looked at [rad]. [k]
        settled: joints whose sign is known. bool [k]
    """

    leg: HangingLeg
    signs: Float[np.ndarray, " k"]
    offsets: Float[np.ndarray, " k"]
    pitch_sign: float
    lower: Float[np.ndarray, " k"]
    upper: Float[np.ndarray, " k"]
    limit: Float[np.ndarray, " k"]
    prior: Float[np.ndarray, " k"]
    settled: np.ndarray

    def fits(self, series: LegSeries, pitch_flip: float) -> list[LegFit]:
        """Return the fit of every choice of signs, the file's own first."""
        ways = [(1.0,) if settled else (1.0, -1.0) for settled in self.settled]
        return [self._fit(series, np.array(flips), pitch_flip) for flips in product(*ways)]

    def _fit(self, series: LegSeries, flips: np.ndarray, pitch_flip: float) -> LegFit:
        """Fit zeros and nuisance by Gauss-Newton, at given signs of angles."""
        k = len(flips)
        to_theory = self.signs * flips
        noise = 0.05 * np.sqrt(np.mean(series.torque**2, axis=0)) + 0.001 * self.limit
        # At rest dry friction takes any value between its bounds.
        resting = 1.0 - np.abs(np.tanh(series.dq / 0.05))
        noise = noise + 0.02 * self.limit * resting
        zeros = np.zeros(k)
        torque = to_theory * series.torque
        turns = np.ones(k)
        solved = np.zeros(4 * k)
        covariance = np.eye(4 * k)
        # Standard deviation of the factors of masses.
        prior = np.concatenate([self.prior, np.full(k, 0.15), 0.02 * self.limit, 0.02 * self.limit])
        residual = torque
        for turn in range(5):
            plain, links = self._torques(series, flips, zeros, pitch_flip)
            model = plain + links.sum(-1)
            if turn < 2:
                turns = self._torque_signs(torque, model)
            slopes = self._slopes(series, flips, zeros, pitch_flip, model)
            dq = to_theory * series.dq
            own = np.eye(k)
            columns = np.concatenate(
                [
                    slopes,
                    links,
                    np.tanh(dq / 0.05)[:, :, None] * own,
                    dq[:, :, None] * own,
                ],
                axis=2,
            )
            away = (turns * torque - model) / noise
            rows = (columns / noise[:, :, None]).reshape(-1, 4 * k)
            # The zeros' prior is about the whole error, not about its last change.
            target = np.concatenate([-zeros, np.zeros(3 * k)]) / prior
            whole = np.concatenate([rows, np.diag(1.0 / prior)])
            solved = np.linalg.lstsq(whole, np.concatenate([away.ravel(), target]), rcond=None)[0]
            zeros = zeros + np.clip(solved[:k], -0.5, 0.5)
            residual = (away.ravel() - rows @ solved).reshape(-1, k)
            covariance = np.linalg.inv(whole.T @ whole)
        scale = max(1.0, float(np.mean(residual**2)))
        q = flips * series.q + zeros
        beyond = np.maximum(np.maximum(self.lower - q, q - self.upper), 0.0) / 0.03
        penalty = np.sum(solved[k:] ** 2 / prior[k:] ** 2) + np.sum(zeros**2 / self.prior**2)
        power = np.sqrt(np.mean(series.torque**2, axis=0)) + 1e-9
        return LegFit(
            flips=flips,
            torque_flips=turns,
            zeros=zeros,
            spread=np.sqrt(np.diag(covariance)[:k] * scale),
            cost=float(np.sum(residual**2) + penalty + np.sum(np.minimum(beyond, 5.0) ** 2)),
            unexplained=np.sqrt(np.mean((residual * noise) ** 2, axis=0)) / power,
        )

    def _torques(
        self, series: LegSeries, flips: np.ndarray, zeros: np.ndarray, pitch_flip: float
    ) -> tuple[Float[np.ndarray, "t k"], Float[np.ndarray, "t k k"]]:
        """Return the model's torques in the theory's signs, see `HangingLeg.torques`."""
        q = self.signs * (flips * series.q + zeros) + self.offsets
        signs = self.signs * flips
        torso = self.pitch_sign * pitch_flip * series.pitch
        return self.leg.torques(torso, q, signs * series.dq, signs * series.ddq)

    def _slopes(
        self,
        series: LegSeries,
        flips: np.ndarray,
        zeros: np.ndarray,
        pitch_flip: float,
        model: Float[np.ndarray, "t k"],
    ) -> Float[np.ndarray, "t k k"]:
        """Return the derivatives of the torques by the zeros' errors. [t, joints, zeros]."""
        step = 1e-4
        slopes = []
        for j in range(len(zeros)):
            shifted = zeros + step * np.eye(len(zeros))[j]
            plain, links = self._torques(series, flips, shifted, pitch_flip)
            slopes.append((plain + links.sum(-1) - model) / step)
        return np.stack(slopes, axis=2)

    @staticmethod
    def _torque_signs(torque: np.ndarray, model: np.ndarray) -> np.ndarray:
        """Return -1 for joints whose torque goes against the model's. [k]."""
        return np.where(np.sum(torque * model, axis=0) < 0.0, -1.0, 1.0)
