"""Levels 2 and 3 of a cart-pole: what follows from its conditions for trajectories.

Level 2: at r = 1 the flow points inward, so that no trajectory leaves the set; and in the set the
force is within the motor's limit, so that it is the one of the formulas. Level 3: r' <= -rate r in
the whole set, so r <= exp(-rate t): from `descent` on the ring, and on the core from `settling` by
the mean value theorem, since r' is 0 at r = 0. Needs no JAX.
"""

from collections.abc import Mapping

from neuralgaits.records.certified import Conclusion

STAYS = ("inward", "force", "rail", "upright")
CONVERGES = ("descent", "settling")


def conclude(
    bounds: Mapping[str, float | None], rate: float, level: int = 3
) -> tuple[Conclusion, ...]:
    """Draw the conclusions that proved bounds of conditions on their regions allow.

    Args:
        bounds: proved bound by condition; None if there is none.
        rate: that descent and settling are about [1/s].
        level: the highest level that is asked for.
    """
    open_below = [name for name in STAYS if _open(bounds, name)]
    stays = Conclusion(2, "proved", None, _words_of_stay())
    if open_below:
        stays = Conclusion(2, "undecided", f"{open_below[0]} is not proved")
    left = [*open_below, *(name for name in CONVERGES if _open(bounds, name))]
    if not rate > 0.0:
        left = ["a rate above 0"]
    converges = Conclusion(3, "proved", None, _words_of_rate(rate), {"rate_1_s": rate})
    if left:
        converges = Conclusion(3, "undecided", f"{left[0]} is not proved")
    return tuple(one for one in (stays, converges) if one.level <= level)


def _open(bounds: Mapping[str, float | None], name: str) -> bool:
    bound = bounds.get(name)
    # At a tangent point of the face only a positive rate keeps trajectories inside.
    return bound is None or not (bound > 0.0 if name == "inward" else bound >= 0.0)


def _words_of_stay() -> tuple[str, ...]:
    return (
        "every trajectory of the full order that starts in the set stays in it for ever",
        "on it the motor's force is within its limits, the cart on its rail, the pole upright",
    )


def _words_of_rate(rate: float) -> tuple[str, ...]:
    return (
        f"from every state of the set the radius decays at least like exp(-{rate!r} t): the pole "
        "comes to rest upright, at the middle of the rail",
    )
