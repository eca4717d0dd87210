"""Cart-poles from MJCF files: what is read, and every reason why a file is none, at once."""

from collections.abc import Iterator
from pathlib import Path

import mujoco
import numpy as np

from neuralgaits.errors import RobotError
from neuralgaits.robots.mjcf.compiled import compile_text
from neuralgaits.robots.mjcf.model_contents import HINGE, SLIDE, at_zero, joint_label
from neuralgaits.robots.mjcf.physical_numbers import refuse_unphysical
from neuralgaits.systems import mjcf_problems as problems
from neuralgaits.systems.acceleration_comparison import ComparedRanges, difference_from_mujoco
from neuralgaits.systems.cartpole.cartpole_data import CartPoleData
from neuralgaits.systems.cartpole.cartpole_model import CartPole
from neuralgaits.systems.mjcf_contents import joint_kinds, model_name, planar_link

BUILT_IN = "cartpole"


def is_cartpole(source: object) -> bool:
    """Return whether a robot is meant for this family: the built-in, or a file with one slide."""
    if str(source) == BUILT_IN:
        return not Path(BUILT_IN).exists()
    kinds = joint_kinds(str(source))
    return kinds.count("slide") == 1 and len(kinds) <= 3


def read_cartpole(text: str, name: str) -> tuple[CartPole, CartPoleData]:
    """Read a cart-pole from MJCF text. Raises: RobotError with all that stands in the way."""
    model = compile_text(text, name)
    refuse_unphysical(model)
    if problems := [*_problems_of_tree(model)] or [*_problems(model)]:
        raise RobotError(f"{name} is no cart-pole that can be treated: {'; '.join(problems)}")
    data = _data(model)
    if not data.distance > 0.0:
        raise RobotError(f"{name}: expected the pole's mass away from its hinge, found it there")
    joints = data.joint_map(model)
    if not data.lean > 0.0:
        low, high = model.jnt_range[joints.joints[1]]
        raise RobotError(
            f"{name}: expected the upright, {data.upright:.4g} rad, within the range of the pole's "
            f"hinge, found {low:.4g} to {high:.4g} rad: widen it"
        )
    robot = data.model("")
    rates = ((0.0, 0.0), (0.8, -1.7), (-1.3, 2.1))  # Of slide [m/s] and hinge [rad/s].
    ranges = ComparedRanges((robot.rail, robot.lean), rates, robot.force_limit)
    if different := difference_from_mujoco(model, joints, ranges, robot.accelerations):
        share, (x, theta, *_) = different
        raise RobotError(
            f"{name}: expected the accelerations of a cart-pole from MuJoCo, found others (by "
            f"{share:.2g} of them at x = {x:.3g} m, theta = {theta:.3g} rad): remove what no "
            "formula here has, such as contacts, gravcomp, flags that switch forces off, "
            "polynomials, a joint's margin, and numbers of the motor beside gear and limits"
        )
    return data.model(model_name(model, name)), data


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
    up, on_slide = -model.opt.gravity, joint_label(model, slide)
    along, around = problems.joint_axis(model, slide), problems.joint_axis(model, hinge)
    straight = 1e-9  # Largest cosine between directions that are at right angles.
    if abs(along @ up) > straight * np.linalg.norm(up):
        yield f'joint {on_slide} is not level: give it an axis such as "1 0 0"'
    elif max(abs(around @ up) / np.linalg.norm(up), abs(around @ along)) > straight:
        name = joint_label(model, hinge)
        yield f'joint {name} turns out of the rail\'s plane: use an axis such as "0 1 0"'
    if not model.jnt_limited[slide]:
        yield f'joint {on_slide} has no range, the rail: add range="-1.8 1.8" or its own'
    yield from problems.joint_problems(model, slide)
    yield from problems.joint_problems(model, hinge)
    yield from problems.timestep_problems(model)
    yield from problems.contact_problems(model)
    yield from problems.world_problems(model)
    yield from problems.motor_problems(model, slide, "the cart", "the pole")


def _data(model: mujoco.MjModel) -> CartPoleData:
    slide, hinge, data = _joint(model, SLIDE), _joint(model, HINGE), at_zero(model)
    motor = int(np.flatnonzero(model.actuator_trnid[:, 0] == slide)[0])
    gravity = float(np.linalg.norm(model.opt.gravity))
    up = -model.opt.gravity / gravity
    along = data.xaxis[slide]
    around = data.xaxis[hinge]
    cart, pole = (planar_link(model, data, joint, (along, up)) for joint in (slide, hinge))
    centre = pole.centre
    turn = 1.0 if np.cross(around, up) @ along > 0.0 else -1.0
    upright = -turn * float(np.arctan2(centre[0], centre[1])) + 0.0
    lean = 0.5 * np.pi
    if model.jnt_limited[hinge]:
        low, high = model.jnt_range[hinge]
        # The turn of the upright that is nearest to the range.
        upright += 2.0 * np.pi * round((0.5 * (low + high) - upright) / (2.0 * np.pi))
        lean = min(lean, upright - low, high - upright)
    slide_dof, hinge_dof = model.jnt_dofadr[slide], model.jnt_dofadr[hinge]
    return CartPoleData(
        cart_mass=cart.mass,
        pole_mass=pole.mass,
        distance=float(np.linalg.norm(centre)),
        pole_inertia=pole.inertia,
        cart_armature=float(model.dof_armature[slide_dof]),
        pole_armature=float(model.dof_armature[hinge_dof]),
        cart_damping=float(model.dof_damping[slide_dof]),
        pole_damping=float(model.dof_damping[hinge_dof]),
        gravity=gravity,
        rail_low=float(model.jnt_range[slide, 0]),
        rail_high=float(model.jnt_range[slide, 1]),
        lean=float(lean),
        force_limit=problems.force_limit(model, motor),
        upright=upright,
        turn=turn,
        gear=float(model.actuator_gear[motor, 0] * model.actuator_gainprm[motor, 0]),
        slide=model.joint(slide).name,
        hinge=model.joint(hinge).name,
        motor=model.actuator(motor).name,
    )
