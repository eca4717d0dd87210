"""Results about bipeds in three dimensions for a person."""

import math

from neuralgaits._digits import percent
from neuralgaits.records.simulated import disturbances
from neuralgaits.runs.shell_words import command, named
from neuralgaits.systems.system_family import Screen
from neuralgaits.systems.walker3d.spatial_walks import SpatialWalks


def _heading(found: SpatialWalks) -> list[tuple[str, str]]:
    """Return the line about the heading of walks whose yaw is free."""
    if found.heading_rad is None:
        return []
    return [("heading", f"turned by up to {math.degrees(found.heading_rad):.1f} deg at the end")]


def screen_of_walks(found: SpatialWalks) -> Screen:
    """Return how many walks took all their steps, and how closely."""
    good = found.walked == found.episodes
    pushes = ((found.push_ns, "forward"), (found.push_left_ns, "to the left"))
    push = " and ".join(f"{size:g} N s {way}" for size, way in pushes if size is not None)
    pushed = f", pushed by {push}" if push else ""
    changed = [f"{name}={value:g}" for name, value in disturbances(found.disturb).items()]
    return Screen(
        "walks" if good else "falls",
        f": {found.walked} of {found.episodes} walks took {found.steps} steps under "
        f"{found.controller}{pushed}",
        None,
        [
            ("speed", f"{found.speed_m_s:.2f} m/s"),
            ("joint errors", f"up to {1e3 * found.largest_error_rad:.1f} mrad, push excluded"),
            ("in the tube", f"{100.0 * found.in_tube:.4g} % of ticks, push excluded"),
            (
                "torque",
                f"up to {found.largest_torque_nm:.0f} N m asked, {percent(found.clamped, 2)} cut",
            ),
            *_heading(found),
            ("disturbed", ", ".join(changed) or "by nothing"),
            ("run", found.run),
            ("next", command("report", named(found.run))),
        ],
    )
