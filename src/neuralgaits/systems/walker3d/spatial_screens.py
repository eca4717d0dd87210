"""Results about bipeds in three dimensions for a person."""

from neuralgaits.runs.shell_words import command, named
from neuralgaits.systems.system_family import Screen
from neuralgaits.systems.walker3d.spatial_records import SpatialTrained
from neuralgaits.systems.walker3d.spatial_walks import SpatialWalks


def screen_of_gait(found: SpatialTrained) -> Screen:
    """Return a gait's figures, and whether one step from random starts held the conditions."""
    what = "hold" if found.holds else "do not all hold"
    rows = [(name, f"{least:.4g}") for name, least in found.margins.items()]
    multipliers = ", ".join(f"{one:.2f}" for one in found.multipliers)
    needs = f"friction {found.friction:.2f}, torque {found.peak_torque_nm:.0f} N m"
    return Screen(
        "trained" if found.holds else "not trained",
        f": {len(found.margins)} conditions {what} in a step from {found.samples} random starts",
        None if found.holds else (("condition", "smallest margin"), rows),
        [
            ("gait", f"{found.speed_m_s:.2f} m/s, steps of {found.step_m:.3f} m"),
            ("multipliers", f"{multipliers} in magnitude"),
            ("needs", f"{needs}, up to {found.yaw_nm:.0f} N m to hold the yaw; sampled"),
            ("run", found.run),
            ("next", command("simulate", named(found.run))),
        ],
    )


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
            ("torque", f"up to {found.largest_torque_nm:.0f} N m asked, {found.clamped:.2%} cut"),
            ("run", found.run),
        ],
    )
