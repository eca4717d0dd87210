"""Cart-poles from MJCF files: what is read, and every reason why a file is none, at once."""

# pyright: reportAttributeAccessIssue=false
# MuJoCo ships no type stubs.

from collections.abc import Iterator
from importlib import resources
from pathlib import Path
from xml.etree import ElementTree

import mujoco
import numpy as np

from neuralgaits._printable import printable, visible
from neuralgaits.errors import RobotError
from neuralgaits.robots.mjcf.compiled import compile_text
from neuralgaits.robots.mjcf.physical_numbers import refuse_unphysical
from neuralgaits.robots.mjcf.text import standalone_text
from neuralgaits.systems.cartpole.against_mujoco import colliding, difference_from_mujoco
from neuralgaits.systems.cartpole.cartpole_data import CartPoleData
from neuralgaits.systems.cartpole.cartpole_model import CartPole

BUILT_IN = "cartpole"
SLIDE, HINGE = int(mujoco.mjtJoint.mjJNT_SLIDE), int(mujoco.mjtJoint.mjJNT_HINGE)
ON_JOINT = (int(mujoco.mjtTrn.mjTRN_JOINT), int(mujoco.mjtTrn.mjTRN_JOINTINPARENT))
STRAIGHT = 1e-9
"""Largest cosine between directions that are at right angles."""
SHORTEST_S, LONGEST_S = 1e-5, 0.05
"""Least and largest timestep: fewer steps a second do not balance, more take for ever."""
UPRIGHT = 0.5 * np.pi
"""Largest angle from the upright, where the pole is level [rad]."""


def is_cartpole(source: object) -> bool:
    """Return whether a robot is meant for this family: the built-in, or a file with one slide."""
    if str(source) == BUILT_IN:
        return not Path(BUILT_IN).exists()
    try:
        path = Path(str(source))
        if not path.is_file() or path.suffix.lower() not in (".xml", ".mjcf"):
            return False
        root = ElementTree.fromstring(standalone_text(path))
    except (RobotError, OSError, ValueError, ElementTree.ParseError):
        return False  # The reader of walkers says what is wrong.
    kinds = [joint.get("type", "hinge") for joint in root.iter("joint") if _in_body(joint, root)]
    return kinds.count("slide") == 1 and len(kinds) <= 3


def _in_body(joint: ElementTree.Element, root: ElementTree.Element) -> bool:
    return any(joint in list(body) for body in root.iter("body"))


def cartpole_text(source: str | Path) -> tuple[str, str]:
    """Return the MJCF text of the built-in cart-pole or of a file, and a name for it.

    Raises: RobotError if the file cannot be read.
    """
    if str(source) == BUILT_IN and not Path(BUILT_IN).exists():
        file = resources.files("neuralgaits.systems.cartpole").joinpath(f"{BUILT_IN}.xml")
        return file.read_text(encoding="utf-8"), BUILT_IN
    path = Path(source)
    return standalone_text(path), printable(path.stem)


def read_cartpole(text: str, name: str) -> tuple[CartPole, CartPoleData]:
    """Read a cart-pole from MJCF text. Raises: RobotError with all that stands in the way."""
    model = compile_text(text, name)
    refuse_unphysical(model)
    if problems := [*_problems_of_tree(model)] or [*_problems(model)]:
        raise RobotError(f"{name} is no cart-pole that can be treated: {'; '.join(problems)}")
    data = _data(model)
    if not data.distance > 0.0:
        raise RobotError(f"{name}: expected the pole's mass away from its hinge, found it there")
    if not data.lean > 0.0:
        low, high = model.jnt_range[parts_of(model)[1]]
        raise RobotError(
            f"{name}: expected the upright, {data.upright:.4g} rad, within the range of the pole's "
            f"hinge, found {low:.4g} to {high:.4g} rad: widen it"
        )
    if (found := difference_from_mujoco(model, data, parts_of(model))) is not None:
        share, x, theta = found
        raise RobotError(
            f"{name}: expected the accelerations of a cart-pole from MuJoCo, found others (by "
            f"{share:.2g} of them at x = {x:.3g} m, theta = {theta:.3g} rad): remove what no "
            "formula here has, such as contacts, gravcomp, flags that switch forces off, "
            "polynomials, a joint's margin, and numbers of the motor beside gear and limits"
        )
    own = visible(model.names.split(b"\0")[0].decode(errors="replace"))
    return data.model(name if own in ("", "MuJoCo Model") else own), data


def parts_of(model: mujoco.MjModel) -> tuple[int, int, int]:
    """Return the numbers of slide, hinge and motor of a cart-pole's model."""
    slide = _joint(model, SLIDE)
    return slide, _joint(model, HINGE), int(np.flatnonzero(model.actuator_trnid[:, 0] == slide)[0])


def _joint(model: mujoco.MjModel, kind: int) -> int:
    return int(np.flatnonzero(model.jnt_type == kind)[0])


def _problems_of_tree(model: mujoco.MjModel) -> Iterator[str]:
    """Say where the joints are not those of a cart with a pole."""
    kinds = model.jnt_type
    if len(kinds) != 2 or set(kinds.tolist()) != {SLIDE, HINGE}:
        names = ", ".join(model.joint(k).name or f"joint {k}" for k in range(model.njnt))
        yield f"expected two joints, a slide and a hinge, found {names or 'none'}: delete others"
        return
    cart, pole = (model.jnt_bodyid[_joint(model, kind)] for kind in (SLIDE, HINGE))
    parent = model.body_weldid[model.body_parentid[pole]]
    if parent != model.body_weldid[cart] or model.body_weldid[model.body_parentid[cart]] != 0:
        yield "expected the pole's body inside the cart's, found another order: put it there"


def _problems(model: mujoco.MjModel) -> Iterator[str]:
    """Say what else is not a cart-pole's: ranges, directions, motors, what no formula has."""
    slide, hinge = _joint(model, SLIDE), _joint(model, HINGE)
    names = {joint: model.joint(joint).name or f"number {joint}" for joint in (slide, hinge)}
    up = -model.opt.gravity
    along, around = _axis(model, slide), _axis(model, hinge)
    if abs(along @ up) > STRAIGHT * np.linalg.norm(up):
        yield f'joint {names[slide]} is not level: give it an axis such as "1 0 0"'
    elif max(abs(around @ up) / np.linalg.norm(up), abs(around @ along)) > STRAIGHT:
        yield f'joint {names[hinge]} turns out of the rail\'s plane: use an axis such as "0 1 0"'
    if not model.jnt_limited[slide]:
        yield f'joint {names[slide]} has no range, the rail: add range="-1.8 1.8" or its own'
    for joint, name in names.items():
        dof = model.jnt_dofadr[joint]
        for what, value in (
            ("frictionloss", model.dof_frictionloss[dof]),
            ("stiffness", model.jnt_stiffness[joint]),
            ("a margin", model.jnt_margin[joint]),
        ):
            if value:
                yield f"joint {name} has {what}, which is not modelled: remove it"
        for what, value in (
            ("damping", model.dof_damping[dof]),
            ("armature", model.dof_armature[dof]),
        ):
            if not value >= 0.0:
                yield f"joint {name} has {what} {value:g}, expected 0 or more: mend that number"
    if not SHORTEST_S <= model.opt.timestep <= LONGEST_S:
        yield (
            f"the timestep is {model.opt.timestep:g} s, expected {SHORTEST_S:g} to {LONGEST_S:g}: "
            'use <option timestep="0.002"/>'
        )
    if (pair := colliding(model)) is not None:
        yield (
            f"geoms {pair[0]} and {pair[1]} can collide, which no formula here has: add "
            '<flag contact="disable"/> to <option>, or contype="0" conaffinity="0" to one'
        )
    for count, what in (
        (model.npair, "contact pairs"),
        (model.nflex, "flexible bodies"),
        (_may_sleep(model), "bodies that may sleep"),
        (model.neq, "equality constraints"),
        (model.ntendon, "tendons"),
        (model.opt.density != 0.0 or model.opt.viscosity != 0.0, "air or water"),
    ):
        if count:
            yield f"the file has {what}, which no formula here has: remove it"
    yield from _problems_of_motors(model, slide, names)


def _problems_of_motors(model: mujoco.MjModel, slide: int, names: dict[int, str]) -> Iterator[str]:
    """Say what is not one plain motor with limits on the cart."""
    on_cart = 0
    for motor in range(model.nu):
        name = model.actuator(motor).name or f"actuator {motor}"
        joint = int(model.actuator_trnid[motor, 0])
        on_joint = int(model.actuator_trntype[motor]) in ON_JOINT
        if not on_joint or joint != slide:
            where = f"acts on the pole ({names.get(joint)})" if on_joint else "acts on no joint"
            yield f"motor {name} {where}, expected one on the cart alone: delete it"
            continue
        on_cart += 1
        plain = (
            model.actuator_gaintype[motor] == int(mujoco.mjtGain.mjGAIN_FIXED)
            and model.actuator_biastype[motor] == int(mujoco.mjtBias.mjBIAS_NONE)
            and model.actuator_dyntype[motor] == int(mujoco.mjtDyn.mjDYN_NONE)
        )
        if not plain:
            yield f"actuator {name} is no plain motor: make it <motor>"
        elif _delayed(model, motor):
            yield f"motor {name} has a delay, which no formula here has: remove it"
        elif not 0.0 < _force_limit(model, motor) < np.inf:
            yield (
                f"motor {name} has no limit in both directions, or no gear: add "
                'ctrlrange="-1 1" or its own, and a gear that is not 0'
            )
    if on_cart != 1:
        yield f"expected one motor on the cart, found {on_cart}: keep one"


def _may_sleep(model: mujoco.MjModel) -> bool:
    """Return whether MuJoCo may stop moving what is slow; before 3.4 it never does."""
    sleeps = getattr(mujoco.mjtEnableBit, "mjENBL_SLEEP", None)
    return sleeps is not None and bool(model.opt.enableflags & sleeps)


def _delayed(model: mujoco.MjModel, motor: int) -> bool:
    """Return whether a motor acts late; MuJoCo before 3.4 has no delays."""
    delay = getattr(model, "actuator_delay", None)
    return delay is not None and bool(delay[motor] != 0.0)


def _force_limit(model: mujoco.MjModel, motor: int) -> float:
    """Return the largest force on the cart that the motor has in both directions [N]."""
    gear, gain = model.actuator_gear[motor, 0], model.actuator_gainprm[motor, 0]
    joint, limits = model.actuator_trnid[motor, 0], [np.inf]
    if model.actuator_ctrllimited[motor]:
        low, high = model.actuator_ctrlrange[motor]
        limits.append(abs(gear * gain) * min(-low, high))
    if model.actuator_forcelimited[motor]:
        low, high = model.actuator_forcerange[motor]
        limits.append(abs(gear) * min(-low, high))
    if model.jnt_actfrclimited[joint]:
        low, high = model.jnt_actfrcrange[joint]
        limits.append(min(-low, high))
    return float(min(limits))


def _at_zero(model: mujoco.MjModel) -> mujoco.MjData:
    data = mujoco.MjData(model)
    data.qpos[:] = 0.0
    mujoco.mj_kinematics(model, data)
    return data


def _axis(model: mujoco.MjModel, joint: int) -> np.ndarray:
    return _at_zero(model).xaxis[joint].copy()


def _data(model: mujoco.MjModel) -> CartPoleData:
    (slide, hinge, motor), data = parts_of(model), _at_zero(model)
    gravity = float(np.linalg.norm(model.opt.gravity))
    up, along, around = -model.opt.gravity / gravity, data.xaxis[slide], data.xaxis[hinge]
    masses = {}
    for kind, joint in (("cart", slide), ("pole", hinge)):
        own = model.body_weldid[model.jnt_bodyid[joint]]
        masses[kind] = [b for b in range(1, model.nbody) if model.body_weldid[b] == own]
    pole = masses["pole"]
    weights = model.body_mass[pole]
    places = data.xipos[pole] - data.xanchor[hinge]
    # What lies along the hinge's axis does not count in the plane.
    places = np.stack([places @ along, places @ up], axis=1)
    centre = weights @ places / weights.sum() if weights.sum() > 0.0 else np.zeros(2)
    inertia = 0.0
    for body, place in zip(pole, places, strict=True):
        across = data.ximat[body].reshape(3, 3).T @ around
        inertia += float(across**2 @ model.body_inertia[body])
        inertia += float(model.body_mass[body] * np.sum((place - centre) ** 2))
    turn = 1.0 if np.cross(around, up) @ along > 0.0 else -1.0
    upright = -turn * float(np.arctan2(centre[0], centre[1])) + 0.0
    lean = UPRIGHT
    if model.jnt_limited[hinge]:
        low, high = model.jnt_range[hinge]
        # The turn of the upright that is nearest to the range.
        upright += 2.0 * np.pi * round((0.5 * (low + high) - upright) / (2.0 * np.pi))
        lean = min(lean, upright - low, high - upright)
    slide_dof, hinge_dof = model.jnt_dofadr[slide], model.jnt_dofadr[hinge]
    return CartPoleData(
        cart_mass=float(model.body_mass[masses["cart"]].sum()),
        pole_mass=float(weights.sum()),
        distance=float(np.linalg.norm(centre)),
        pole_inertia=inertia,
        cart_armature=float(model.dof_armature[slide_dof]),
        pole_armature=float(model.dof_armature[hinge_dof]),
        cart_damping=float(model.dof_damping[slide_dof]),
        pole_damping=float(model.dof_damping[hinge_dof]),
        gravity=gravity,
        rail_low=float(model.jnt_range[slide, 0]),
        rail_high=float(model.jnt_range[slide, 1]),
        lean=float(lean),
        force_limit=_force_limit(model, motor),
        upright=upright,
        turn=turn,
        gear=float(model.actuator_gear[motor, 0] * model.actuator_gainprm[motor, 0]),
        slide=model.joint(slide).name,
        hinge=model.joint(hinge).name,
        motor=model.actuator(motor).name,
    )
