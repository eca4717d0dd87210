"""Trial walks of a policy: any function from observations to actions."""

from collections.abc import Callable
from dataclasses import dataclass

import gymnasium
import numpy as np

from neuralgaits._printable import shown
from neuralgaits.errors import InputError
from neuralgaits.gym_env.biped_env import BipedEnv

LONGEST_S = 30.0
"""Time limit of a trial [s]; one that has not walked its steps by then counts as not walked."""


@dataclass(frozen=True)
class Trials:
    """Episodes of one policy at one speed.

    Attributes:
        steps: number that each had to walk.
        walked: touchdowns in each, at most `steps`. [B]
        up_s: how long each stayed up [s]. [B]
        endings: why each fell; None if it walked its steps or ran out of time. [B]
        speed_m_s: mean speed of those that walked their steps [m/s]; None if none did.
        cost_of_transport: mean mechanical cost of the same walks [1]; None if none did.
    """

    steps: int
    walked: tuple[int, ...]
    up_s: tuple[float, ...]
    endings: tuple[str | None, ...]
    speed_m_s: float | None
    cost_of_transport: float | None

    @property
    def done(self) -> int:
        """Return how many trials walked all their steps."""
        return sum(count >= self.steps for count in self.walked)

    def __str__(self) -> str:
        """Summarise the trials in one line."""
        text = f"{self.done} of {len(self.walked)} walked {self.steps} steps, "
        text += f"up {np.mean(self.up_s):.1f} s on average"
        if self.speed_m_s is not None and self.cost_of_transport is not None:
            text += f", {self.speed_m_s:.2f} m/s, cost of transport {self.cost_of_transport:.3f}"
        return text


def trials(
    env: BipedEnv,
    act: Callable[[np.ndarray], np.ndarray],
    *,
    speed: float,
    steps: int = 50,
    count: int = 10,
) -> Trials:
    """Let a policy walk from the random starts of seeds 0 to `count` - 1.

    Args:
        env: environment without a time limit, as the class makes it.
        act: function from an observation to an action, see `BipedEnv`.
        speed: commanded speed (m/s).
        steps: number of touchdowns to walk.
        count: number of episodes.

    Raises: InputError for fewer than one step or episode.
    """
    for name, number in (("steps", steps), ("count", count)):
        whole = isinstance(number, int | np.integer) and not isinstance(number, bool)
        if not whole or number < 1:
            raise InputError(
                f"{name}: expected a whole number of at least 1, found {shown(number)}"
            )
    wrapped = isinstance(env, gymnasium.Env) and not isinstance(env, BipedEnv)
    if wrapped or not hasattr(env, "step"):
        raise InputError(
            f"env: expected a BipedEnv, found {shown(env)}: give `env.unwrapped` of a wrapped one"
        )
    if not callable(act):
        raise InputError(f"act: expected a function of an observation, found {shown(act)}")
    distances, up, endings, speeds, costs = [], [], [], [], []
    for seed in range(count):
        observation, info = env.reset(seed=seed, options={"speed": speed})
        body, start = env.body, env.body.hip[0]
        while info["steps"] < steps and body.data.time < LONGEST_S:
            observation, _, fell, _, info = env.step(act(observation))
            if fell:
                break
        # A fall in the decision of the last touchdown is a fall.
        fell = info["ending"] is not None
        distances.append(min(info["steps"], steps - 1 if fell else steps))
        up.append(float(body.data.time))
        endings.append(info["ending"])
        if distances[-1] == steps:
            distance = float(body.hip[0] - start)
            speeds.append(distance / up[-1])
            costs.append(body.work / (body.weight * distance))
    return Trials(
        steps=steps,
        walked=tuple(distances),
        up_s=tuple(up),
        endings=tuple(endings),
        speed_m_s=float(np.mean(speeds)) if speeds else None,
        cost_of_transport=float(np.mean(costs)) if costs else None,
    )
