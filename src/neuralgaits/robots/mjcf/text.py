"""The text of a robot file, made independent of the folder that holds it.

A run keeps a copy of its robot file. So includes are put in place, and asset files (meshes,
textures: pictures only) get absolute paths. MuJoCo's own writer would do the same but rounds
numbers to six digits. A file that needs neither is kept word for word, comments included.
"""

import os
from pathlib import Path
from xml.etree import ElementTree

from neuralgaits._inputs import no_file_at, refuse_unreadable
from neuralgaits._printable import printable
from neuralgaits.errors import RobotError, reason
from neuralgaits.robots.mjcf.refuse_or_note import refuse


def standalone_text(path: Path, dropped: list[str] | None = None) -> str:
    """Read an MJCF file and resolve what it refers to.

    Args:
        path: path of the file.
        dropped: takes the names of pictures that are not there, which are left out then; without
            such a list they are refused.

    Returns: MJCF text that compiles from any folder on this machine.
    Raises: RobotError if a file is missing, unreadable or not XML.
    """
    text = _read(path)
    root = _parse(text, path)
    touched = _include(root, path.parent, including=(path.resolve(),))
    touched |= _absolute_assets(root, path.parent, dropped)
    return ElementTree.tostring(root, encoding="unicode") if touched else text


def urdf_text(path: Path) -> str | None:
    """Return the text of a URDF file; None of any other, which `standalone_text` reads.

    Raises: RobotError if the file is unreadable or not XML.
    """
    text = _read(path)
    try:
        root = ElementTree.fromstring(text)
    except ElementTree.ParseError as error:
        if "xacro" in text:
            raise RobotError(
                f"{path.name} has xacro macros: expand it first, `xacro FILE > OUT.urdf`"
            ) from None
        raise RobotError(f"{path.name} is not well-formed XML ({error}): mend that line") from None
    if root.tag != "robot":
        return None
    if "xacro:" in text or any("xacro" in str(one.tag) for one in root.iter()):
        raise RobotError(f"{path.name} has xacro macros: expand it first, `xacro FILE > OUT.urdf`")
    return text


def _read(path: Path) -> str:
    refuse_unreadable(path)
    try:
        return path.read_text(encoding="utf-8")
    except FileNotFoundError:
        raise RobotError(f"no robot file at {path}: check the path") from None
    except (OSError, ValueError) as error:
        raise RobotError(f"cannot read {path} ({reason(error)}): give an MJCF text file") from None


def _parse(text: str, path: Path) -> ElementTree.Element:
    try:
        root = ElementTree.fromstring(text)
    except ElementTree.ParseError as error:
        raise RobotError(f"{path.name} is not well-formed XML ({error}): mend that line") from None
    if root.tag == "robot":
        raise RobotError(
            f"{path.name} starts with <robot>: expected MJCF, whose root is <mujoco>, found a URDF"
            ": give an MJCF file"
        )
    if root.tag not in ("mujoco", "mujocoinclude"):
        raise RobotError(
            f"{path.name} starts with <{root.tag}>: expected MJCF, whose root is <mujoco>"
        )
    return root


def _include(
    element: ElementTree.Element, folder: Path, including: tuple[Path, ...], depth: int = 0
) -> bool:
    """Replace every <include> below `element`; paths start at the main file's folder."""
    # Limit on nested elements: bodies of a leg are four deep, and readers here are recursive.
    most_nested = 100
    if depth > most_nested:
        raise RobotError(
            f"{including[-1].name} has more than {most_nested} elements in one another, here "
            f"<{element.tag}>: mend what made the file"
        )
    touched = False
    for index, child in reversed(list(enumerate(element))):
        if child.tag != "include":
            touched |= _include(child, folder, including, depth + 1)
            continue
        path = folder / child.get("file", "")
        if path.resolve() in including:
            raise RobotError(f"{path.name} includes itself: remove that <include>")
        if not path.is_file():
            problem = "it names no file"
            if child.get("file"):
                problem = f"{path} is {no_file_at(path, 'not there')}"
            refuse(
                f"expected the file that {including[-1].name} includes, found that {problem}: "
                "put it "
                "there, or remove that <include>"
            )
            element.remove(child)
            touched = True
            continue
        included = _parse(_read(path), path)
        _include(included, folder, (*including, path.resolve()), depth + 1)
        element.remove(child)
        for offset, grandchild in enumerate(included):
            element.insert(index + offset, grandchild)
        touched = True
    return touched


def missing_asset(kind: str, path: Path | str) -> str:
    """Return the error message for a missing picture file, with its remedy."""
    return (
        f"expected a {kind} file at {path}, found {no_file_at(Path(path), 'none')}: put it there, "
        f"or remove its <{kind}> from <asset> and what shows it; bodies with an <inertial> need no "
        "picture"
    )


def _absolute_assets(root: ElementTree.Element, folder: Path, dropped: list[str] | None) -> bool:
    options: dict[str, str] = {}
    for compiler in root.iter("compiler"):
        options |= compiler.attrib
    touched = False
    folders = {"mesh": "meshdir", "skin": "meshdir", "hfield": "meshdir", "texture": "texturedir"}
    for asset in root.iter("asset"):
        for entry in list(asset):
            if entry.tag not in folders or "file" not in entry.attrib:
                continue
            below = options.get(folders[entry.tag], options.get("assetdir", ""))
            path = (folder / below / entry.attrib["file"]).resolve()
            if not path.is_file():
                if dropped is None:
                    refuse(missing_asset(entry.tag, path))
                else:
                    dropped.append(printable(path.name))
                _drop_asset(root, asset, entry, bare=dropped is not None)
                touched = True
                continue
            entry.set("file", _in_utf8(entry.tag, path))
            touched = True
    return touched


def _drop_asset(
    root: ElementTree.Element,
    asset: ElementTree.Element,
    entry: ElementTree.Element,
    *,
    bare: bool,
) -> None:
    """Remove an asset and the geoms that show it, so that the rest of the file can be read.

    Args:
        root: root element of the file.
        asset: section that has the asset.
        entry: the asset.
        bare: whether the file will be used without it, so that no mass may depend on it.
    """
    asset.remove(entry)
    name = entry.get("name", Path(entry.get("file", "")).stem)
    for parent in list(root.iter()):
        for child in list(parent):
            if child.get(entry.tag) != name:
                continue
            if child.tag != "geom":
                del child.attrib[entry.tag]
                continue
            parent.remove(child)
            massless = child.get("mass") == "0" or parent.find("inertial") is not None
            if bare and parent.tag == "body" and not massless:
                refuse(
                    f"body {parent.get('name', 'without a name')} has its mass from {entry.tag} "
                    f"{name}, whose file is not there: put it there, or give the body an <inertial>"
                )


def _in_utf8(kind: str, path: Path) -> str:
    """Return a path as XML has it. Raises: RobotError if it is not UTF-8, which MuJoCo needs."""
    text = printable(path)
    if text.encode() != os.fsencode(path):
        raise RobotError(
            f"expected a {kind} file whose path is UTF-8, found {text}: rename what is not"
        )
    return text
