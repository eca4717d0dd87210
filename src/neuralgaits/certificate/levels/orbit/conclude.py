"""Conclude level 3 from its premises: the arithmetic of the return map, in balls.

The argument is in docs/walking_set.md. Numbers come from the parameters and the proved bounds; a
comparison holds only if it is certain.
"""

from collections.abc import Iterator, Sequence

from flint import arb

from neuralgaits._digits import at_least, at_most
from neuralgaits.certificate.levels.orbit.theorem import OrbitConstants, orbit_premises
from neuralgaits.certificate.levels.walking_set.theorem import WalkingSetConstants
from neuralgaits.certificate.premises import Bounds, above, below, missing_premises
from neuralgaits.records.certified import Conclusion


def attraction(walking: WalkingSetConstants, orbit: OrbitConstants, bounds: Bounds) -> Conclusion:
    """Conclude that one enclosed periodic orbit attracts the walking set; rests on level 2.

    Args:
        walking: parameters of the set.
        orbit: thin tube and bounds on the expansion.
        bounds: proved bounds.
    """
    missing = next(_obstacles(walking, orbit, bounds), None)
    if missing is not None:
        return Conclusion(3, "undecided", missing)
    if walking.told:
        return _any_two_walks(walking, orbit, bounds)
    if orbit.attraction == "contraction alone":
        return _contraction_alone(walking, orbit, bounds)
    return _enclosed_orbit(walking, orbit, bounds)


def _obstacles(
    walking: WalkingSetConstants, orbit: OrbitConstants, bounds: Bounds
) -> Iterator[str]:
    """Yield what stands against the arithmetic; each rests on all before it being absent."""
    if not orbit.complete or bool(walking.told) != (orbit.attraction == "any two walks"):
        yield "its parameters are not those of its kind of attraction"
    yield from missing_premises(orbit_premises(walking, orbit), bounds)
    if walking.told or orbit.attraction == "contraction alone":
        return
    if walking.floor:
        yield "an orbit is enclosed for footholds as meant only"
    if not (walking.falling < orbit.guard_from < orbit.guard_to <= walking.ends[1]):
        yield "the thin tube's guard is not where the foot falls"


def _enclosed_orbit(
    walking: WalkingSetConstants, orbit: OrbitConstants, bounds: Bounds
) -> Conclusion:
    """Conclude that one orbit, inside the thin tube, attracts the walking set."""
    first, last = walking.ends
    thin = (orbit.guard_from, 0.0), (orbit.guard_to, 1.0)
    gains = bounds["orbit/reset-gain-low", *thin], -bounds["orbit/reset-gain-high", *thin]
    width = -bounds["orbit/width", (first, 0.0), (last, 0.0)]
    over = _over(walking) * _end(orbit, walking)
    low = arb(gains[0]) * (_integral(orbit.slowest) - over).exp()
    high = arb(gains[1]) * (_integral(orbit.fastest) + over).exp()
    middle = [(2 * _value(s, arb(0))).sqrt() for s in (orbit.lower, orbit.upper)]
    approach, why, doubt = _approach(walking, orbit, bounds, high)
    figures = {
        "contraction_at_most": approach["contraction_at_most"],
        "multiplier_at_least": below(low),
        "multiplier_at_most": above(high),
        "z2_at_mid_step_at_least": below(middle[0]),
        "z2_at_mid_step_at_most": above(middle[1]),
        "z2_width_at_most": width,
        **approach,
    }
    if doubt is None and not middle[0] < middle[1]:
        # Margins in its widths are bounded, so that these have one sign at every phase.
        doubt = "the thin tube is upside down"
    if doubt is None and not (low > 0 and high < 1):
        doubt = f"the multiplier is enclosed in [{below(low):.4g}, {above(high):.4g}] only"
    if doubt is not None:
        return Conclusion(3, "undecided", doubt, (), figures)
    least, most = below(middle[0]), above(middle[1])
    words = (
        f"{why}: there is one periodic orbit, and every trajectory of the undisturbed system in T "
        "converges to it",
        f"at mid-step the orbit has z2 in [{at_least(least, 8)}, {at_most(most, 8)}] kg m^2/s, and "
        f"is known to {at_most(width, 3)} kg m^2/s everywhere",
        f"its multiplier is in [{at_least(below(low), 4)}, {at_most(above(high), 4)}]",
    )
    return Conclusion(3, "proved", None, words, figures)


def _approach(
    walking: WalkingSetConstants, orbit: OrbitConstants, bounds: Bounds, high: arb
) -> tuple[dict[str, float], str, str | None]:
    """Bound how trajectories of the walking set approach the orbit.

    Returns: figures; why they approach it; a reason if that is not shown.
    """
    gain = -bounds["orbit/gain", (1.0 - walking.guard_strip, 0.0), (walking.ends[1], 1.0)]
    over = _over(walking) * _end(orbit, walking)
    contraction = arb(gain) * (_integral(orbit.expansion) + over).exp()
    figures = {"contraction_at_most": above(contraction)}
    if orbit.attraction != "nested tubes":
        why = (
            "the return map of the section at mid-step contracts to "
            f"{at_most(above(contraction), 4)} or less on all of T"
        )
        doubt = f"the return map is not shown to contract: |P'| <= {above(contraction):.4g}"
        return figures, why, None if contraction < 1 else doubt
    shrinking = arb(gain) * (2 * over).exp()
    shrinking *= _half_width(orbit, 1.0 - walking.guard_strip)
    shrinking /= _half_width(orbit, walking.start_strip)
    figures["tubes_shrink_by_at_most"] = above(shrinking)
    why = (
        "outside a thin tube around the orbit every trajectory gets nearer to it from phase "
        f"{walking.start_strip!r} to {1.0 - walking.guard_strip!r}, and across the impact gets to "
        f"{at_most(above(shrinking), 4)} of its distance or less; inside it the return map "
        f"contracts to {at_most(above(high), 4)} or less"
    )
    doubt = f"tubes around the orbit may widen by {above(shrinking):.4g} at the impact"
    return figures, why, None if shrinking < 1 else doubt


def _contraction_alone(
    walking: WalkingSetConstants, orbit: OrbitConstants, bounds: Bounds
) -> Conclusion:
    """Conclude that one attracting orbit exists, without an enclosure of it.

    On T the return map of the section at mid-step is defined, and maps that interval into itself.
    Where the height of the next foothold is free, there is one map for each height; gain and series
    bound all of them, and two walks over equal heights approach each other at every step.
    """
    strip = (1.0 - walking.guard_strip, 0.0), (walking.ends[1], 1.0)
    gain = -arb(bounds["orbit/gain", *strip])
    contraction = gain * (_integral(orbit.expansion) + _over(walking) * _end(orbit, walking)).exp()
    figures = {"contraction_at_most": above(contraction)}
    if not contraction < 1:
        reason = f"the return map is not shown to contract: |P'| <= {above(contraction):.4g}"
        return Conclusion(3, "undecided", reason, (), figures)
    what = "there is one periodic orbit, and every trajectory of the undisturbed system in T "
    what += "converges to it"
    if walking.floor:
        what = "any two trajectories of the undisturbed system in T whose footholds lie equally "
        what += "high, step by step, converge; where all lie as meant, to one periodic orbit"
    words = (
        f"the return map of the section at mid-step contracts to {at_most(above(contraction), 4)} "
        f"or less on all of T: {what}",
    )
    return Conclusion(3, "proved", None, words, figures)


def _any_two_walks(
    walking: WalkingSetConstants, orbit: OrbitConstants, bounds: Bounds
) -> Conclusion:
    """Conclude that walks under the same commands converge.

    Along a step the series bounds how fast the zeta of two of them part. A reset carries a
    neighbour that is off by 1 to one that is off by `gain` in zeta and by `moved` metres in z1, on
    a flow that changes zeta by `along` a metre or less, whatever the next command is.
    """
    last = walking.ends[1]
    strip = (1.0 - walking.guard_strip, 0.0), (last, 1.0)
    gain, shift, along = (
        -arb(bounds[name, *box])
        for name, box in (
            ("orbit/gain", strip),
            ("orbit/moved", strip),
            ("orbit/along", walking.start),
        )
    )
    parting = (_integral(orbit.expansion) + _over(walking) * _end(orbit, walking)).exp()
    contraction = (gain + shift * along) * parting
    figures = {"contraction_at_most": above(contraction)}
    if not contraction < 1:
        reason = f"walks are not shown to converge: a step makes {above(contraction):.4g} of 1"
        return Conclusion(3, "undecided", reason, (), figures)
    words = (
        "any two trajectories of the undisturbed system in T under the same admissible commands "
        f"converge: from step to step their distance in zeta = z2^2 / 2 at a phase shrinks to "
        f"{at_most(above(contraction), 4)} of it or less, whatever the commands are",
    )
    return Conclusion(3, "proved", None, words, figures)


def _over(walking: WalkingSetConstants) -> arb:
    """Return by how many phases a step may be longer or shorter than 1."""
    behind, before = arb(walking.ends[1]) - 1, 1 - arb(1.0 - walking.guard_strip)
    return arb(walking.start_strip) + behind.max(before)


def _end(orbit: OrbitConstants, walking: WalkingSetConstants) -> arb:
    """Bound the expansion series anywhere in T, and so on the strips.

    Where |x| <= X and X >= 1, no Chebyshev polynomial is larger than at X.
    """
    edge = 1 + 2 * arb(walking.start_strip).max(arb(walking.ends[1]) - 1)
    worst = arb(0)
    for series in filter(None, (orbit.expansion, orbit.slowest, orbit.fastest)):
        worst = worst.max(_value([abs(c) for c in series], edge))
    return worst


def _half_width(orbit: OrbitConstants, phase: float) -> arb:
    """Return the thin tube's half width [unit of zeta]; every nested tube is a multiple of it."""
    x = 2 * arb(phase) - 1
    return (_value(orbit.upper, x) - _value(orbit.lower, x)) / 2


def _integral(series: Sequence[float]) -> arb:
    """Integrate a Chebyshev series over phases 0 to 1."""
    total = arb(0)
    for k in range(0, len(series), 2):
        total += arb(series[k]) / (1 - k * k)
    return total


def _value(series: Sequence[float], x: arb) -> arb:
    """Evaluate a Chebyshev series at x, by Clenshaw."""
    ahead, further = arb(0), arb(0)
    for coefficient in reversed(series[1:]):
        ahead, further = 2 * x * ahead - further + arb(coefficient), ahead
    return x * ahead - further + arb(series[0])
