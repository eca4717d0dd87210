"""Point feet for a biped with other feet: ankles welded, one small sphere at the end of each leg.

The sphere is placed where the leg ends: at the height of the sole under the ankle, or at the tip
of a shank. Other parts of the lowest link keep shape and mass, but no longer collide with the
floor.
"""

import mujoco
import numpy as np

from neuralgaits.robots.mjcf.edit import MjcfEdit
from neuralgaits.robots.mjcf.foot_geoms import extent, is_flat_foot, touching
from neuralgaits.robots.mjcf.planar_tree import body_name, read_tree
from neuralgaits.robots.mjcf.skeleton import find_legs

_RADIUS_M = 0.003
"""Radius of the feet of the robots that come with the package: contact close to a point [m]."""


def give_point_feet(edit: MjcfEdit) -> None:
    """End both legs in one sphere each.

    Raises: RobotError if the file is no planar tree with two legs, or has no floor.
    """
    ankles = _weld_ankles(edit)
    floor = edit.floor()
    assert floor is not None  # A level one was laid where there was none.
    tree = read_tree(edit.model)
    _, legs, _ = find_legs(tree)
    lowest = [tree.links[leg[0]].bodies for leg in legs]
    met = [touching(edit.model, bodies, floor) for bodies in lowest]
    sphere = mujoco.mjtGeom.mjGEOM_SPHERE
    round_ones = [[g for g in geoms if edit.model.geom_type[g] == sphere] for geoms in met]
    if not ankles and all(len(spheres) == 1 for spheres in round_ones):
        for geoms, (foot,) in zip(met, round_ones, strict=True):
            name_foot(edit, foot)
            picture_only(edit, [geom for geom in geoms if geom != foot])
        return
    if not all(met):
        return  # Nothing says where the leg ends; the loader names the body.
    frictions = [_friction(edit, geoms, floor) for geoms in met]
    friction = min(frictions)
    source = "" if max(frictions) == friction else ", the lower of both feet's"
    for bodies, geoms in zip(lowest, met, strict=True):
        ankle = next((body for body in bodies if body in ankles), None)
        if ankle is None:
            body, place = _tip(edit, geoms)
            where = f"at the lower end of {body_name(edit.model, body)}"
        else:
            body, place = ankle, _under_ankle(edit, ankle, ankles[ankle], geoms)
            where = "under the ankle, at the height of the sole"
        picture_only(edit, geoms)
        _add_sphere(edit, body, place, friction, floor)
        edit.changes[-1] += f" {where}, friction {friction:g}{source}"


def _weld_ankles(edit: MjcfEdit) -> dict[int, np.ndarray]:
    """Remove the ankle joints of flat feet.

    Returns: for the body of each such foot, the place of its ankle in that body's frame [m].
    """
    model = edit.model
    tree = read_tree(edit.model)
    floor = edit.floor()
    _, legs, _ = find_legs(tree, 4)  # At most four links a leg, its foot included.
    ankles, data = {}, edit.at_zero()
    for leg in legs:
        if floor is None or not is_flat_foot(model, data, tree, leg, floor):
            continue
        link, parent = tree.links[leg[0]], tree.links[leg[1]]
        joint, name = link.joint.index, link.joint.name
        body = int(model.jnt_bodyid[joint])
        turn = data.xmat[body].reshape(3, 3)
        ankles[body] = turn.T @ (data.xanchor[joint] - data.xpos[body])
        motors = edit.actuators_of(joint)
        edit.remove(edit.elements.joints[joint])
        edit.say(f"ankle {name}: removed, flat foot {link.name} is welded to {parent.name}")
        edit.drop_actuators(motors, f"its joint {name} is gone")
        edit.drop_references("joint", {name})
        edit.drop_keyframes()
    edit.compile()
    return ankles


def _friction(edit: MjcfEdit, geoms: list[int], floor: int) -> float:
    """Return the sliding friction on the floor of the foot's lowest geom, not of its shank."""
    data, values = edit.at_zero(), edit.model.geom_friction[:, 0]
    foot = min(geoms, key=lambda geom: extent(edit.model, data, [geom])[0][2])
    priorities = edit.model.geom_priority[[foot, floor]]
    if priorities[0] == priorities[1]:
        return float(max(values[foot], values[floor]))
    return float(values[[foot, floor]][int(np.argmax(priorities))])


def _geom_label(model: mujoco.MjModel, geom: int) -> str:
    shape = mujoco.mjtGeom(model.geom_type[geom]).name.removeprefix("mjGEOM_").lower()
    body = body_name(model, int(model.geom_bodyid[geom]))
    return model.geom(geom).name or f"a {shape} of {body}"


def _under_ankle(edit: MjcfEdit, body: int, ankle: np.ndarray, geoms: list[int]) -> np.ndarray:
    """Centre of the sphere in the world at zero coordinates [m]. [3]."""
    data = edit.at_zero()
    place = data.xpos[body] + data.xmat[body].reshape(3, 3) @ ankle
    sole = extent(edit.model, data, geoms)[0][2]
    return np.array([place[0], place[1], sole + _RADIUS_M])


def _tip(edit: MjcfEdit, geoms: list[int]) -> tuple[int, np.ndarray]:
    """Body and world centre of a sphere in the lowest end of the lowest of some geoms."""
    model, data = edit.model, edit.at_zero()
    geom = min(geoms, key=lambda one: extent(model, data, [one])[0][2])
    turn = data.geom_xmat[geom].reshape(3, 3)
    axis = int(np.argmax(np.abs(turn[2])))
    down = -np.sign(turn[2, axis]) * turn[:, axis]
    centre = data.geom_xpos[geom] + turn @ model.geom_aabb[geom, :3]
    reach = model.geom_aabb[geom, 3 + axis] - _RADIUS_M
    return int(model.geom_bodyid[geom]), centre + reach * down


def picture_only(edit: MjcfEdit, geoms: list[int]) -> None:
    """Take contact with the floor from some geoms, which keep shape and mass."""
    if not geoms:
        return
    for geom in geoms:
        edit.elements.geoms[geom].set("contype", "0")
        edit.elements.geoms[geom].set("conaffinity", "0")
    names = ", ".join(_geom_label(edit.model, geom) for geom in geoms)
    edit.say(f"{names}: shape and mass kept, no contact with the floor")


def _add_sphere(edit: MjcfEdit, body: int, place: np.ndarray, friction: float, floor: int) -> None:
    model, data = edit.model, edit.at_zero()
    local = data.xmat[body].reshape(3, 3).T @ (place - data.xpos[body])
    # Nanometres: MuJoCo turns quaternions with rounding.
    local = np.round(local, 9) + 0.0
    # It meets the floor by the floor's own bits, as what stood there did; spheres do not meet.
    kind, affinity = int(model.geom_conaffinity[floor]), 0
    if kind == 0:
        affinity = int(model.geom_contype[floor])
    name = edit.free_name("geom", f"{body_name(model, body)}_point")
    attributes = {
        "name": name,
        "type": "sphere",
        "size": f"{_RADIUS_M:g}",
        "pos": " ".join(f"{value:.10g}" for value in local),
        "mass": "0",
        "contype": str(kind),
        "conaffinity": str(affinity),
        "condim": "3",
        "priority": "1",
        "friction": f"{friction:.10g} 0.005 0.0001",
        # As the shipped robots have it: close to a plastic impact.
        "solref": "0.002 1",
    }
    element = edit.elements.bodies[body]
    edit.insert(element, len(element), "geom", attributes)
    edit.say(f"point foot {name}: sphere of {1e3 * _RADIUS_M:g} mm without mass added")


def name_foot(edit: MjcfEdit, geom: int, what: str = "foot sphere", ending: str = "point") -> None:
    """Name the geom of a foot after its body, if it has no name; `what` says what it is."""
    element = edit.elements.geoms[geom]
    if not element.get("name"):
        body = body_name(edit.model, int(edit.model.geom_bodyid[geom]))
        name = edit.free_name("geom", f"{body}_{ending}")
        element.set("name", name)
        edit.say(f"{what} of {body}: named {name}")
