"""The reward of a decision: how well the hip follows the commanded speed, less the effort."""

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, fields

from neuralgaits._printable import shown
from neuralgaits.errors import InputError


@dataclass(frozen=True)
class Reward:
    """Weights of the parts of a reward; the reward of one decision is the sum of `parts`.

    Attributes:
        speed: weight of exp(-((v - command) / width)^2), v the mean forward speed of the hip.
        width: width of that term [m/s]. Within a walking step v swings by about 0.15 m/s.
        alive: reward for not having fallen.
        effort: weight of the mean of sum |torque rate|, in units of the robot's weight times 1 m/s.
        lean: weight of the squared angle of the torso [1/rad^2].
        change: weight of the mean squared change of the action since the last decision.
        fall: subtracted once, at a fall.
    """

    speed: float = 1.0
    width: float = 0.25
    alive: float = 0.2
    effort: float = 0.3
    lean: float = 0.5
    change: float = 0.02
    fall: float = 1.0

    def __post_init__(self):
        """Refuse weights that are negative or not finite, and a width of zero."""
        for field in fields(self):
            value = getattr(self, field.name)
            least = 1e-6 if field.name == "width" else 0.0
            if not (isinstance(value, int | float) and math.isfinite(value) and value >= least):
                raise InputError(
                    f"reward {field.name}: expected a finite number of at least {least:g}, "
                    f"found {value!r}"
                )

    def parts(
        self,
        *,
        speed: float,
        requested_speed: float,
        power: float,
        pitch: float,
        change: float,
        fell: bool,
    ) -> dict[str, float]:
        """Return each part of the reward of a decision, with its sign.

        Args:
            speed: mean forward speed of the hip (m/s).
            requested_speed: commanded speed (m/s).
            power: mechanical power in units of weight times 1 m/s.
            pitch: angle of the torso (rad).
            change: mean squared change of the action.
            fell: whether the decision ended in a fall.
        """
        miss = (speed - requested_speed) / self.width
        return {
            "speed": self.speed * math.exp(-miss * miss),
            "alive": 0.0 if fell else self.alive,
            "effort": -self.effort * power,
            "lean": -self.lean * pitch * pitch,
            "change": -self.change * change,
            "fall": -self.fall if fell else 0.0,
        }


def reward_of(reward: "Reward | dict[str, float] | None") -> Reward:
    """Build a reward from weights by name. Raises: InputError for a name that does not exist."""
    if isinstance(reward, Reward):
        return reward
    weights = asdict(Reward())
    if reward is not None and not isinstance(reward, Mapping):
        raise InputError(
            f"reward: expected weights of {', '.join(weights)} by name, found {shown(reward)}"
        )
    if stray := sorted(map(str, set(reward or {}) - set(weights))):
        raise InputError(f"reward: expected weights of {', '.join(weights)}, found {stray}")
    return Reward(**(reward or {}))
