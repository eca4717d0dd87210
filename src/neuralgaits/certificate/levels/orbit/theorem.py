"""Parameters of level 3's thin tube, and the statements that are premises. Needs no JAX."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

from neuralgaits.certificate.chart import Corner
from neuralgaits.certificate.levels.walking_set.theorem import WalkingSetConstants
from neuralgaits.certificate.premises import Premise

Attraction = Literal["contraction", "nested tubes", "contraction alone", "any two walks"]
"""Reason why the orbit attracts all of the walking set: see `conclude`. The last two enclose no
orbit. On every robot of a box the return map contracts, so each has one of its own; for a gait with
commands, walks under the same commands converge."""
ORBIT, RETURN_MAP = "orbit", "return map"
"""Labels of the statements that level 3 rests on."""


@dataclass(frozen=True)
class OrbitConstants:
    """A thin tube around the periodic orbit, and bounds on how trajectories part.

    Series are Chebyshev coefficients over the phase mapped to [-1, 1].

    Attributes:
        attraction: how the proof shows that the orbit attracts the walking set.
        guard_from, guard_to: phases between which the thin tube meets the ground.
        lower, upper: fences of the thin tube, zeta [(kg m^2/s)^2].
        expansion: upper bound of dF/dzeta over the walking set.
        slowest, fastest: bounds of dF/dzeta over the thin tube.

    Without a thin tube its parameters are empty.
    """

    attraction: Attraction
    guard_from: float = 0.0
    guard_to: float = 0.0
    lower: tuple[float, ...] = ()
    upper: tuple[float, ...] = ()
    expansion: tuple[float, ...] = ()
    slowest: tuple[float, ...] = ()
    fastest: tuple[float, ...] = ()

    @property
    def complete(self) -> bool:
        """Return whether all series exist that its kind of attraction needs."""
        thin = (self.lower, self.upper, self.slowest, self.fastest)
        if self.attraction in ("contraction alone", "any two walks"):
            return bool(self.expansion) and not any(thin)
        return bool(self.expansion) and all(thin)


def orbit_premises(walking: WalkingSetConstants, orbit: OrbitConstants) -> list[Premise]:
    """Return the premises of level 3 beside those of level 2."""
    if orbit.attraction == "any two walks":
        return _two_walk_premises(walking)
    first, last = walking.ends
    whole = (first, 0.0), (last, 1.0)
    lower, upper = ((first, 0.0), (last, 0.0)), ((first, 1.0), (last, 1.0))
    strip = (1.0 - walking.guard_strip, 0.0), (last, 1.0)
    before, behind = orbit.guard_from, orbit.guard_to
    thin_strip = (before, 0.0), (behind, 1.0)
    between = (walking.start_strip, 0.0), (1.0 - walking.guard_strip, 1.0)
    contracting = [
        Premise("orbit/expansion", *whole, sign="not negative"),
        Premise("orbit/gain", *strip, sign="any"),
    ]
    if orbit.attraction == "contraction alone":
        return contracting
    nested = ["orbit/nested-above", "orbit/nested-below"]
    if orbit.attraction == "contraction":
        nested = []
    return [
        *(Premise(output, *between) for output in nested),
        *contracting,
        Premise("orbit/fence-lower", *lower),
        Premise("orbit/fence-upper", *upper),
        Premise("orbit/inside", *lower),
        Premise("orbit/inside", *upper),
        Premise("orbit/foot-above", (before, 0.0), (before, 1.0)),
        Premise("orbit/foot-below", (behind, 0.0), (behind, 1.0)),
        Premise("orbit/reset-level", *thin_strip),
        Premise("orbit/width", *lower, sign="any"),
        Premise("orbit/slowest", *whole, sign="not negative"),
        Premise("orbit/fastest", *whole, sign="not negative"),
        Premise("orbit/reset-gain-low", *thin_strip),
        Premise("orbit/reset-gain-high", *thin_strip, sign="any"),
    ]


def _two_walk_premises(walking: WalkingSetConstants) -> list[Premise]:
    """Return the premises that bound how walks part in a step and a reset, for all commands."""
    first, last = walking.ends
    strip = (1.0 - walking.guard_strip, 0.0), (last, 1.0)
    return [
        Premise("orbit/expansion", (first, 0.0), (last, 1.0), sign="not negative"),
        Premise("orbit/gain", *strip, sign="any"),
        Premise("orbit/moved", *strip, sign="any"),
        Premise("orbit/along", *walking.start, sign="any"),
    ]


def labelled_premises(
    walking: WalkingSetConstants, orbit: OrbitConstants
) -> Iterator[tuple[str, str, Corner, Corner]]:
    """Return (label, output, low, high) of all premises of level 3 beside level 2."""
    # Outputs of level 3 in the walking set's chart; the others are in the thin tube's.
    return_map_outputs = ("orbit/expansion", "orbit/gain", "orbit/moved", "orbit/along")
    for output, low, high, _ in orbit_premises(walking, orbit):
        yield RETURN_MAP if output in return_map_outputs else ORBIT, output, low, high
