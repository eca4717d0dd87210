"""Names by role for links and joints whose file names differ by side.

shin_left and shin_right are the two shins; as coordinates they are stance_shin and swing_shin.
"""

import re
from collections.abc import Sequence


def paired_names(first: Sequence[str], second: Sequence[str], kind: str) -> tuple[str, ...]:
    """Name the pairs of two legs' links or joints by the parts that their names share.

    Args:
        first: names of one leg.
        second: names of the other leg, in the same order.
        kind: word to number when two names share nothing.

    Returns: one name for each pair, all different.
    """
    names = []
    for i, (one, other) in enumerate(zip(first, second, strict=True)):
        left, right = re.split(r"[_\-. ]+", one), re.split(r"[_\-. ]+", other)
        same_length = len(left) == len(right)
        common = [a for a, b in zip(left, right, strict=False) if same_length and a == b]
        names.append("_".join(common) or f"{kind}{i + 1}")
    if len(set(names)) < len(names):
        return tuple(f"{kind}{i + 1}" for i in range(len(names)))
    return tuple(names)


def role_names(links: Sequence[str], torso: str | None) -> tuple[str, ...]:
    """Names in the order stance leg upwards, torso, swing leg downwards.

    Args:
        links: names of one leg's links, lowest first.
        torso: name of the torso, or None.

    Returns: one name a link.
    """
    middle = () if torso is None else (torso,)
    stance = tuple(f"stance_{name}" for name in links)
    return stance + middle + tuple(f"swing_{name}" for name in reversed(links))


def coordinate_names(lowest: str, joints: Sequence[str], *, torso: bool) -> tuple[str, ...]:
    """Names of the generalised coordinates.

    Args:
        lowest: name of a leg's lowest link, whose absolute angle is the first coordinate.
        joints: names of one leg's joints, lowest first, hip last.
        torso: whether each leg has a hip joint of its own.

    Returns: one name a coordinate.
    """
    if torso:
        return (f"stance_{lowest}", *role_names(joints, None))
    return (f"stance_{lowest}", *role_names(joints[:-1], joints[-1]))
