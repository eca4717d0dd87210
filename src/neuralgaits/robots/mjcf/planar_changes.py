"""Changes of a robot file that is planar already, one step each, every change said in one line.

Numbers that only the user knows, as torque limits and joint ranges, are not made up.
"""

from collections.abc import Callable

import mujoco

from neuralgaits.robots.mjcf.edit import MjcfEdit
from neuralgaits.robots.mjcf.joint_motors import choose_motor, said_of
from neuralgaits.robots.mjcf.planar_tree import body_name
from neuralgaits.robots.mjcf.refused_physics import refuse_loops


def _name_joints(edit: MjcfEdit) -> None:
    """Name joints that have no name, since logs and controllers find joints by name."""
    for joint, element in enumerate(edit.elements.joints):
        if not element.get("name"):
            body = body_name(edit.model, int(edit.model.jnt_bodyid[joint]))
            name = edit.free_name("joint", f"{body}_joint")
            element.set("name", name)
            edit.say(f"joint of {body}: named {name}")


def _name_motors(edit: MjcfEdit) -> None:
    for element in edit.elements.actuators:
        if not element.get("name") and element.get("joint"):
            name = edit.free_name("actuator", element.get("joint", ""))
            element.set("name", name)
            edit.say(f"motor of joint {element.get('joint')}: named {name}")


def _drop_couplings(edit: MjcfEdit) -> None:
    """Remove couplings between links other than joints and motors: tendons, constraints, pairs."""
    model = edit.model
    refuse_loops(model)
    if model.ntendon:
        names = {model.tendon(i).name for i in range(model.ntendon)}
        edit.drop_section("tendon", f"{model.ntendon} tendons, which the closed form ignores")
        edit.drop_references("tendon", names)
    if model.neq:
        edit.drop_section("equality", f"{model.neq} constraints, which the closed form ignores")
    if model.npair:
        edit.drop_section("contact", "the feet meet the floor by their own friction")
    elif model.nexclude:
        why = "nothing but the feet meets anything"
        edit.drop_section("contact", f"excludes, since {why}")


def _free_the_root(edit: MjcfEdit) -> None:
    """Replace a free joint by the slides and the hinge that act in the plane."""
    model = edit.model
    free = [i for i in range(model.njnt) if model.jnt_type[i] == mujoco.mjtJoint.mjJNT_FREE]
    if len(free) != 1:
        return
    joint, element = free[0], edit.elements.joints[free[0]]
    body = int(model.jnt_bodyid[joint])
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    into_body = data.xmat[body].reshape(3, 3).T
    parent, place = edit.parent_and_place(element)
    name = element.get("name", "root")
    edit.remove(element)
    axes = (("x", "slide", (1, 0, 0)), ("z", "slide", (0, 0, 1)), ("pitch", "hinge", (0, 1, 0)))
    names = []
    for offset, (label, kind, axis) in enumerate(axes):
        names.append(edit.free_name("joint", f"{name}_{label}"))
        attributes = {"name": names[-1], "type": kind, "pos": "0 0 0"}
        attributes["axis"] = " ".join(f"{value:.17g}" for value in into_body @ axis)
        edit.insert(parent, place + offset, "joint", attributes | _FREE)
    edit.drop_references("joint", {name})
    edit.say(f"free joint {name}: replaced by {', '.join(names)}, which move in the plane x, z")
    edit.drop_keyframes()


_FREE = {
    "limited": "false",
    "damping": "0",
    "armature": "0",
    "stiffness": "0",
    "frictionloss": "0",
    "ref": "0",
}
"""Attributes of a root joint that nothing holds, whatever the file's defaults."""


def _drop_motors_of_the_root(edit: MjcfEdit) -> None:
    model = edit.model
    for joint in range(model.njnt):
        body = int(model.jnt_bodyid[joint])
        if model.body_weldid[model.body_parentid[body]] == 0:
            why = f"root joint {model.joint(joint).name} must be free"
            edit.drop_actuators(edit.actuators_of(joint), why)


def _keep_one_motor(edit: MjcfEdit) -> None:
    """Keep the motor of each joint, or make one of its servo, and remove other actuators."""
    model, gone = edit.model, list[int]()
    for joint in range(model.njnt):
        choice = choose_motor(model, joint, edit.actuators_of(joint))
        for line in said_of(model, model.joint(joint).name, choice):
            edit.say(line)
        gone += choice.removed
        if choice.kept is not None and choice.limit is not None:
            element = edit.elements.actuators[choice.kept]
            attributes = {
                key: element.get(key, "") for key in ("name", "joint") if key in element.attrib
            }
            limit = {"ctrlrange": f"{-choice.limit:.17g} {choice.limit:.17g}", "gear": "1"}
            element.tag = "motor"
            element.attrib.clear()
            element.attrib.update(
                attributes | limit | {"ctrllimited": "true", "forcelimited": "false"}
            )
            edit.drop_keyframes()
    for number in gone:
        name = edit.elements.actuators[number].get("name", "")
        edit.remove(edit.elements.actuators[number])
        edit.drop_references("actuator", {name} - {""})
    if gone:
        edit.drop_keyframes()


def _drop_forces(edit: MjcfEdit) -> None:
    """Remove springs, dry friction, air and every force that holds the root."""
    model = edit.model
    for joint, element in enumerate(edit.elements.joints):
        dof, name = int(model.jnt_dofadr[joint]), model.joint(joint).name
        body = int(model.jnt_bodyid[joint])
        forces: list[tuple[str, bool]] = [
            ("stiffness", bool(model.jnt_stiffness[joint])),
            ("frictionloss", bool(model.dof_frictionloss[dof])),
        ]
        root = model.body_weldid[model.body_parentid[body]] == 0
        if root:
            forces += [
                ("damping", bool(model.dof_damping[dof].any())),
                ("armature", bool(model.dof_armature[dof])),
                ("limited", bool(model.jnt_limited[joint])),
            ]
        for attribute, present in forces:
            if present:
                element.set(attribute, _FREE[attribute])
                why = "the root is free" if root else "the closed form ignores it"
                what = "range" if attribute == "limited" else attribute
                edit.say(f"joint {name}: {what} taken out, {why}")
    for option in edit.root.iter("option"):
        for attribute in ("density", "viscosity"):
            if float(option.get(attribute, "0")):
                option.set(attribute, "0")
                edit.say(f"{attribute} of the air taken out")
    for body, element in enumerate(edit.elements.bodies):
        if model.body_gravcomp[body]:
            element.set("gravcomp", "0")
            edit.say(f"body {body_name(model, body)}: gravity compensation taken out")


def _lay_floor(edit: MjcfEdit) -> None:
    if edit.floor() is not None:
        return
    name = edit.free_name("geom", "floor")
    attributes = {
        "name": name,
        "type": "plane",
        "size": "0 0 0.1",
        "contype": "1",
        "conaffinity": "1",
    }
    world = edit.elements.bodies[0]
    edit.insert(world, 0, "geom", attributes)
    edit.say(f"level floor added: geom {name} at height 0")


def _drop_sensors_of_the_floor(edit: MjcfEdit) -> None:
    """Remove sensors of the file's floor, since a simulation lays floors of its own."""
    planes = {
        edit.model.geom(geom).name
        for geom in range(edit.model.ngeom)
        if edit.model.geom_type[geom] == mujoco.mjtGeom.mjGEOM_PLANE
    }
    edit.drop_references("geom", planes - {""})


BEFORE_FEET: tuple[Callable[[MjcfEdit], None], ...] = (
    _name_joints,
    _drop_couplings,
    _free_the_root,
    _drop_motors_of_the_root,
    _keep_one_motor,
    _drop_forces,
    _lay_floor,
)
AFTER_FEET = (_name_motors, _drop_sensors_of_the_floor)
"""Changes in order, before and after those of the feet: joints get names before they are referred
to, and the feet stand on the floor."""
