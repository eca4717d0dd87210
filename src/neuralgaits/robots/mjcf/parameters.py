"""Robots that differ from a file in masses, centres of mass, inertias and rotors, link by link.

Each type of link (torso, thigh, shin) and of joint (hip, knee) has errors of its own; both legs
have the same, so the result is a `PlanarBiped` again. Its constants are linear in few numbers a
link (mass, first moments, mass times squared offset), so a family is one matrix, and a
member of it can be traced: masses are then inputs of a Program.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple, TypeVar

import equinox as eqx
import jax.numpy as jnp
import numpy as np

from neuralgaits._names import why_no_name
from neuralgaits._types import Array, Float
from neuralgaits.errors import InputError
from neuralgaits.robots import derive
from neuralgaits.robots.biped import PlanarBiped
from neuralgaits.robots.mjcf.loader import links_from_text, robot_from_text
from neuralgaits.robots.mjcf.with_errors import LinkErrors, text_with_errors
from neuralgaits.robots.parameter_box import GROUND, UNITS, Box, checked_box
from neuralgaits.robots.robot_file import RobotFile


class ParameterAxis(NamedTuple):
    """One parameter: the quantity whose error it is, and its half width."""

    name: str
    half: float


@dataclass(frozen=True)
class _Types:
    """Names of the types of link and of joint, and which type each of them is."""

    links: tuple[str, ...]
    joints: tuple[str, ...]
    link: tuple[int, ...]
    joint: tuple[int, ...]
    torso: bool


def _types(robot: PlanarBiped) -> _Types:
    count, torso = robot.n // 2, robot.torso is not None
    links = [name.removeprefix("stance_") for name in robot.link_names[:count]]
    link = [*range(count), *([count] if torso else []), *reversed(range(count))]
    if robot.torso is not None:
        links.append(robot.link_names[robot.torso])
    joints = [name.removeprefix("stance_") for name in robot.joint_names[1 : 1 + count]]
    row = derive.joint_row(np.arange(count), torso=torso)
    return _Types(
        tuple(_plain_names(links, "link")),
        tuple(_plain_names(joints, "joint")),
        tuple(link),
        tuple(int(i) for i in row),
        torso,
    )


def _plain_names(names: list[str], kind: str) -> list[str]:
    """Return names that a proof file allows, all different."""
    good = all(why_no_name(name) is None and len(name) < 60 for name in names)
    if good and len(set(names)) == len(names):
        return names
    return [f"{kind} {i + 1}" for i in range(len(names))]


def axes_of(robot: PlanarBiped, box: Box) -> tuple[ParameterAxis, ...]:
    """Return the parameters of a box, in the order of the axes of its family."""
    box, types = checked_box(box), _types(robot)
    return tuple(ParameterAxis(name, box[kind]) for kind, name in _names(types) if kind in box)


def _names(types: _Types) -> Iterator[tuple[str, str]]:
    """Return (kind, name) of every parameter that a robot has."""
    relative = "(relative error)"
    for link in types.links:
        yield "mass", f"mass of {link} {relative}"
    for link in types.links:
        for side in ("along", "across"):
            yield "com", f"centre of mass of {link} {side} (error in m)"
    for link in types.links:
        yield "inertia", f"inertia of {link} {relative}"
    for joint in types.joints:
        yield "rotor", f"rotor inertia of {joint} {relative}"
    if types.torso:
        yield "lean", f"lean of {types.links[-1]} beyond the belief (error in m)"


def kinds_of(robot: PlanarBiped, names: tuple[str, ...]) -> tuple[str, ...]:
    """Return the kinds whose parameters have these names, all of each, in order.

    Raises: ValueError if there are none.
    """
    expected = list(_names(_types(robot)))
    kinds = tuple(dict.fromkeys(kind for kind, name in expected if name in names))
    if tuple(name for kind, name in expected if kind in kinds) != names:
        raise ValueError(f"axes that are no parameters of {robot.name}")
    return kinds


def box_of(robot: PlanarBiped, axes: tuple[ParameterAxis, ...]) -> dict[str, float]:
    """Return the box that has these axes. Raises: ValueError if there is none."""
    kinds = kinds_of(robot, tuple(axis.name for axis in axes))
    kind_of_name = {name: kind for kind, name in _names(_types(robot))}
    halves = {(kind_of_name[axis.name], axis.half) for axis in axes}
    if len(halves) > len(kinds):
        raise ValueError(f"axes of one kind of parameter of {robot.name} that differ in width")
    return checked_box(dict(halves))


class RobotFamily(eqx.Module):
    """Robots like one from a file, by the errors of their parameters.

    Attributes:
        nominal: the robot of the file.
        tables: Re C, Im C, Re b and Im b as linear functions of the features of the types of
            link: mass, its products with the offset of the centre of mass along and across,
            and with the offset squared. [n, n, 4 T], [n, n, 4 T], [n, 4 T], [n, 4 T]
        masses: mass of each type of link [kg]. [T]
        link, joint: type of each link and of each actuated joint. [n], [m]
        counts: how many links of each type there are. [T]
        kinds: kinds of the parameters.
    """

    nominal: PlanarBiped
    tables: tuple[
        Float[Array, "n n f"], Float[Array, "n n f"], Float[Array, "n f"], Float[Array, "n f"]
    ]
    masses: Float[Array, " T"]
    counts: Float[Array, " T"]
    link: tuple[int, ...] = eqx.field(static=True)
    joint: tuple[int, ...] = eqx.field(static=True)
    kinds: tuple[str, ...] = eqx.field(static=True)

    @classmethod
    def of(cls, robot: PlanarBiped, kinds: tuple[str, ...]) -> "RobotFamily":
        """The family of a robot.

        Args:
            robot: robot of a file.
            kinds: kinds of parameters, keys of `UNITS`.
        """
        leg, torso = links_from_text(robot.layout.xml, robot.name)
        centre, _, _ = derive.centre_coefficients(leg, torso)
        types = _types(robot)
        masses = np.append(leg.mass, [] if torso is None else torso.mass)
        counts = np.bincount(types.link, minlength=len(masses)).astype(float)
        kinds_kept = tuple(kind for kind in UNITS if kind in kinds and kind not in GROUND)
        return cls(
            robot, _tables(centre, types.link), masses, counts, types.link, types.joint, kinds_kept
        )

    @property
    def size(self) -> int:
        """Number of parameters of the family."""
        sizes = {"com": 2 * len(self.masses), "rotor": len(set(self.joint))}
        return sum(sizes.get(kind, len(self.masses)) for kind in self.kinds)

    def at(self, p: Float[Array, " k"]) -> PlanarBiped:
        """The robot with these errors, in the order of `axes_of`. [size]."""
        mass, com, inertia, rotor = self.split(p)
        robot, links = self.nominal, np.array(self.link)
        masses = self.masses * (1.0 + mass) if mass is not None else jnp.asarray(self.masses)
        squared = jnp.sum(com * com, axis=1)
        parts = [masses, masses * com[:, 0], masses * com[:, 1], masses * squared]
        features = jnp.concatenate(parts)
        if "com" not in self.kinds:
            features = jnp.concatenate([masses, np.zeros(3 * len(masses), p.dtype)])
        inertias = None if inertia is None else robot.inertia * (1.0 + inertia[links])
        armature = robot.armature
        if rotor is not None:
            more = jnp.concatenate([np.zeros(1, p.dtype), rotor[np.array(self.joint)]])
            armature = robot.armature * (1.0 + more)
        across = "com" in self.kinds or robot.coupling_phase is not None
        made = self.with_features(features, masses, across, inertias)
        return made if rotor is None else eqx.tree_at(lambda r: r.armature, made, armature)

    def with_features(
        self,
        features: Float[Array, " f"],
        masses: Float[Array, " T"],
        across: bool,
        inertia: Float[Array, " n"] | None,
    ) -> PlanarBiped:
        """The robot with these features of its types of link."""
        robot = self.nominal
        re_c, im_c, re_b, im_b = (table @ features for table in self.tables)
        values = [
            (lambda r: r.coupling, re_c),
            (lambda r: r.coupling_across, im_c if across else None),
            (lambda r: r.coupling_phase, None),
            (lambda r: r.mass_moment, re_b),
            (lambda r: r.moment_across, im_b if across else None),
            (lambda r: r.mass_moment_phase, None),
            (lambda r: r.mass, self.counts @ masses),
        ]
        if inertia is not None:
            values.append((lambda r: r.inertia, inertia))
        return eqx.tree_at(
            lambda r: tuple(part(r) for part, _ in values),
            robot,
            tuple(value for _, value in values),
            is_leaf=lambda leaf: leaf is None,
        )

    def split(self, p: Float[Array, " k"]):
        """Split errors into masses, centres of mass [T, 2], inertias and rotors; None if absent."""
        count, start = len(self.masses), 0
        parts: dict[str, Float[Array, ...]] = {}
        for kind in self.kinds:
            size = {"com": 2 * count, "rotor": len(set(self.joint))}.get(kind, count)
            parts[kind] = p[start : start + size]
            start += size
        offsets = parts.get("com")
        zero = jnp.zeros((count, 2), p.dtype)
        com = zero if offsets is None else offsets.reshape(count, 2)
        return parts.get("mass"), com, parts.get("inertia"), parts.get("rotor")


Model = PlanarBiped | RobotFamily
"""A robot, or those of a box around it."""
Robot = TypeVar("Robot", bound=RobotFile)
"""A robot of whatever kind: what is made of it is of the same kind."""


def model_of(robot: Robot, axes: tuple[ParameterAxis, ...]) -> Robot | RobotFamily:
    """Return the family that has these parameters; the robot itself without any.

    The lean is added to the one that a gait is told, so it makes no family of its own: see
    `gait.believed_robot`.

    Raises: InputError for parameters of a robot that is no planar biped.
    """
    if not axes:
        return robot
    if not isinstance(robot, PlanarBiped):
        raise InputError(f"expected a planar biped for a box of robots, found {robot.name}")
    kinds = kinds_of(robot, tuple(axis.name for axis in axes))
    return RobotFamily.of(robot, kinds) if kinds and kinds != ("lean",) else robot


def nominal_robot(model: Robot | RobotFamily) -> Robot | PlanarBiped:
    """The robot of the file, which is all that a policy knows."""
    return model.nominal if isinstance(model, RobotFamily) else model


def robot_at(model: Robot | RobotFamily, p: Float[Array, " k"]) -> Robot | PlanarBiped:
    """The robot with these errors. [0] for a model that is one robot."""
    return model.at(p) if isinstance(model, RobotFamily) else model


def _tables(
    centre: np.ndarray, types: tuple[int, ...]
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Compute the dependence of C and b on mass, mass times offset and times its square."""
    n, count = len(types), max(types) + 1
    c, b = np.zeros((n, n, 4, count), complex), np.zeros((n, 4, count), complex)
    for i, kind in enumerate(types):
        row, unit = centre[i], np.eye(n)[i]
        c[:, :, 0, kind] += np.outer(row, row.conj())
        b[:, 0, kind] += row
        for place, way in enumerate((1.0, 1j), start=1):
            c[:, :, place, kind] += np.outer(way * unit, row.conj()) + np.outer(
                row, np.conj(way) * unit
            )
            b[:, place, kind] += way * unit
        c[:, :, 3, kind] += np.outer(unit, unit)
    c, b = c.reshape(n, n, -1), b.reshape(n, -1)
    return np.real(c).copy(), np.imag(c).copy(), np.real(b).copy(), np.imag(b).copy()


def in_its_file(family: RobotFamily, p: Float[np.ndarray, " k"]) -> PlanarBiped:
    """Load a member of the family from a file of its own, which MuJoCo can simulate.

    Raises: InputError if there is no such robot.
    """
    robot, kinds = family.nominal, len(family.masses)
    joints = len(set(family.joint))
    mass, com, inertia, rotor = (
        None if part is None else np.asarray(part) for part in family.split(np.asarray(p))
    )
    errors = LinkErrors(
        mass=np.zeros(kinds) if mass is None else mass,
        com=np.zeros((kinds, 2)) if com is None else com,
        inertia=np.zeros(kinds) if inertia is None else inertia,
        rotor=np.zeros(joints) if rotor is None else rotor,
    )
    return robot_from_text(text_with_errors(robot.layout.xml, errors), robot.name)
