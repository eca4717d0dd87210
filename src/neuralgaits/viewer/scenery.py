"""Lights and floor of a scene in which the robot stays in the middle and the ground moves."""

import math

import viser

from neuralgaits.simulation.setup.foot_planes import tilt_quaternion

SECTION = 1.0
"""Distance between the thick lines of the floor [m]."""


def add_ground(server: viser.ViserServer) -> viser.GridHandle:
    """Add lights and an endless floor. Returns: the floor."""
    scene = server.scene
    scene.set_up_direction("+z")
    # No environment map: a browser without a graphics card needs seconds to prepare one.
    scene.configure_environment_map(None)
    scene.configure_default_lights(enabled=False)
    scene.add_light_ambient("/sky", intensity=1.5)
    scene.add_light_directional("/sun", intensity=1.8, position=(-1.5, -3.0, 4.0))
    return scene.add_grid(
        "/floor",
        infinite_grid=True,
        cell_size=0.25,
        section_size=SECTION,
        # Greys that can be told from a light background and from a dark one.
        cell_color=(190, 196, 202),
        section_color=(140, 148, 156),
        section_thickness=1.2,
        plane_color=(128, 136, 146),
        plane_opacity=0.08,
        shadow_opacity=0.25,
        fade_distance=30.0,
    )


def lay_floor(floor: viser.GridHandle, slope: float, x: float, y: float = 0.0) -> None:
    """Put the floor through the scene's middle, its lines fixed to the ground.

    Args:
        floor: floor that `add_ground` made.
        slope: its rise per metre forward.
        x: place of the ground that is in the middle, forward [m].
        y: the same to the left [m].
    """
    long = math.hypot(1.0, slope)
    behind = math.fmod(x * long, SECTION) / long
    floor.position = (-behind, -math.fmod(y, SECTION), -behind * slope)
    floor.wxyz = tilt_quaternion(math.atan(slope))
