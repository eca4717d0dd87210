"""Constants of the disturbed theorem, found by looking at points. Nothing here is trusted."""

import numpy as np

from neuralgaits._digits import at_least
from neuralgaits.certificate.levels.disturbed.conclude import factor, inequalities
from neuralgaits.certificate.levels.disturbed.theorem import Disturbed, DisturbedBarrier
from neuralgaits.certificate.levels.full_order.find import Looks, grid
from neuralgaits.certificate.levels.full_order.inequalities import obstacle
from neuralgaits.certificate.levels.full_order.norm import GAINS
from neuralgaits.certificate.levels.full_order.theorem import FullOrder, lyapunov_rate

HALVINGS = 20
"""Of the interval in which the largest push is."""
BELOW_FLOOR = 1.0 - 1e-9
"""Share of the push that the floor bears which is asked for at most."""
DIGITS = 4
"""Of the push: it stands, exactly, in a statement that people read."""
SQUARES = 1.12
"""|d(dh/dt)/d xi|^2 in the set, over what was seen at eta = 0."""
SPENT = 0.05
"""Share of dh/dt + alpha h that bounds may lose, and of forces that outputs may take more."""


def find_disturbed(looks: Looks, full: FullOrder) -> Disturbed | str:
    """The largest push that points allow in the set, or one sentence that says why there is none.

    Args:
        looks: at quantities of the gait, in the set's norm.
        full: the set.
    """
    if full.least_radius <= 0.0:
        return (
            "the set of level 4 shrinks to nothing along the step, so that no disturbance leaves "
            "outputs inside it: no set with a floor was found for this gait"
        )
    u = grid(np.linspace(*full.ends, 61), np.linspace(0.0, 1.0, 9))
    seen = _Seen(looks, full, u)
    most = (
        BELOW_FLOOR * float(lyapunov_rate(full.bandwidth)) * full.least_radius / (2.0 * seen.factor)
    )
    low, high = 0.0, most
    if seen.barriers(most) is not None:
        low = most
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if seen.barriers(middle) is not None else (low, middle)
    low = float(at_least(low, DIGITS))
    barriers = seen.barriers(low) if low > 0.0 else None
    if barriers is None:
        return "a barrier leaves no room for any disturbance"
    shape = Disturbed(low, barriers)
    broken = [obstacle(step) for step in inequalities(full, shape) if not step.holds]
    return "; ".join(broken) if broken else shape


class _Seen:
    """What a push does to barriers, contact and torques at points."""

    def __init__(self, looks: Looks, full: FullOrder, u: np.ndarray):
        self.full, self.gamma = full, float(lyapunov_rate(full.bandwidth))
        self.factor = float(factor(full).upper())
        step = looks.step(u, np.zeros((len(u), looks.size)))
        self.rate, self.h = step["rate"], step["h"]
        self.squares = SQUARES * (step["rate/slope"] ** 2).sum(axis=2)
        assert looks.pushed is not None
        off = looks.pushed(u)
        bound = full.least_radius + (full.radius - full.least_radius) * np.exp(
            -full.shrink * u[:, 0] ** 2
        )
        self.room = np.inf
        for name in ("contact", "torque"):
            taken = (1.0 + SPENT) * bound[:, None] * np.linalg.norm(step[f"{name}/slope"], axis=2)
            left = step[name] - taken
            self.room = min(self.room, (left / np.linalg.norm(off[f"{name}/push"], axis=2)).min())

    def barriers(self, push: float) -> tuple[DisturbedBarrier, ...] | None:
        """Constants of each barrier, None if one of them or forces leave no room."""
        if (1.0 + SPENT) * push >= self.room:
            return None
        found = tuple(self._barrier(k, push) for k in range(len(self.full.barriers)))
        return None if None in found else found  # pyright: ignore[reportReturnType]

    def _barrier(self, k: int, push: float) -> DisturbedBarrier | None:
        of, best = self.full.barriers[k], (0.0, None)
        tight = of.reading**2 / (4.0 * of.sigma)
        moved = 2.0 * of.sigma * self.factor * push
        for alpha in (a for a in GAINS if a < self.gamma):
            rest = 4.0 * of.sigma * (self.gamma - alpha)
            value = self.rate[:, k] + alpha * self.h[:, k]
            value = value - SPENT * np.abs(value)
            for split in (0.1, 0.2, 0.4, 0.7, 1.0, 1.5, 2.5, 5.0):
                weight = (1.0 + split) / rest
                # A little more than is needed: the conclusion rounds against it.
                lost = alpha * tight + (1.0 + 1.0 / split) * moved**2 / rest
                lost = lost * (1.0 + 1e-9) + 1e-12
                room = float((value - weight * self.squares[:, k]).min() - lost)
                if room > best[0]:
                    name, gain = of.name, float(alpha)
                    best = room, DisturbedBarrier(name, gain, float(weight), float(lost))
        return best[1]
