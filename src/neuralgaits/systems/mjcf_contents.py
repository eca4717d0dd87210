"""Contents of robot files that families read: kinds of joints, names, links in their plane."""

from pathlib import Path
from typing import NamedTuple
from xml.etree import ElementTree

import mujoco
import numpy as np

from neuralgaits._printable import visible
from neuralgaits._types import Float
from neuralgaits.errors import RobotError
from neuralgaits.robots.mjcf import model_contents
from neuralgaits.robots.mjcf.text import standalone_text


def joint_kinds(source: str | Path) -> list[str]:
    """Return the kinds of joints in the bodies of a robot file; [] for what is no such file.

    For who asks which family a file is meant for: that family's reader says what is wrong.
    """
    try:
        path = Path(str(source))
        if not path.is_file() or path.suffix.lower() not in (".xml", ".mjcf"):
            return []
        root = ElementTree.fromstring(standalone_text(path))
    except (RobotError, OSError, ValueError, ElementTree.ParseError):
        return []
    bodies = [list(body) for body in root.iter("body")]
    joints = [joint for joint in root.iter("joint") if any(joint in body for body in bodies)]
    return [joint.get("type", "hinge") for joint in joints]


def model_name(model: mujoco.MjModel, name: str) -> str:
    """Return the name that a file gives its model, or that of the file if it gives none."""
    own = model_contents.model_name(model, "")
    return visible(own) if own else name


class PlanarLink(NamedTuple):
    """A body with all that is welded to it, in the plane of a mechanism.

    Attributes:
        mass: mass of all of it [kg].
        centre: centre of mass from the joint, along both directions of the plane [m]. [2]
        inertia: about the centre of mass, around the plane's normal [kg m^2].
    """

    mass: float
    centre: Float[np.ndarray, "2"]
    inertia: float


def planar_link(
    model: mujoco.MjModel,
    data: mujoco.MjData,
    joint: int,
    plane: tuple[Float[np.ndarray, "3"], Float[np.ndarray, "3"]],
) -> PlanarLink:
    """Return the link that a joint moves.

    Args:
        model: model of the file.
        data: places of its bodies.
        joint: number of the joint.
        plane: two directions at right angles, of length 1.
    """
    own = model.body_weldid[model.jnt_bodyid[joint]]
    bodies = [b for b in range(1, model.nbody) if model.body_weldid[b] == own]
    weights, normal = model.body_mass[bodies], np.cross(*plane)
    # What lies along the normal does not count in the plane.
    places = (data.xipos[bodies] - data.xanchor[joint]) @ np.stack(plane, axis=1)
    centre = weights @ places / weights.sum() if weights.sum() > 0.0 else np.zeros(2)
    inertia = 0.0
    for body, place in zip(bodies, places, strict=True):
        across = data.ximat[body].reshape(3, 3).T @ normal
        inertia += float(across**2 @ model.body_inertia[body])
        inertia += float(model.body_mass[body] * np.sum((place - centre) ** 2))
    return PlanarLink(float(weights.sum()), centre, inertia)
