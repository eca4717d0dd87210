"""Evaluations of a gait at points, which choose the constants of the full-order theorem."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from neuralgaits._types import Float
from neuralgaits.certificate.levels.full_order.model_samples import ModelSamples, effects_in_norm

Samples = Mapping[str, np.ndarray]
SampleEvaluator = Callable[[Float[np.ndarray, "n 2"], Float[np.ndarray, "n k"]], Samples]
"""Chart points [n, 2] and xi [n, 2m] to quantities [n, k] and their slopes in xi [n, k, 2m]."""


@dataclass(frozen=True)
class SampleEvaluators:
    """Functions that the finder of the full-order theorem evaluates.

    Attributes:
        step: pace, inertia, foot, foot-rate, contact, torque, rate, reading, h, with slopes.
        guard: foot, after, landing, reset, with slopes along the guard;
            fall, foot/slope: those of the foot height in phase and xi; drift: of after in phase.
        size: number of elements of xi.
        pushed: de/dt under held torques with slopes, that in a push less 2 w; slopes of contact and
            torque in a push; law: error of the law's own torque, with its slope.
        kick: error right after an impact under the torque from before it, and its slopes in xi and
            in a push.
        sensed: slopes in (q, dq) of the error of a constant torque [n, m, 2n], its own in that
            error [n, m, 2n, m], of phase and level [n, 2, 2n] and of xi [n, 2m, 2n].
        model: effects of links that are not the file's, see `sampled_effects`.
        landed: effects of these in an impact, see `sampled_impacts`.
    """

    step: SampleEvaluator
    guard: SampleEvaluator
    size: int
    pushed: Callable[[Float[np.ndarray, "n 2"]], Samples] | None = None
    kick: SampleEvaluator | None = None
    sensed: Callable[[Float[np.ndarray, "n 2"]], Samples] | None = None
    model: SampleEvaluator | None = None
    landed: SampleEvaluator | None = None

    def in_norm(self, matrix: np.ndarray) -> "SampleEvaluators":
        """Return these functions with xi and pushes in the norm of S."""
        inverse = np.linalg.inv(matrix)
        inverse_pair = doubled(inverse)
        pushed, kick, sensed = self.pushed, self.kick, self.sensed
        effects, landed = self.model, self.landed

        def converted(evaluator: SampleEvaluator) -> SampleEvaluator:
            return lambda u, xi: converted_samples(evaluator(u, xi @ inverse_pair.T), matrix)

        def converted_pushed(u: Float[np.ndarray, "n 2"]) -> Samples:
            assert pushed is not None
            samples = dict(pushed(u))
            samples |= {n: d @ inverse for n, d in samples.items() if n.endswith("/push")}
            samples["jerk/slope"] = samples["jerk/slope"] @ inverse_pair
            samples["law/slope"] = samples["law/slope"] @ inverse_pair
            for name in ("jerk/slope", "jerk/push", "law/slope"):
                samples[name] = matrix @ samples[name]
            return samples | {name: samples[name] @ matrix.T for name in ("jerk", "law")}

        def converted_kick(u: Float[np.ndarray, "n 2"], xi: Float[np.ndarray, "n k"]) -> Samples:
            assert kick is not None
            samples = kick(u, xi @ inverse_pair.T)
            return {
                "kick": samples["kick"] @ matrix.T,
                "kick/slope": matrix @ samples["kick/slope"] @ inverse_pair,
                "kick/push": matrix @ samples["kick/push"] @ inverse,
            }

        def converted_sensed(u: Float[np.ndarray, "n 2"]) -> Samples:
            assert sensed is not None
            samples = sensed(u)
            growth = np.einsum("ij,njkl->nikl", matrix, samples["growth"]) @ np.linalg.inv(matrix)
            return {
                "chart": samples["chart"],
                "error": matrix @ samples["error"],
                "xi": doubled(matrix) @ samples["xi"],
                "growth": growth,
            }

        def converted_effects(u: Float[np.ndarray, "n 2"], xi: Float[np.ndarray, "n k"]) -> Samples:
            assert effects is not None
            return effects_in_norm(effects(u, xi @ inverse_pair.T), matrix)

        def converted_landed(u: Float[np.ndarray, "n 2"], xi: Float[np.ndarray, "n k"]) -> Samples:
            assert landed is not None
            return effects_in_norm(landed(u, xi @ inverse_pair.T), matrix)

        return replace(
            self,
            model=None if effects is None else converted_effects,
            landed=None if landed is None else converted_landed,
            step=converted(self.step),
            guard=converted(self.guard),
            pushed=None if pushed is None else converted_pushed,
            kick=None if kick is None else converted_kick,
            sensed=None if sensed is None else converted_sensed,
        )


class WithSlopes(NamedTuple):
    """A quantity at n points, or impacts, with its slopes.

    Attributes:
        value: the quantity. [n, k]
        in_xi: slope in the outputs xi. [n, k, 2m]
    """

    value: np.ndarray
    in_xi: np.ndarray


class WithPushSlopes(NamedTuple):
    """A quantity at n points, or impacts, with its slopes, that in a push among them.

    Attributes:
        value: the quantity. [n, k]
        in_xi: slope in the outputs xi. [n, k, 2m]
        in_push: slope in what changes the outputs' acceleration. [n, k, m]
    """

    value: np.ndarray
    in_xi: np.ndarray
    in_push: np.ndarray


@dataclass(frozen=True)
class GaitSamples:
    """Quantities at n points of the step and q impacts, with outputs in plain coordinates xi.

    Attributes:
        slack: slack of contact, torques and foot; a push is in the outputs' acceleration.
        rate: rate of each of the I barriers.
        h: value of each barrier. [n, I]
        reading: slope in xi of each barrier's reading. [n, I, 2m]
        jerk: de/dt while torques are held; a push is in e, and its slope less 2 w.
        law: error of the law's own torque.
        after, reset: slopes in xi of xi and barriers after an impact. [q, 2m, 2m], [q, I, 2m]
        inlet: least barriers after an impact. [I]
        phase: phases of the points. [n]
        pace: largest pace [1/s].
        inertia: d torque / d acceleration of the outputs, symmetric. [m, m]
        kick: error of the outputs' acceleration right after an impact under the torque from before
            it; a push is in that from before. None if there is a tick at each touchdown.
        sensed: what errors of the state, each as large as allowed, add to the outputs'
            acceleration. None for the true state. [n, m, 2n]
        model: effects of other robots than the file's; None for the file's.
    """

    slack: WithPushSlopes
    rate: WithSlopes
    h: np.ndarray
    reading: np.ndarray
    jerk: WithPushSlopes
    law: WithSlopes
    after: np.ndarray
    reset: np.ndarray
    inlet: np.ndarray
    phase: np.ndarray
    pace: float
    inertia: np.ndarray
    kick: WithPushSlopes | None = None
    sensed: np.ndarray | None = None
    model: ModelSamples | None = None


def sensed_errors(
    evaluators: SampleEvaluators, u: np.ndarray, state_error: tuple[float, float] | None
) -> np.ndarray | None:
    """Return what an error of each angle and rate alone adds to ddy [rad/s^2]. [n, m, 2n].

    None for the true state.
    """
    if state_error is None:
        return None
    assert evaluators.sensed is not None
    slopes = evaluators.sensed(u)["error"]
    return slopes * np.repeat(state_error, slopes.shape[2] // 2)


def model_samples(
    evaluators: SampleEvaluators,
    u: np.ndarray,
    impact: np.ndarray,
    box: tuple[float, float, float] | None,
) -> ModelSamples | None:
    """Return the effects of robots of a box at points of the step and at impacts.

    None for the file's robot.
    """
    if box is None:
        return None
    assert evaluators.model is not None and evaluators.landed is not None
    seen = evaluators.model(u, np.zeros((len(u), evaluators.size)))
    return ModelSamples.of(
        seen, evaluators.landed(impact, np.zeros((len(impact), evaluators.size))), box
    )


def doubled(matrix: np.ndarray) -> np.ndarray:
    """Apply a matrix to both halves of xi: return the block diagonal matrix."""
    return np.kron(np.eye(2), matrix)


def sphere(count: int, size: int, radius: float) -> np.ndarray:
    """Return points on the sphere of a radius. [count, size]."""
    draw = np.random.default_rng(0).normal(size=(count, size))
    return radius * draw / np.linalg.norm(draw, axis=1, keepdims=True)


def slope_norms(samples: Samples, name: str) -> np.ndarray:
    """Return the length of the slope of each element. [n, k]."""
    return np.linalg.norm(samples[f"{name}/slope"], axis=2)


def converted_samples(
    samples: Mapping[str, np.ndarray], matrix: np.ndarray
) -> dict[str, np.ndarray]:
    """Convert samples from plain coordinates to those of a norm; slopes are in S xi then."""
    pair, inverse_pair = doubled(matrix), doubled(np.linalg.inv(matrix))
    converted = dict(samples)
    for name in samples:
        if name.endswith("/slope"):
            converted[name] = samples[name] @ inverse_pair
    for name in ("after", "drift"):
        if name in samples:
            converted[name] = samples[name] @ pair.T
    if "after/slope" in samples:
        converted["after/slope"] = pair @ converted["after/slope"]
    return converted
