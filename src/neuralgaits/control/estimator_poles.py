"""How quickly estimates of rates follow their readings; `estimator` says by which filters."""

from dataclasses import dataclass

import numpy as np

from neuralgaits._types import Float


@dataclass(frozen=True)
class Estimator:
    """Poles of the filters, all real and equal: how quickly estimates follow readings.

    Attributes:
        joints: pole of a joint's filter [rad/s]. Encoders of 14 bits leave rates rms errors of
            0.02 rad/s; at 150 rad/s and with torques 2 ms late, joints under `pd` begin to
            chatter.
        quick: pole of a joint's filter just after a touchdown [rad/s].
        quick_s: duration of the quicker filter [s]: soft contacts take 4 ms.
        pitch: pole for the stance leg's absolute angle [rad/s]: well above the pendulum's own
            pole, 4 rad/s, so that a wrong model matters little, and low enough for noise of some
            mrad.
    """

    joints: float = 250.0
    quick: float = 1000.0
    quick_s: float = 0.006
    pitch: float = 20.0

    def joint_gains(self, period_s: float) -> Float[np.ndarray, "2 3"]:
        """Return the gains of a joint's filter: usual, and just after a touchdown.

        Each row has the gains of angle [1], rate [1/s] and acceleration [1/s^2] on the angle's
        error.
        """
        keep = np.exp(-self.joints * period_s)
        lost = 1.0 - keep
        rate = 1.5 * lost**2 * (1.0 + keep) / period_s
        usual = [1.0 - keep**3, rate, lost**3 / period_s**2]
        return np.array([usual, [*_line_gains(self.quick, period_s), 0.0]])

    def pitch_gains(self, period_s: float) -> Float[np.ndarray, "2"]:
        """Return the gains of the angle [1] and its rate [1/s] on the error of the pitch."""
        return np.array(_line_gains(self.pitch, period_s))


def _line_gains(pole: float, period_s: float) -> tuple[float, float]:
    """Return the gains of a filter of first degree, of a value [1] and its rate [1/s]."""
    keep = np.exp(-pole * period_s)
    return 1.0 - keep**2, (1.0 - keep) ** 2 / period_s
