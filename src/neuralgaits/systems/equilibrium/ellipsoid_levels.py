"""Levels 2 and 3 of an ellipsoid's conditions: what follows from them for trajectories.

Level 2: at r = 1 the flow points inward, so that no trajectory leaves the set; and in the set no
limit is met, so that the flow is the one of the formulas. Level 3: r' <= -rate r in the whole set,
so r <= exp(-rate t): from `descent` on the ring, and on the core from `settling` by the mean value
theorem, since r' is 0 at r = 0. Needs no JAX.
"""

from collections.abc import Mapping
from dataclasses import dataclass

from neuralgaits._digits import from_hex
from neuralgaits.certificate.proof_file.check import CheckResult
from neuralgaits.certificate.proof_file.reader import Claims
from neuralgaits.records.certified import Conclusion
from neuralgaits.systems.claimed_levels import Bounds, is_open, with_claimed_levels
from neuralgaits.systems.condition_table import ConditionTable
from neuralgaits.systems.equilibrium.ellipsoid_regions import RADIAL

STRICT = ("inward",)
"""At a tangent point of the face only a positive rate keeps trajectories inside."""


@dataclass(frozen=True)
class EllipsoidLevels:
    """Conclusions of a family from its conditions on an ellipsoid.

    Attributes:
        words: name of the family, with an article.
        table: its conditions.
        limits: what its conditions about limits say, in words.
        rest: where its trajectories come to rest, in words.
    """

    words: str
    table: ConditionTable
    limits: str
    rest: str

    def conclude(
        self, bounds: Mapping[str, float | None], rate: float, level: int = 3
    ) -> tuple[Conclusion, ...]:
        """Draw the conclusions that proved bounds of conditions on their regions allow.

        Args:
            bounds: proved bound by condition; None if there is none.
            rate: decay that descent and settling require [1/s].
            level: the highest level that is asked for.
        """
        limits = (name for name in self.table.conditions if name not in RADIAL)
        left = [name for name in ("inward", *limits) if is_open(bounds, name, STRICT)]
        stays = Conclusion(2, "proved", None, self._words_of_stay())
        if left:
            stays = Conclusion(2, "undecided", f"{left[0]} is not proved")
        left += [name for name in ("descent", "settling") if is_open(bounds, name, STRICT)]
        if not rate > 0.0:
            left = ["a rate above 0"]
        words = f"from every state of the set the radius decays at least like exp(-{rate!r} t): "
        converges = Conclusion(3, "proved", None, (words + self.rest,), {"rate_1_s": rate})
        if left:
            converges = Conclusion(3, "undecided", f"{left[0]} is not proved")
        return tuple(one for one in (stays, converges) if one.level <= level)

    def _words_of_stay(self) -> tuple[str, ...]:
        return (
            "every trajectory of the full order that starts in the set stays in it for ever",
            f"on it {self.limits}",
        )

    def with_levels(self, report: CheckResult, claims: Claims) -> CheckResult:
        """Add levels 2 and 3 to the report of a checked proof, see `with_claimed_levels`."""

        def follow(bounds: Bounds) -> tuple[Conclusion, ...] | str:
            rate = from_hex((claims.model or {}).get("rate"), "a rate")
            if not rate > 0.0:
                return f"its rate of decay, {rate!r} 1/s, is not above 0"
            return self.conclude(bounds, rate)

        return with_claimed_levels(report, claims, self.table, f"{self.words}'s spec", follow)
