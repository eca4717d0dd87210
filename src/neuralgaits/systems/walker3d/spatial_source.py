"""Which robot files are meant for the family of bipeds in three dimensions."""

from pathlib import Path
from xml.etree import ElementTree

from neuralgaits.errors import RobotError
from neuralgaits.robots.mjcf.text import standalone_text

BUILT_IN = "walker3d"


def is_spatial(source: object) -> bool:
    """Return whether a robot is the built-in one, or a file with three slides."""
    if str(source) == BUILT_IN:
        return not Path(BUILT_IN).exists()
    try:
        path = Path(str(source))
        if not path.is_file() or path.suffix.lower() not in (".xml", ".mjcf"):
            return False
        root = ElementTree.fromstring(standalone_text(path))
    except (RobotError, OSError, ValueError, ElementTree.ParseError):
        return False  # The reader of walkers says what is wrong.
    joints = [joint for body in root.iter("body") for joint in body.findall("joint")]
    slides = [joint for joint in joints if joint.get("type", "hinge") == "slide"]
    # Walkers in a plane have two slides; a free joint is theirs to take a section of.
    return len(slides) == 3 and len(joints) > len(slides) + 2
