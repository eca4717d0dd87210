"""Conclusions about trajectories of a cart-pole from a proof file that has been checked.

The statements hold by then; whether they are about a run's robot, the verdict says. Needs no JAX.
"""

from dataclasses import replace

from neuralgaits._digits import from_hex
from neuralgaits.certificate.proof_file.check import ASSUMPTIONS as OF_WALKERS
from neuralgaits.certificate.proof_file.check import CheckResult
from neuralgaits.certificate.proof_file.reader import Claims
from neuralgaits.systems.cartpole.cartpole_theorem import conclude
from neuralgaits.systems.cartpole.state_regions import CHART, CONDITIONS, REGIONS

ASSUMPTIONS = (
    OF_WALKERS[0],
    "the model is the rigid cart-pole with the stored float64 numbers, in exact real arithmetic; "
    "the force is computed from the true state in continuous time: sampling, delays, measurement "
    "errors and float32 are outside",
    "the flow is odd, so that what holds at a state holds at its opposite: a policy without biases "
    "and a decay made of squares",
    OF_WALKERS[-1],
)


def with_cartpole_levels(report: CheckResult, claims: Claims) -> CheckResult:
    """Add levels 2 and 3 to the report of a cart-pole's proof, where its statements give them.

    A file whose regions are not those of the spec is rejected: its words would be about others.
    """
    model = claims.model or {}
    if claims.asked is None or not report.holds:
        return report
    regions = {name: one.region for name, one in claims.asked.conditions.items()}
    if (claims.asked.regions, regions, claims.chart) != (REGIONS, CONDITIONS, CHART):
        why = "its regions, conditions or chart are not those of a cart-pole's spec"
        return replace(report, verdict="rejected", reason=why, levels=(), holds=False)
    rate = from_hex(model.get("rate"), "a rate")
    if not rate > 0.0:
        why = f"its rate of decay, {rate!r} 1/s, is not above 0"
        return replace(report, verdict="rejected", reason=why, levels=(), holds=False)
    stated = {name: one.bounds[name] for one in claims.statements for name in one.conditions}
    bounds = {name: stated[name] for name in CONDITIONS if name not in report.unclaimed}
    word = "proved" if report.verdict == "proved" else "consistent"
    levels = conclude(bounds, rate)
    return replace(report, levels=tuple(replace(one, verdict=word) for one in levels if one.proved))
