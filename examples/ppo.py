"""Proximal policy optimisation on `neuralgaits/Biped-v0`, and what becomes of its policy in walks.

Needs the `gym` extra and stable-baselines3:

    pip install 'neuralgaits[gym]' stable-baselines3
    python examples/ppo.py --samples 400000 --seed 0

Prints, now and then while it learns, how ten episodes at one speed end, and at the end the same
under each of the 18 disturbances of the package. Nothing of the package's own policies is in it.
"""

import argparse
import time
from pathlib import Path

import gymnasium
import numpy as np
import torch
from stable_baselines3 import PPO
from stable_baselines3.common.base_class import BaseAlgorithm
from stable_baselines3.common.callbacks import BaseCallback
from stable_baselines3.common.env_util import make_vec_env
from stable_baselines3.common.vec_env import VecEnv, VecNormalize

from neuralgaits.gym_env import ID, BipedEnv
from neuralgaits.simulation.setup.disturbance_set import DISTURBANCE_SET

SPEED = 0.7
"""Asked for in the trials [m/s]."""
TRIALS = 10
LONGEST = 1500
"""Decisions of a trial: 30 s."""
ENVIRONMENTS = 8


def trials(
    model: BaseAlgorithm, scaled: VecNormalize, env: BipedEnv, steps: int
) -> dict[str, float]:
    """Ten episodes of the mean action.

    Returns: how many had `steps` steps without a fall, and of those the mean speed (m/s) and cost
    of transport, mechanical; how long all of them were up on average (s), 30 s at most.
    """
    done, speeds, costs, times = 0, [], [], []
    for seed in range(TRIALS):
        seen, info = env.reset(seed=seed, options={"speed": SPEED})
        begun = env.body.hip[0]
        for _ in range(LONGEST):
            action, _ = model.predict(scaled.normalize_obs(seen), deterministic=True)
            seen, _, fell, _, info = env.step(action)
            if fell or info["steps"] >= steps:
                break
        times.append(env.body.data.time)
        if info["steps"] >= steps and info["ending"] is None:
            distance, body = env.body.hip[0] - begun, env.body
            done += 1
            speeds.append(distance / body.data.time)
            weight = env.body.weight
            costs.append(body.work / (weight * distance))
    return {"walked": done, "speed": _mean(speeds), "cost": _mean(costs), "up": _mean(times)}


def _mean(values: list[float]) -> float:
    return float(np.mean(values)) if values else float("nan")


def words(found: dict[str, float], steps: int) -> str:
    """Trials in a line."""
    text = f"{found['walked']} of {TRIALS} walked {steps} steps, up {found['up']:.1f} s on average"
    if found["walked"]:
        text += f", {found['speed']:.2f} m/s, cost of transport {found['cost']:.3f}"
    return text


def save(model: BaseAlgorithm, scaled: VecNormalize, out: Path, seed: int) -> None:
    """Keep a policy and the scales of what it observes."""
    out.mkdir(parents=True, exist_ok=True)
    model.save(out / f"policy-{seed}.zip")
    scaled.save(str(out / f"scales-{seed}.pkl"))


class Trials(BaseCallback):
    """Prints what trials say, and keeps the policy, every so many samples."""

    def __init__(self, scaled: VecNormalize, asked: argparse.Namespace):
        super().__init__()
        self._scaled, self._asked, self._next = scaled, asked, asked.every
        self._env = BipedEnv(speed=SPEED, action=asked.action)
        self._began, self._spent = time.process_time(), 0.0

    def _on_step(self) -> bool:
        if self.num_timesteps >= self._next:
            self._next += self._asked.every
            paused = time.process_time()
            found = trials(self.model, self._scaled, self._env, self._asked.steps)
            learned = paused - self._began - self._spent
            save(self.model, self._scaled, self._asked.out, self._asked.seed)
            self._spent += time.process_time() - paused
            what = words(found, self._asked.steps)
            print(
                f"{self.num_timesteps:8d} samples, {learned:6.0f} s of a processor: {what}",
                flush=True,
            )
        return True


def learned(made: VecEnv, asked: argparse.Namespace) -> tuple[BaseAlgorithm, VecNormalize]:
    """A policy, and the scales of what it observes. Both are kept."""
    envs = VecNormalize(made)
    model = PPO(
        "MlpPolicy",
        envs,
        n_steps=512,
        batch_size=256,
        learning_rate=3e-4,
        gamma=0.98,
        ent_coef=0.0,
        policy_kwargs={"log_std_init": -1.5},
        seed=asked.seed,
        device="cpu",
    )
    model.learn(asked.samples, callback=Trials(envs, asked))
    save(model, envs, asked.out, asked.seed)
    return model, envs


def main() -> None:
    """Learn, then try the policy."""
    parser = argparse.ArgumentParser(description="PPO on neuralgaits/Biped-v0")
    parser.add_argument(
        "--samples", type=int, default=400_000, help="0 tries the policy that is kept"
    )
    parser.add_argument("--every", type=int, default=50_000)
    parser.add_argument("--steps", type=int, default=50, help="steps that a trial has to walk")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--action", default="target", choices=("target", "torque"))
    parser.add_argument("--out", type=Path, default=Path("runs/ppo"))
    asked = parser.parse_args()
    torch.set_num_threads(1)
    made = make_vec_env(
        lambda: gymnasium.make(ID, action=asked.action), ENVIRONMENTS, seed=asked.seed
    )
    if asked.samples:
        model, envs = learned(made, asked)
    else:
        model = PPO.load(asked.out / f"policy-{asked.seed}.zip", device="cpu")
        envs = VecNormalize.load(str(asked.out / f"scales-{asked.seed}.pkl"), made)
    for name, disturbance in {"none": None, **DISTURBANCE_SET}.items():
        env = BipedEnv(speed=SPEED, disturb=disturbance, action=asked.action)
        found = trials(model, envs, env, asked.steps)
        print(f"{name:28s} {words(found, asked.steps)}", flush=True)


if __name__ == "__main__":
    main()
