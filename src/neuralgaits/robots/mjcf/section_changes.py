"""The lines that say what a sagittal section left out or welded."""

import mujoco

from neuralgaits.robots.mjcf.planar_tree import body_name
from neuralgaits.robots.mjcf.section_plan import SectionPlan


def lines_about_plan(
    model: mujoco.MjModel,
    plan: SectionPlan,
    named: dict[str, float],
    root: tuple[str, ...],
) -> list[str]:
    """Return one line about each kind of change.

    Args:
        model: the robot of the file.
        plan: which joints are kept.
        named: joints that the user named for welding, and their coordinates (rad or m).
        root: names of the new root joints.
    """
    count = len(plan.legs[0])
    lines = [f"written anew as a sagittal section: a torso and two legs of {count} joints each"]
    if len(plan.legs[1]) != count:
        lines = ["written anew as a sagittal section: two legs that hang from each other"]
    lines += _about_root(model, plan, root)
    if plan.across:
        lines.append(f"welded at zero, not turning in the plane: {_joints(model, plan.across)}")
    if plan.others:
        lines.append(f"welded at zero, no part of a leg: {_joints(model, plan.others)}")
    if named:
        where = f"at keyframe {model.key(0).name or 'number 0'}" if model.nkey else "at zero"
        listed = ", ".join(f"{name} ({value:.4g})" for name, value in named.items())
        lines.append(f"welded as named, {where}: {listed}")
    spread = abs(model.body_ipos[:, 1]).max() > 0.0 or abs(model.body_pos[:, 1]).max() > 0.0
    if spread:
        lines.append("lateral offsets of masses dropped: every link is seen from the side")
    return lines + _about_forces(model, plan) + _about_rest(model)


def _about_root(model: mujoco.MjModel, plan: SectionPlan, root: tuple[str, ...]) -> list[str]:
    base, names = body_name(model, plan.base), ", ".join(root)
    if not plan.root:
        return [f"base {base} was fixed to the world: {names} added, so that it moves in the plane"]
    old = [model.joint(joint).name for joint in plan.root]
    if old == list(root):
        return []
    bodies = {int(model.jnt_bodyid[joint]) for joint in plan.root}
    chain = f", of {len(bodies)} bodies," if len(bodies) > 1 else ""
    listed = ", ".join(name or "one without a name" for name in old)
    lines = [
        f"root joint{'s' * (len(old) > 1)} {listed}{chain} replaced by {names} of body {base}, "
        "which move in the plane x, z"
    ]
    if plan.carriages:
        mass = float(model.body_mass[list(plan.carriages)].sum())
        listed = ", ".join(body_name(model, body) for body in plan.carriages)
        lines.append(
            f"{listed}, between the world and {base}: {mass:.4g} kg welded to {base}; on a rail "
            "that mass moves otherwise, so take it out of the file if it is one"
        )
    return lines


def _about_forces(model: mujoco.MjModel, plan: SectionPlan) -> list[str]:
    lines = []
    for joint in (*plan.legs[0], *plan.legs[1]):
        dof, name = int(model.jnt_dofadr[joint]), model.joint(joint).name
        if model.jnt_stiffness[joint]:
            lines.append(f"joint {name}: stiffness taken out, the closed form ignores it")
        if model.dof_frictionloss[dof]:
            friction = f"{float(model.dof_frictionloss[dof]):.4g} N m"
            lines.append(
                f"joint {name}: dry friction (frictionloss) of {friction} taken out, the closed "
                "form "
                "ignores it"
            )
    return lines


def _about_rest(model: mujoco.MjModel) -> list[str]:
    """Return a line about what is not taken over."""
    counts = {
        "contact exclude": model.nexclude,
        "contact pair": model.npair,
        "equality constraint": model.neq,
        "tendon": model.ntendon,
        "sensor": model.nsensor,
        "keyframe": model.nkey,
        "camera": model.ncam,
        "mesh": model.nmesh,
        "site": model.nsite,
    }
    rest = [
        f"{count} {what}{'' if count == 1 else 'es' if what == 'mesh' else 's'}"
        for what, count in counts.items()
        if count
    ]
    return [f"not taken over: {', '.join(rest)}"] if rest else []


def _joints(model: mujoco.MjModel, joints: tuple[int, ...]) -> str:
    return ", ".join(model.joint(joint).name or f"number {joint}" for joint in joints)
