"""Refusal of numbers in a robot file that no robot and no floor has.

MuJoCo compiles most of them: a joint whose damping is negative gains energy, a foot without
friction has no hold on the floor, and an infinite mass makes every other number NaN.
"""

from xml.etree import ElementTree

import mujoco
import numpy as np

from neuralgaits.errors import RobotError
from neuralgaits.robots.mjcf.refuse_or_note import notes_problems, refuse

MOST = 1e6
"""Largest magnitude of any length, angle, mass, torque or coefficient, in SI units: a robot of a
thousand kilometres or tonnes is a slip of the keyboard."""
LEAST = 1e-6
"""Smallest value of what must be positive, in SI units."""


def refuse_unphysical(model: mujoco.MjModel) -> None:
    """Check that a compiled file holds numbers of a size that a robot can have.

    Raises: RobotError naming the element, the attribute and the number.
    """
    # Arrays that come from numbers in the file, and that a walk depends on.
    fields = {
        "body": ("pos", "quat", "ipos", "iquat", "mass", "inertia"),
        "jnt": ("pos", "axis", "range", "actfrcrange", "margin", "solref", "solimp"),
        "dof": ("armature", "damping", "frictionloss"),
        "geom": ("pos", "quat", "size", "friction", "solref", "solimp", "solmix", "margin", "gap"),
        "actuator": ("gear", "ctrlrange", "forcerange"),
        "key": ("qpos", "qvel", "ctrl"),
    }
    for kind, names in fields.items():
        for name in names:
            values = np.asarray(getattr(model, f"{kind}_{name}"))
            rows = values.reshape(len(values), values[:1].size)
            for row, column in zip(*np.nonzero(~(np.abs(rows) <= MOST)), strict=True):
                label = _label(model, kind, int(row))
                refuse(
                    f"{label} has {name} {rows[row, column]:g}, but at most {MOST:g} makes sense "
                    "in SI units: mend that number"
                )
    for joint, place in enumerate(model.jnt_qposadr):
        if not abs(model.qpos0[place]) <= MOST:
            number = f"{_label(model, 'jnt', joint)} has ref {model.qpos0[place]:g}"
            refuse(f"{number}, which is no position: leave it out")
    gravity = float(np.max(np.abs(model.opt.gravity)))
    if not LEAST <= gravity <= MOST:
        refuse(f'gravity is {gravity:g} m/s^2: use <option gravity="0 0 -9.81"/>')
    if not LEAST <= model.opt.impratio <= MOST:
        refuse(
            f"impratio of <option> is {model.opt.impratio:g}, expected a number above 0: leave it "
            "out"
        )


def refuse_negative_mass(text: str) -> None:
    """Check masses, inertias and densities of MJCF text, also those that MuJoCo would change.

    Raises: RobotError naming the body or geom, and the number.
    """
    try:
        root = ElementTree.fromstring(text)
    except ElementTree.ParseError:
        # Whoever compiles the text says what is wrong with it.
        return
    masses = {"inertial": ("mass", "diaginertia"), "geom": ("mass", "density")}
    for parent in root.iter():
        for element in parent:
            for name in masses.get(str(element.tag), ()):
                for number in _numbers(element.get(name, "")):
                    if not number >= 0.0:
                        owner = parent if element.tag == "inertial" else element
                        refuse(
                            f"{owner.tag} {owner.get('name', 'without a name')} has {name} "
                            f"{number:g}: expected 0 or more; mend that number"
                        )


def _numbers(text: str) -> list[float]:
    """Read the numbers of an attribute; none of what is no number, which MuJoCo refuses."""
    try:
        return [float(word) for word in text.split()]
    except ValueError:
        return []


def refuse_quantity(name: str, words: str, value: float, where: str) -> None:
    """Check one number of a leg.

    Args:
        name: name of the quantity in `derive.LegData`.
        words: the quantity in words, with its unit.
        value: number in that unit.
        where: the body or joint that has it.

    Raises: RobotError if no robot has this value.
    """
    if notes_problems() and np.isnan(value):
        return  # Named where it is missing.
    positive = ("length", "mass", "torque_limit", "foot_radius", "friction")
    if name in positive and not LEAST <= value <= MOST:
        refuse(
            f"{words} is {value:.6g} at {where}: expected {LEAST:g} to {MOST:g}; mend that number"
        )
    if name in ("inertia", "armature", "damping") and not 0.0 <= value <= MOST:
        refuse(f"{words} is {value:.6g} at {where}: expected 0 to {MOST:g}; mend that number")


def refuse_large_foot(radius: float, leg: float, name: str) -> None:
    """Refuse a foot sphere that is no point beside its leg.

    Args:
        radius: radius of the sphere [m].
        leg: length of the straight leg, to the sphere's centre [m].
        name: name of the sphere's geom.

    Raises: RobotError if it is larger than `LARGEST_FOOT` allows.
    """
    # Largest radius of a foot, in lengths of the leg. The closed form pins the centre of the
    # sphere; on a floor it rolls, by radius times angle: this share of each step.
    largest = 0.25
    if radius > largest * leg:
        refuse(
            f"foot {name} has a radius of {radius:.6g} m: expected at most a quarter of the leg, "
            f"{largest * leg:.6g} m, since larger feet roll and are no points; make the "
            "sphere smaller, with its centre where the leg should end"
        )


def refuse_frictionless(model: mujoco.MjModel, foot: int, floor: int) -> None:
    """Refuse a foot or floor without friction.

    A plant takes the foot's condim; in the file a floor of higher priority would decide.

    Raises: RobotError if either is 1, which is contact without friction.
    """
    deciding = [foot]
    if model.geom_priority[floor] > model.geom_priority[foot]:
        deciding.append(floor)
    for geom in deciding:
        if model.geom_condim[geom] == 1:
            name = f"foot {model.geom(geom).name}" if geom == foot else "the floor"
            refuse(f'{name} has condim="1", contact without friction: give it condim="3"')


def refuse_odd_contact(model: mujoco.MjModel, foot: int, floor: int) -> None:
    """Check the contact parameters of a foot and of the floor.

    Raises: RobotError naming the geom with a negative coefficient or an impossible margin.
    """
    radius = float(model.geom_size[foot, 0])
    for geom in (foot, floor):
        name = f"foot {model.geom(geom).name}" if geom == foot else "the floor"
        friction = model.geom_friction[geom]
        if np.any(friction < 0.0):
            numbers = " ".join(f"{value:g}" for value in friction)
            refuse(
                f'{name} has friction="{numbers}": expected no negative coefficient; write '
                'friction="0.6"'
            )
        margin, gap = float(model.geom_margin[geom]), float(model.geom_gap[geom])
        if not 0.0 <= margin <= radius or not 0.0 <= gap <= margin + radius:
            refuse(
                f"{name} has margin {margin:g} and gap {gap:g} m: expected 0 to the foot's radius, "
                f"{radius:g} m; leave both out"
            )


def refuse_odd_keyframes(text: str, model: mujoco.MjModel) -> None:
    """Check that every keyframe lists all coordinates; MuJoCo fills short ones with zeros.

    Args:
        text: MJCF that compiles.
        model: compiled from it.

    Raises: RobotError naming the keyframe and how many numbers it must have, or the line that
    is no XML: MuJoCo's own reader accepts some of those.
    """
    try:
        root = ElementTree.fromstring(text)
    except ElementTree.ParseError as error:
        raise RobotError(
            f"the robot file is not well-formed XML ({error}): mend that line"
        ) from None
    # Attributes of a <key>, and the count of numbers that each lists.
    counts = {"qpos": "nq", "qvel": "nv", "ctrl": "nu"}
    for number, key in enumerate(root.iterfind("keyframe/key")):
        label = key.get("name") or f"number {number}"
        for attribute, count in counts.items():
            expected = int(getattr(model, count))
            length = len(key.get(attribute, "").split())
            if attribute in key.attrib and length != expected:
                refuse(
                    f"keyframe {label} has {length} numbers in {attribute}: expected {expected}, "
                    f"one for each of its {'motors' if count == 'nu' else 'coordinates'}; mend or "
                    "remove it"
                )


def _label(model: mujoco.MjModel, kind: str, row: int) -> str:
    """Name an element of the file for a message."""
    kinds = {
        "body": mujoco.mjtObj.mjOBJ_BODY,
        "jnt": mujoco.mjtObj.mjOBJ_JOINT,
        "geom": mujoco.mjtObj.mjOBJ_GEOM,
        "actuator": mujoco.mjtObj.mjOBJ_ACTUATOR,
        "key": mujoco.mjtObj.mjOBJ_KEY,
    }
    words = {"jnt": "joint", "actuator": "motor", "key": "keyframe"}
    if kind == "dof":
        kind, row = "jnt", int(model.dof_jntid[row])
    name = mujoco.mj_id2name(model, kinds[kind], row)
    return f"{words.get(kind, kind)} {name or f'number {row}'}"
