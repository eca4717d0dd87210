"""The biped as a Gymnasium environment. Importing this registers `neuralgaits/Biped-v0`.

It needs the `gym` extra. Plant, disturbances, pushes, floors and falls are those of `simulate`;
what is learned in it is up to the user. This package knows no gaits and no barrier conditions.
"""

from importlib.util import find_spec

from neuralgaits.errors import InputError

if find_spec("gymnasium") is None:
    raise InputError(
        "gym_env needs gymnasium, which is not installed: pip install 'neuralgaits[gym]'"
    )

from gymnasium.envs.registration import register, registry

from neuralgaits.gym_env.biped_env import BipedEnv
from neuralgaits.gym_env.reward import Reward
from neuralgaits.gym_env.trials import Trials, trials

__all__ = ["ID", "BipedEnv", "Reward", "Trials", "trials"]

ID = "neuralgaits/Biped-v0"
EPISODE_STEPS = 500
"""Decisions of an episode that does not end in a fall: 10 s."""

if ID not in registry:
    register(
        ID, entry_point="neuralgaits.gym_env.biped_env:BipedEnv", max_episode_steps=EPISODE_STEPS
    )
