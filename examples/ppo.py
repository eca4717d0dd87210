"""Proximal policy optimisation on `neuralgaits/Biped-v0`, and what becomes of its policy in walks.

Needs the `gym` extra and stable-baselines3:

    pip install 'neuralgaits[gym]' stable-baselines3
    python examples/ppo.py --samples 400000 --seed 0

Prints, now and then while it learns, how episodes at one speed end; at the end the same at other
speeds and under each of the 18 disturbances of the package. `learned-SEED.json` has all of it and
the curve of learning. Nothing of the package's own policies is in it.
"""

import argparse
import json
import sys
import time
from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

try:
    import gymnasium
    import torch
    from stable_baselines3 import PPO
    from stable_baselines3.common.base_class import BaseAlgorithm
    from stable_baselines3.common.callbacks import BaseCallback
    from stable_baselines3.common.env_util import make_vec_env
    from stable_baselines3.common.vec_env import VecEnv, VecNormalize
except ImportError as error:
    print(
        f"expected Gymnasium, PyTorch and Stable-Baselines3, found that {error}: "
        "pip install 'neuralgaits[gym]' stable-baselines3",
        file=sys.stderr,
    )
    sys.exit(2)

from neuralgaits.gym_env import ID, BipedEnv, Trials, trials
from neuralgaits.simulation.setup.disturbance_set import DISTURBANCE_SET

SPEED = 0.7
"""Asked for in the trials [m/s]."""
SPEEDS = (0.5, 0.6, 0.7, 0.8, 0.9)
"""Asked for at the end [m/s]."""
DISTURBED_STEPS = 25
"""Of a trial under a disturbance."""
ENVIRONMENTS = 8
GAMMA = 0.99
SETTINGS = {
    "n_steps": 256,
    "batch_size": 64,
    "n_epochs": 10,
    "learning_rate": 5e-4,
    "gamma": GAMMA,
    "ent_coef": 0.0,
    "policy_kwargs": {"log_std_init": -2.0, "net_arch": [64, 64]},
}


def acting(model: BaseAlgorithm, scaled: VecNormalize) -> Callable[[np.ndarray], np.ndarray]:
    """The mean action."""
    return lambda seen: model.predict(scaled.normalize_obs(seen), deterministic=True)[0]


class Learning(BaseCallback):
    """The curve: episodes since the last policy, and every so many samples what trials say."""

    def __init__(self, scaled: VecNormalize, asked: argparse.Namespace):
        super().__init__()
        self._scaled, self._asked, self._next = scaled, asked, asked.every
        self._env = BipedEnv(speed=SPEED, action=asked.action)
        self._began, self._spent = time.process_time(), 0.0
        self.curve: list[dict[str, Any]] = []

    def _on_step(self) -> bool:
        return True

    def _on_rollout_end(self) -> None:
        paused = time.process_time()
        lengths = [episode["l"] for episode in self.model.ep_info_buffer or ()]
        point = {
            "samples": self.num_timesteps,
            "processor_s": paused - self._began - self._spent,
            "episode_decisions": float(np.mean(lengths)) if lengths else None,
        }
        if self.num_timesteps >= self._next:
            self._next += self._asked.every
            act = acting(self.model, self._scaled)
            asked = self._asked
            found = trials(self._env, act, speed=SPEED, steps=asked.steps, count=asked.trials)
            point |= {"walked": found.walked}
            said = f"{point['samples']:8d} samples, {point['processor_s']:6.0f} s of a processor"
            print(f"{said}: {found}", flush=True)
        self.curve.append(point)
        self._spent += time.process_time() - paused


class Kept(NamedTuple):
    """Files of one seed."""

    policy: Path
    scales: Path
    """Of what it observes."""
    found: Path
    """What was asked, the curve of learning, and all trials at its end."""


def learned(
    made: VecEnv, asked: argparse.Namespace, kept: Kept
) -> tuple[BaseAlgorithm, VecNormalize, list[dict[str, Any]]]:
    """A policy, the scales of what it observes, and the curve. The first two are kept."""
    envs = VecNormalize(made, gamma=GAMMA)
    model = PPO("MlpPolicy", envs, **SETTINGS, seed=asked.seed, device="cpu")
    learning = Learning(envs, asked)
    model.learn(asked.samples, callback=learning)
    model.save(kept.policy)
    envs.save(str(kept.scales))
    return model, envs, learning.curve


def main() -> None:
    """Learn, then try the policy."""
    parser = argparse.ArgumentParser(description="PPO on neuralgaits/Biped-v0")
    parser.add_argument(
        "--samples", type=int, default=400_000, help="0 tries the policy that is kept"
    )
    parser.add_argument("--every", type=int, default=20_000, help="samples between trials")
    parser.add_argument("--steps", type=int, default=50, help="steps that a trial has to walk")
    parser.add_argument("--trials", type=int, default=4, help="episodes of each kind")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument(
        "--action", default="target", choices=("target", "torque"), help="of a policy to be learned"
    )
    parser.add_argument("--out", type=Path, default=Path("runs/ppo"))
    asked = parser.parse_args()
    for name, least in (("samples", 0), ("every", 1), ("steps", 1), ("trials", 1), ("seed", 0)):
        if getattr(asked, name) < least:
            parser.error(f"expected --{name} of {least} or more, found {getattr(asked, name)}")
    names = f"policy-{asked.seed}.zip", f"scales-{asked.seed}.pkl", f"learned-{asked.seed}.json"
    kept = Kept(*(asked.out / name for name in names))
    before: dict[str, Any] = {}
    if not asked.samples:
        for file in kept:
            if not file.is_file():
                parser.error(f"expected the policy to try, found no {file}: learn with --samples")
        before = json.loads(kept.found.read_text())
    settings = before.get("asked", {"samples": asked.samples, "action": asked.action})
    torch.set_num_threads(1)
    asked.out.mkdir(parents=True, exist_ok=True)
    action = asked.action = settings["action"]
    made = make_vec_env(lambda: gymnasium.make(ID, action=action), ENVIRONMENTS, seed=asked.seed)
    if before:
        model = PPO.load(kept.policy, device="cpu")
        envs = VecNormalize.load(str(kept.scales), made)
        curve = before["curve"]
    else:
        model, envs, curve = learned(made, asked, kept)
    act = acting(model, envs)

    def tried(name: str, speed: float, steps: int, **plant: Any) -> Trials:
        env = BipedEnv(action=action, **plant)
        found = trials(env, act, speed=speed, steps=steps, count=asked.trials)
        print(f"{name:28s} {found}", flush=True)
        return found

    speeds = {v: asdict(tried(f"{v:g} m/s", v, asked.steps)) for v in SPEEDS}
    disturbed = {
        name: asdict(tried(name, SPEED, DISTURBED_STEPS, disturb=disturbance))
        for name, disturbance in DISTURBANCE_SET.items()
    }
    found = {"seed": asked.seed, "asked": settings | {"trials": asked.trials}, "curve": curve}
    kept.found.write_text(json.dumps(found | {"speeds": speeds, "disturbed": disturbed}))


if __name__ == "__main__":
    main()
