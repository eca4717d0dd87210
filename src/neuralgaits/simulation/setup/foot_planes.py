"""A plane under each foot in place of the file's floor, on mocap bodies 0 and 1.

Floor height and slope are part of a simulation's input, not of its model: planes move and turn.
"""

import math

import mujoco

# Bits of the collision masks: each foot meets its own plane and nothing else does.
FLOOR_BITS = (1 << 20, 1 << 21)
# Shown floor, and the group of the other one, which MuJoCo does not draw unless told to: two
# planes at one level would be lit twice.
SECOND_FLOOR_GROUP = 5


def add_plane(spec: mujoco.MjSpec, leg: int, tilt: float) -> mujoco.MjsGeom:
    """Add the floor under a foot, tilted uphill (rad). Returns: its plane."""
    body = spec.worldbody.add_body(name=f"_floor_{leg}", mocap=True)
    body.quat = tilt_quaternion(tilt)
    return body.add_geom(
        name=f"_floor_{leg}",
        type=mujoco.mjtGeom.mjGEOM_PLANE,
        size=[0.0, 0.0, 0.1],
        contype=FLOOR_BITS[leg],
        conaffinity=FLOOR_BITS[leg],
        group=(0, SECOND_FLOOR_GROUP)[leg],
    )


def tilt_quaternion(angle: float) -> tuple[float, float, float, float]:
    """Return the rotation that turns x up by an angle (rad), (w, x, y, z)."""
    return math.cos(angle / 2), 0.0, -math.sin(angle / 2), 0.0
