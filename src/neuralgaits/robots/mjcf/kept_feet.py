"""Flat feet of a robot file, kept with their ankles: only they meet the floor."""

from neuralgaits.errors import RobotError
from neuralgaits.robots.mjcf.edit import MjcfEdit
from neuralgaits.robots.mjcf.foot_geoms import is_flat_foot, touching
from neuralgaits.robots.mjcf.planar_tree import read_tree
from neuralgaits.robots.mjcf.point_feet import name_foot, picture_only
from neuralgaits.robots.mjcf.skeleton import find_legs


def keep_flat_feet(edit: MjcfEdit) -> None:
    """Name the soles of both feet, and take contact with the floor from everything else.

    Raises: RobotError if the file is no planar tree with two legs that end in flat feet.
    """
    floor = edit.floor()
    data = edit.at_zero()
    tree = read_tree(edit.model)
    assert floor is not None  # A level one was laid where there was none.
    _, legs, _ = find_legs(tree, 3)  # At most three links a leg, its foot included.
    soles = []
    for leg in legs:
        link = tree.links[leg[0]]
        if not is_flat_foot(edit.model, data, tree, leg, floor):
            raise RobotError(f"body {link.name} is no flat foot on an ankle: leave --feet flat out")
        for geom in touching(edit.model, link.bodies, floor):
            name_foot(edit, geom, "sole", "sole")
            soles.append(geom)
    bodies = tuple(range(1, edit.model.nbody))
    picture_only(edit, [g for g in touching(edit.model, bodies, floor) if g not in soles])
