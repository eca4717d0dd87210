"""Bipeds in three dimensions on point feet, the yaw of their torso held.

Hip roll, hip pitch and knee on each leg; two degrees of freedom have no motor, so the state of the
zero dynamics has four numbers. Needs no JAX.
"""

from pathlib import Path

from neuralgaits.certificate.proof_file.check import ASSUMPTIONS as OF_WALKERS
from neuralgaits.certificate.proof_file.check import CheckResult
from neuralgaits.certificate.proof_file.reader import Claims
from neuralgaits.systems.system_family import SystemFamily


def _recognises(source: str | Path) -> bool:
    from neuralgaits.systems.walker3d.spatial_source import is_spatial  # Brings MuJoCo.

    return is_spatial(source)


def _without_levels(report: CheckResult, claims: Claims) -> CheckResult:
    """Return a report as it is: nothing about trajectories follows from conditions alone."""
    del claims
    return report


FAMILY = SystemFamily(
    name="walker3d",
    words="a walker in three dimensions",
    built_in={
        "walker3d": "a biped in three dimensions: hip roll, hip pitch, knees and point feet, 26 kg"
    },
    recognises=_recognises,
    assumptions=(OF_WALKERS[0], OF_WALKERS[-1]),
    with_levels=_without_levels,
)
