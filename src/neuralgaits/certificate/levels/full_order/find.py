"""Find constants of the full-order theorem by evaluating points.

Nothing here is trusted: a bad choice makes a premise fail, not a false one hold.
"""

import math
from collections.abc import Sequence

import numpy as np

from neuralgaits._digits import at_least, at_most
from neuralgaits.certificate.level_target import grid
from neuralgaits.certificate.levels.full_order.norm_plans import Plan
from neuralgaits.certificate.levels.full_order.sampled_impacts import (
    CROSSINGS,
    MARGIN,
    SampledImpacts,
)
from neuralgaits.certificate.levels.full_order.samples import (
    SampleEvaluators,
    Samples,
    slope_norms,
)
from neuralgaits.certificate.levels.full_order.theorem import (
    BarrierConstants,
    FullOrderConstants,
    lyapunov_rate,
)

LEVELS = 9
"""Number of levels of the tube at which the gait is evaluated."""
CLEAR = 1e-12
"""Height of the foot before and behind the crossing [m]; it exceeds rounding errors."""
LARGEST = 0.1
"""Largest radius that is tried [rad]."""
DIGITS = 4
"""Significant digits of numbers that a statement gives exactly, for people to read."""
ALPHAS = (0.25, 0.5, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0, 12.0, 15.0, 20.0)
"""Barrier gains that are tried [1/s]."""


def find_full_order(
    evaluators: SampleEvaluators,
    names: Sequence[str],
    bandwidth: float,
    share: float,
    plan: Plan | None = None,
) -> FullOrderConstants | str:
    """Return constants of the theorem, or a sentence with the reason why there are none.

    Args:
        evaluators: functions that evaluate the gait.
        names: names of the barriers, in the order of their quantities.
        bandwidth: w [rad/s].
        share: share of the largest radius that forces, torques and foot allow at points.
        plan: norm, radius and floor, if these are given; the share is not used then.
    """
    evaluators = evaluators if plan is None else evaluators.in_norm(plan.matrix)
    levels = np.linspace(0.0, 1.0, LEVELS)
    u = grid(np.linspace(0.0, 1.0, 81), levels)
    samples = evaluators.step(u, np.zeros((len(u), evaluators.size)))
    gamma, crossing = float(lyapunov_rate(bandwidth)), _crossing(evaluators, levels)
    if (reason := _no_set(samples, gamma, bandwidth)) is not None:
        return reason
    if isinstance(crossing, str):
        return crossing
    limit, risen = _radius(samples, u[:, 0], gamma / (4.0 * MARGIN * samples["pace"].max()))
    radius = float(at_least(plan.radius if plan else min(share * limit, LARGEST), DIGITS))
    floor = float(at_most(plan.floor, DIGITS)) if plan else 0.0
    rate = plan.slower * gamma if plan else gamma
    most, shrink = _fastest(samples, u[:, 0], radius, floor, rate)
    strip = _guard_strip(evaluators, levels, crossing, _bound_at_phase(radius, floor, shrink, 0.98))
    if floor > 0.0 and strip is not None:
        # A disturbed set has the least room, and the strip is known now.
        most, shrink = _fastest(samples, u[:, 0], radius, floor, rate, 1.005 * (1.0 + strip))
    slowest = _over(samples, "pace", u[:, 0], -radius, -floor, shrink).min()
    if slowest <= 0.0 or strip is None:
        return "outputs off zero may stop the hip, or move the guard further than the tube goes on"
    guard_radius = _bound_at_phase(radius, floor, shrink, 1.0 - strip) * (1.0 + 1e-12)
    impacts = SampledImpacts.sample(evaluators, levels, crossing, strip, guard_radius, plan)
    start_strip = float(at_most(1.2 * impacts.landing_at(guard_radius), DIGITS))
    samples = _with_strips(samples, evaluators, levels, start_strip, strip)
    barriers = (_barrier(k, n, samples, impacts, gamma, radius, plan) for k, n in enumerate(names))
    return FullOrderConstants(
        bandwidth=bandwidth,
        radius=radius,
        shrink=shrink,
        guard_radius=guard_radius,
        start_strip=start_strip,
        guard_strip=strip,
        crossing=crossing,
        risen=risen,
        pace=(0.8 * float(slowest), most),
        inertia=0.5 * float(samples["inertia"].min()),
        **impacts.constants,
        barriers=tuple(barriers),
        least_radius=floor,
        weights=plan.weights if plan else (),
    )


def _no_set(samples: Samples, gamma: float, bandwidth: float) -> str | None:
    """Return why no set can be found, whatever its size; None if one may be."""
    if samples["pace"].min() <= 0.0 or samples["inertia"].min() <= 0.0:
        return "the hip does not move forward everywhere in the tube"
    if gamma <= min(ALPHAS):
        return f"outputs with a double pole at {bandwidth:g} rad/s come back too slowly"
    return None


def _with_strips(
    samples: Samples, evaluators: SampleEvaluators, levels: np.ndarray, start: float, guard: float
) -> dict[str, np.ndarray]:
    """Add points of the strips before phase 0 and beyond phase 1 to those seen.

    Where the fences converge, h falls steeply: a barrier may be tightest before phase 0.
    """
    strips = grid(np.array([-start, -0.5 * start, 1.0 + guard]), levels)
    there = evaluators.step(strips, np.zeros((len(strips), evaluators.size)))
    return {name: np.concatenate([values, there[name]]) for name, values in samples.items()}


def _bound_at_phase(radius: float, floor: float, shrink: float, phase: float) -> float:
    """Return the bound on sqrt(V) at a phase: from the radius it decays to the floor."""
    return floor + (radius - floor) * math.exp(-shrink * phase * phase)


def _over(
    samples: Samples, name: str, phase: np.ndarray, radius: float, floor: float, shrink: float
) -> np.ndarray:
    """Return a quantity plus a generous bound on the effect of outputs of a radius. [n]."""
    bound = floor + (radius - floor) * np.exp(-shrink * phase**2)
    reach = MARGIN * bound * slope_norms(samples, name)[:, 0]
    return (1.02 if radius > 0.0 else 1.0) * samples[name][:, 0] + reach


def _fastest(
    samples: Samples,
    phase: np.ndarray,
    radius: float,
    floor: float,
    gamma: float,
    end: float = 1.0625,
) -> tuple[float, float]:
    """Return the fastest pace, and the fastest shrinking of the bound on sqrt(V) that fits it.

    `end` is a phase beyond the guard's strip.
    """
    most, shrink = 0.0, 0.0
    for _ in range(3):
        most = float(_over(samples, "pace", phase, radius, floor, shrink).max())
        shrink = float(at_least(gamma / (4.0 * end * most), DIGITS))
    return most, shrink


def _crossing(evaluators: SampleEvaluators, levels: np.ndarray) -> float | str:
    """Return the narrowest strip around phase 1 with the foot up before it and down behind it.

    Or a sentence that there is none.
    """
    for width in CROSSINGS:
        before, behind = (grid(np.array([1.0 + side * width]), levels) for side in (-1, 1))
        zero = np.zeros((LEVELS, evaluators.size))
        above, below = evaluators.step(before, zero)["foot"], evaluators.step(behind, zero)["foot"]
        if above.min() > CLEAR and below.max() < -CLEAR:
            return width
    return (
        "the swing foot does not go through the ground everywhere within "
        f"{CROSSINGS[-1]} phases of the guard"
    )


def _radius(samples: Samples, phase: np.ndarray, shrink: float) -> tuple[float, float]:
    """Return the largest radius that forces, torques and foot allow, and the phase `risen`."""
    grow = np.exp(shrink * phase**2)

    def limit(name: str) -> np.ndarray:
        return (samples[name] / slope_norms(samples, name)).min(axis=1) * grow

    everywhere = min(limit("contact").min(), limit("torque").min())
    everywhere = min(everywhere, 0.5 * limit("inertia").min(), 0.8 * limit("pace").min())
    rises, above = limit("foot-rate"), limit("foot")
    best = max(
        (min(rises[phase <= end].min(), above[(phase >= end) & (phase <= 0.99)].min()), end)
        for end in np.linspace(0.02, 0.3, 15)
    )
    return float(min(everywhere, best[0])), float(best[1])


def _guard_strip(
    evaluators: SampleEvaluators, levels: np.ndarray, crossing: float, bound: float
) -> float | None:
    """Return the half width of the strip that holds the guard for all outputs in the set."""
    line = grid(np.array([1.0]), levels)
    guard_samples = evaluators.guard(line, np.zeros((len(line), evaluators.size)))
    phase_shift = (
        np.linalg.norm(guard_samples["foot/slope"], axis=1) / -guard_samples["fall"]
    ).max()
    strip = float(at_most(crossing + 2.0 * bound * float(phase_shift), DIGITS))
    return strip if 0.0 < strip < CROSSINGS[-1] else None


def _barrier(
    k: int,
    name: str,
    step: Samples,
    impacts: SampledImpacts,
    gamma: float,
    radius: float,
    plan: Plan | None,
) -> BarrierConstants:
    """Return the constants of one barrier with the gain that needs the least sigma."""
    above = MARGIN if plan is None else 1.2
    coupling = above * float(slope_norms(step, "rate")[:, k].max())
    reading = float(at_most(above * float(slope_norms(step, "reading")[:, k].max()), DIGITS))
    best = None
    for alpha in (a for a in ALPHAS if a < gamma):
        worst = float((step["rate"][:, k] + alpha * step["h"][:, k]).min())
        # Below the smallest value seen at points.
        epsilon = 0.94 * worst if worst > 0.0 else worst - 0.05 * abs(worst)
        # epsilon - alpha l^2 / (4 sigma) >= c^2 / (4 sigma (gamma - alpha)).
        needed = (coupling**2 / (gamma - alpha) + alpha * reading**2) / 4.0
        sigma = needed / epsilon if epsilon > 0.0 else math.inf
        if best is None or sigma < best[0]:
            best = sigma, alpha, epsilon
    assert best is not None
    sigma, alpha, epsilon = best
    if not math.isfinite(sigma):
        sigma = 0.0
    # For what reads outputs a larger sigma tightens less: l / (2 radius) costs least at the rim.
    least = reading / (2.0 * radius) if plan is None else plan.sigma[k]
    sigma = float(at_most(max((1.0 + 1e-9) * sigma, least), DIGITS))
    lowest = float(impacts.crossing["reset"][:, k].min())
    return BarrierConstants(
        name=name,
        alpha=alpha,
        epsilon=epsilon,
        coupling=coupling,
        reading=reading,
        reset=lowest - 0.02 * abs(lowest) - 1e-9,
        reset_slope=impacts.ample * float(slope_norms(impacts.rim, "reset")[:, k].max()),
        sigma=sigma,
    )
