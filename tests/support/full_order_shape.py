"""Constants of level 4 from which the theorem follows."""

from neuralgaits.certificate.levels.full_order.theorem import BarrierConstants, FullOrderConstants

UPPER = BarrierConstants("level-upper", 1.0, 0.16, 38.0, 0.0, 0.08, 13.0, 52.0)
FENCE = BarrierConstants("level-lower", 2.0, 0.07, 38.0, 0.0, 0.07, 13.0, 130.0)
TORSO = BarrierConstants("torso-lower", 20.0, 0.7, 3.0, 1.4, 0.08, 0.9, 75.0)
SHAPE = FullOrderConstants(
    bandwidth=30.0,
    radius=0.009,
    shrink=3.2,
    guard_radius=0.00038,
    start_strip=0.003,
    guard_strip=0.002,
    crossing=1e-9,
    risen=0.06,
    pace=(0.9, 3.26),
    inertia=8.0,
    mismatch=1e-6,
    drift=20.0,
    gain=14.0,
    landing=1e-9,
    landing_slope=5.3,
    barriers=(FENCE, UPPER, TORSO),
)
