"""Shapes of a URDF: boxes, cylinders, spheres, and the meshes that are there."""

from pathlib import Path
from xml.etree import ElementTree

import numpy as np

from neuralgaits.robots.mjcf.refuse_or_note import refuse
from neuralgaits.robots.mjcf.urdf_values import attribute, numbers, orientation

Element = ElementTree.Element


class Shapes:
    """Writes the shapes of links, and remembers which meshes were left out."""

    def __init__(self, robot: Element, folder: Path, asset: Element):
        """Start without any.

        Args:
            robot: root element of the URDF.
            folder: folder that holds the file.
            asset: section of the new file that meshes are named in.
        """
        self._folder, self._asset = folder, asset
        self._left_out: list[str] = []
        self._count = 0

    def said(self) -> list[str]:
        """Return one line about meshes left out; none if there are none."""
        if not self._left_out:
            return []
        most_names = 4
        more = len(self._left_out) - most_names
        names = ", ".join(self._left_out[:most_names]) + (f" and {more} more" if more > 0 else "")
        return [f"meshes not there, or not STL or OBJ, left out: {names}; masses are as given"]

    def write(self, body: Element, link: Element, name: str) -> None:
        """Write the collision shapes of a link, and its pictures if it has no others."""
        solid = self._geoms(body, link, "collision", name)
        if not solid:
            self._geoms(body, link, "visual", name)

    def _geoms(self, body: Element, link: Element, kind: str, name: str) -> int:
        count = 0
        for part in link.findall(kind):
            attributes = self._shape(part.find("geometry"), name)
            if attributes is None:
                continue
            place, turn = orientation(part.find("origin"), f"link {name}")
            attributes |= {"pos": numbers(place), "quat": numbers(turn), "mass": "0"}
            if kind == "visual":
                attributes |= {"contype": "0", "conaffinity": "0"}
            ElementTree.SubElement(body, "geom", attributes)
            count += 1
        return count

    def _shape(self, geometry: Element | None, name: str) -> dict[str, str] | None:
        owner = f"link {name}"
        for shape in () if geometry is None else geometry:
            if shape.tag == "mesh":
                return self._mesh(shape, owner)
            size = _size(shape, owner)
            if size is None:
                continue
            if not np.all(np.array(size) > 0.0):
                refuse(f"{owner} has a {shape.tag} of no size: mend its numbers")
                return None
            return {"type": str(shape.tag), "size": numbers(size)}
        return None

    def _mesh(self, shape: Element, owner: str) -> dict[str, str] | None:
        named = shape.get("filename", "")
        file = _file_of(named, self._folder)
        if file is None:
            self._left_out.append(named.rpartition("/")[2] or "one without a name")
            return None
        self._count += 1
        scale = attribute(shape, "scale", (1.0, 1.0, 1.0), owner)
        mesh = f"mesh_{self._count}"
        attributes = {"name": mesh, "file": str(file), "scale": numbers(scale)}
        ElementTree.SubElement(self._asset, "mesh", attributes | {"inertia": "shell"})
        return {"type": "mesh", "mesh": mesh}


def _size(shape: Element, owner: str) -> list[float] | None:
    """Return MuJoCo's size of a box, cylinder, capsule or sphere; None of anything else."""
    if shape.tag == "box":
        return [float(side) / 2.0 for side in attribute(shape, "size", (0.0,) * 3, owner)]
    if shape.tag == "sphere":
        return [float(attribute(shape, "radius", (0.0,), owner)[0])]
    if shape.tag in ("cylinder", "capsule"):
        ends = (float(attribute(shape, key, (0.0,), owner)[0]) for key in ("radius", "length"))
        radius, length = ends
        return [radius, length / 2.0]
    return None


def _file_of(named: str, folder: Path) -> Path | None:
    """Return the file that a URDF names, also by package://; None if it is not there."""
    plain = named.removeprefix("file://")
    below = plain
    if plain.startswith("package://"):
        below = plain.removeprefix("package://").partition("/")[2]
    if Path(below).suffix.lower() not in (".stl", ".obj"):
        return None
    for start in (folder, *folder.absolute().parents[:3]):
        try:
            if (start / below).is_file():
                return (start / below).resolve()
        except (OSError, ValueError):
            return None
    return None
