"""A robot file with other masses, centres of mass, inertias and rotors, written into its text.

It shares nothing with `robots.mjcf.parameters`: numbers of <inertial> and <joint> are changed, and
the file is loaded like any other.
"""

from collections.abc import Mapping
from xml.etree import ElementTree

import numpy as np

from neuralgaits.robots import load_robot
from neuralgaits.robots.biped import PlanarBiped
from neuralgaits.robots.mjcf.loader import robot_from_text

LINKS = {"shin": ("shin_left", "shin_right"), "thigh": ("thigh_left", "thigh_right")}
LINKS |= {"torso": ("torso",)}
JOINTS = {"knee": ("knee_left", "knee_right"), "hip": ("hip_left", "hip_right")}


def edited(name: str, errors: Mapping[str, float]) -> PlanarBiped:
    """A built-in robot of the AMBER-3M kind with these errors, by the names of parameters.

    Along a link is up and across it backwards, where it stands upright.
    """
    nominal = load_robot(name)
    root = ElementTree.fromstring(nominal.layout.xml)
    bodies = {body.get("name"): body for body in root.iter("body")}
    for kind, names in LINKS.items():
        for inertial in (bodies[one].find("inertial") for one in names):
            assert inertial is not None
            place = np.array([float(x) for x in str(inertial.get("pos")).split()])
            place[2] += errors.get(f"centre of mass of {kind} along (error in m)", 0.0)
            place[0] -= errors.get(f"centre of mass of {kind} across (error in m)", 0.0)
            mass = float(str(inertial.get("mass")))
            mass *= 1.0 + errors.get(f"mass of {kind} (relative error)", 0.0)
            moments = np.array([float(x) for x in str(inertial.get("diaginertia")).split()])
            moments *= 1.0 + errors.get(f"inertia of {kind} (relative error)", 0.0)
            inertial.set("pos", " ".join(map(repr, place.tolist())))
            inertial.set("mass", repr(float(mass)))
            inertial.set("diaginertia", " ".join(map(repr, moments.tolist())))
    joints = {joint.get("name"): joint for joint in root.iter("joint") if joint.get("name")}
    for place, kind in enumerate(JOINTS, start=1):
        rotor = float(nominal.armature[place])
        rotor *= 1.0 + errors.get(f"rotor inertia of {kind} (relative error)", 0.0)
        for one in JOINTS[kind]:
            joints[one].set("armature", repr(float(rotor)))
    return robot_from_text(ElementTree.tostring(root, encoding="unicode"), name)
