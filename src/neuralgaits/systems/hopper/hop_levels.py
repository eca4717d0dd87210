"""Regions and conditions of the spec `hopping`, and what follows for trajectories. Needs no JAX."""

from collections.abc import Mapping

from neuralgaits._digits import from_hex
from neuralgaits.certificate.chart import Axis, Chart
from neuralgaits.certificate.proof_file.check import CheckResult
from neuralgaits.certificate.proof_file.reader import Claims
from neuralgaits.records.certified import Conclusion
from neuralgaits.systems.claimed_levels import Bounds, is_open, with_claimed_levels
from neuralgaits.systems.condition_table import ConditionTable

TABLE = ConditionTable(
    chart=Chart(state=(Axis("progress", 0.0, 1.0), Axis("energy level", 0.0, 1.0))),
    regions={
        "stance": (((0.0, 0.0), (1.0, 1.0)),),
        "low": (((0.0, 0.0), (1.0, 0.0)),),
        "high": (((0.0, 1.0), (1.0, 1.0)),),
        "lift-off": (((1.0, 0.0), (1.0, 1.0)),),
    },
    conditions={
        "low fence": "low",
        "high fence": "high",
        "forward": "stance",
        "chart": "stance",
        "support": "stance",
        "grip": "stance",
        "push": "stance",
        "reach": "stance",
        "flies": "lift-off",
        "blow": "lift-off",
        "lands": "lift-off",
        "closer": "stance",
        "approach": "lift-off",
    },
)
CONVERGES = ("closer", "approach")
"""Conditions of level 3; all others are premises of level 2."""
STRICT = ("low fence", "high fence")
"""Conditions whose bound must be above 0: at a tangent point only that keeps a stance inside."""


def conclude(
    bounds: Mapping[str, float | None], rate: float, level: int = 3
) -> tuple[Conclusion, ...]:
    """Draw the conclusions that proved bounds of conditions on their regions allow.

    Level 2: at the fences the flow points inward, so that a stance stays between them; it goes
    forward, so that it ends, at lift-off; the flight brings it back between the fences. Level 3:
    the weighted distance of two stances' energies at the same progress does not grow over a
    stance, and a flight takes it, times 1 + rate, to no more than it was: the weight is larger at
    lift-off than at touchdown. So the hop's map is a contraction of an interval.

    Args:
        bounds: proved bound by condition; None if there is none.
        rate: convergence rate that `approach` requires.
        level: the highest level that is asked for.
    """
    left = [
        name for name in TABLE.conditions if name not in CONVERGES and is_open(bounds, name, STRICT)
    ]
    stays = Conclusion(
        2,
        "proved",
        None,
        (
            "every trajectory of the hybrid zero dynamics that starts in the tube hops for ever, "
            "each stance within the tube",
            "in stance the floor bears the forces, and the leg is within its range and its motor's "
            "limit",
        ),
    )
    if left:
        stays = Conclusion(2, "undecided", f"{left[0]} is not proved")
    left += [name for name in CONVERGES if is_open(bounds, name, STRICT)]
    if not rate > 0.0:
        left = ["a rate above 0"]
    words = (
        "there is one orbit in the tube, and every trajectory of the hybrid zero dynamics in it "
        f"comes closer to it at least by the factor 1 / (1 + {rate!r}) a hop, in energies at "
        "touchdown",
    )
    converges = Conclusion(3, "proved", None, words, {"rate_1_hop": rate})
    if left:
        converges = Conclusion(3, "undecided", f"{left[0]} is not proved")
    return tuple(one for one in (stays, converges) if one.level <= level)


def with_hop_levels(report: CheckResult, claims: Claims) -> CheckResult:
    """Add levels 2 and 3 to the report of a checked proof, see `with_claimed_levels`."""

    def follow(bounds: Bounds) -> tuple[Conclusion, ...] | str:
        rate = from_hex((claims.model or {}).get("rate"), "a rate")
        if not rate > 0.0:
            return f"its rate of approach, {rate!r}, is not above 0"
        return conclude(bounds, rate)

    return with_claimed_levels(report, claims, TABLE, "a hopper's spec", follow)
