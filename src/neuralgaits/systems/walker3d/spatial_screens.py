"""Results about bipeds in three dimensions for a person."""

from neuralgaits.systems.system_family import Screen
from neuralgaits.systems.walker3d.spatial_walks import SpatialWalks


def screen_of_walks(found: SpatialWalks) -> Screen:
    """Return how many walks took all their steps, and how closely."""
    good = found.walked == found.episodes
    push = "" if found.push_ns is None else f", pushed by {found.push_ns:g} N s to the left"
    return Screen(
        "walks" if good else "falls",
        f": {found.walked} of {found.episodes} walks took {found.steps} steps under "
        f"{found.controller}{push}",
        None,
        [
            ("speed", f"{found.speed_m_s:.2f} m/s"),
            ("joint errors", f"up to {1e3 * found.largest_error_rad:.1f} mrad, push excluded"),
            ("in the tube", f"{100.0 * found.in_tube:.4g} % of ticks, push excluded"),
            ("torque", f"up to {found.largest_torque_nm:.0f} N m asked, {found.clamped:.2%} cut"),
            ("run", found.run),
        ],
    )
