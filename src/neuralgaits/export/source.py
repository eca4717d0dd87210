"""The files written for one gait: `gait.h` with its facts, `gait.c` with its functions."""

import numpy as np

from neuralgaits.control import AbstractLaw, Fblin, Pd
from neuralgaits.control.fblin import SMALLEST_DENOMINATOR
from neuralgaits.control.safeguard import joint_ranges, torque_rate
from neuralgaits.errors import InputError
from neuralgaits.export.facts import Design
from neuralgaits.export.programs import parts
from neuralgaits.interpreters.c99 import emit
from neuralgaits.interpreters.c99_tables import Tables, braces, literal
from neuralgaits.interpreters.c99_writer import Emitted


def gait_files(design: Design) -> dict[str, str]:
    """Text of `gait.h` and `gait.c`.

    Raises: SpecError naming the primitive of a policy that C cannot express, InputError for a
    law that is not one of this package.
    """
    tables = Tables("ng")
    functions = [
        emit(part.program, part.function, part.about, tables)
        for part in parts(design.robot, design.gait.policy)
    ]
    data = _arrays(design)
    return {"gait.h": _header(design, functions, data), "gait.c": _code(design, functions, tables)}


def _header(design: Design, functions: list[Emitted], data: dict[str, np.ndarray]) -> str:
    declared = [
        f"extern const ng_real {_declaration(name, array)};" for name, array in data.items()
    ]
    prototypes = [f"{function.prototype};" for function in functions]
    lines = [
        _about(design),
        "#ifndef NG_GAIT_H",
        "#define NG_GAIT_H",
        "",
        '#include "ng_math.h"',
        "",
        *(f"#define {name} {value}" for name, value in _names(design).items()),
        "",
        "/* Numbers with units. */",
        *(f"#define {name} {value} /* {unit} */" for name, value, unit in _numbers(design)),
        "",
        "/* Arrays: see gait.c for units. */",
        *declared,
        "",
        "/* Written from the Programs of the gait. */",
        *prototypes,
        "",
        "#endif",
    ]
    return "\n".join(lines) + "\n"


def _about(design: Design) -> str:
    """The comment at the top: what it is, joint order, limits, gains, hashes."""
    robot, origin, layout = design.robot, design.origin, design.robot.layout
    lines = [
        f"A walking gait of {robot.name}, spec {origin.spec}, by neuralgaits {origin.version}.",
        "Written by a program: change the gait, not this file.",
        "",
        f"robot file  sha256 {origin.robot_sha256}",
        f"policy      sha256 {origin.policy_sha256}",
        f"proof       {_proof(design)}",
        "",
        "Coordinates q, stance leg first [rad]: " + ", ".join(robot.joint_names),
        "Actuated are all but the first.",
        "",
        "Joints of each leg as in the robot file, lowest first; leg 0, then leg 1:",
    ]
    low, high = joint_ranges(robot)
    limit = np.abs(design.by_leg(design.controller.torque_limit))
    for leg, names in enumerate(layout.leg_joints):
        for i, name in enumerate(names):
            lines.append(
                f"  [{leg}][{i}] {name}, motor {layout.actuators[leg][i]}: "
                f"{low[leg][i]:.4g} to {high[leg][i]:.4g} rad, torque at most "
                f"{limit[leg][i]:.4g} N m"
            )
    lines += ["", f"Ticks of {design.controller.period_s:g} s. Laws:"]
    for name, controller in design.controllers.items():
        lines.append(f"  {name}: {_gains(controller.law)}")
    lines += [
        "",
        "z = (hip ahead of the stance foot [m], angular momentum about it [kg m^2/s]), both",
        "positive forward. Angles are positive counter-clockwise, with forward to the right.",
    ]
    return "\n".join(["/*", *(f" * {line}".rstrip() for line in lines), " */"])


def _proof(design: Design) -> str:
    origin = design.origin
    if origin.proof_sha256 is None:
        return "none"
    return f"sha256 {origin.proof_sha256}, {origin.proof_verdict}"


def _gains(law: AbstractLaw) -> str:
    rate = f"policy asked every {law.hold_ticks} ticks"
    if isinstance(law, Pd):
        told = "" if law.measure_z2 else ", told z2 = 0"
        return f"{law.stiffness:g} N m/rad, {law.damping:g} N m s/rad, {rate}{told}"
    if isinstance(law, Fblin):
        return f"input-output linearisation, {law.bandwidth:g} rad/s, {rate}"
    raise InputError(
        f"expected a law of this package (pd, fblin, paper), found {type(law).__name__}: C is "
        "written for those"
    )


def _names(design: Design) -> dict[str, str]:
    """Macros without a unit."""
    robot, origin = design.robot, design.origin
    sizes = {
        "NG_ROBOT": f'"{robot.name}"',
        "NG_ROBOT_SHA256": f'"{origin.robot_sha256}"',
        "NG_POLICY_SHA256": f'"{origin.policy_sha256}"',
        "NG_PROOF_SHA256": f'"{origin.proof_sha256 or ""}"',
        "NG_COORDINATES": robot.n,
        "NG_ACTUATED": robot.n - 1,
        "NG_LEGS": 2,
        "NG_LEG_JOINTS": design.leg_joints,
        "NG_HAS_TORSO": int(robot.torso is not None),
        "NG_LAW_COUNT": len(design.controllers),
    }
    indices = {f"NG_LAW_{name.upper()}": i for i, name in enumerate(design.controllers)}
    return {name: str(value) for name, value in (sizes | indices).items()}


def _numbers(design: Design) -> list[tuple[str, str, str]]:
    """Macros with a unit: name, value, unit."""
    robot, controller, safe = design.robot, design.controller, design.safeguard
    stance, layout = controller.stance, design.robot.layout
    weight = float(robot.mass * robot.gravity)
    pitch = safe.largest_pitch
    reals = [
        ("NG_PERIOD", controller.period_s, "of a control tick [s]"),
        ("NG_TOUCHDOWN_FORCE", stance.force_share * weight, "on the swing foot [N]"),
        ("NG_TOUCHDOWN_ADVANCE", stance.advance_share * robot.leg_length, "of the swing foot [m]"),
        ("NG_LOCKOUT", stance.lockout_s, "after a touchdown [s]"),
        (
            "NG_SMALLEST_DENOMINATOR",
            SMALLEST_DENOMINATOR * float(robot.mass) * robot.leg_length,
            "that is divided by [kg m]",
        ),
        ("NG_PITCH_SIGN", layout.pitch_sign, "of the file's pitch"),
        ("NG_ROOT_ANGLE", layout.root_angle, "up-angle of the root at pitch 0 [rad]"),
        ("NG_ROOT_TO_HIP_X", layout.root_to_hip[0], "pitch axis to hip at pitch 0 [m]"),
        ("NG_ROOT_TO_HIP_Z", layout.root_to_hip[1], "[m]"),
        ("NG_TORQUE_RATE", torque_rate(controller, safe), "largest change of a torque [N m/s]"),
        ("NG_HOLD_STIFFNESS", safe.hold_stiffness, "while blending [N m/rad]"),
        ("NG_HOLD_DAMPING", safe.hold_damping, "while blending [N m s/rad]"),
        ("NG_LARGEST_PITCH", pitch, "either way [rad]"),
        ("NG_ANGLE_MARGIN", safe.angle_margin, "beyond the joint ranges [rad]"),
        ("NG_LARGEST_RATE", safe.largest_rate, "of a joint or the pitch [rad/s]"),
        ("NG_LARGEST_SPEED", safe.largest_speed, "of the hip [m/s]"),
        ("NG_LARGEST_FORCE", safe.force_share * weight, "on a foot [N]"),
        ("NG_CONTACT_FORCE", safe.contact_share * weight, "a foot on the ground feels more [N]"),
        ("NG_AIRBORNE", safe.airborne_s, "both feet in the air [s]"),
    ]
    rows = [(name, literal(float(value)), unit) for name, value, unit in reals]
    return [*rows, ("NG_GAP_US", f"{round(safe.gap_s * 1e6)}u", "between two readings [us]")]


def _arrays(design: Design) -> dict[str, np.ndarray]:
    """Constant arrays by name."""
    robot, controller, layout = design.robot, design.controller, design.robot.layout
    root = robot.n // 2 - 1 if robot.torso is None else robot.torso
    low, high = joint_ranges(robot)
    bounds = controller.bounds
    arrays = {
        "ng_hip_gradient": robot.hip_gradient,
        "ng_pitch_row": np.stack([robot.link_angles[root], robot.link_angles[robot.n - 1 - root]]),
        "ng_torque_limit": controller.torque_limit,
        "ng_joint_lower": low,
        "ng_joint_upper": high,
        "ng_joint_sign": layout.leg_joint_signs,
        "ng_joint_offset": layout.leg_joint_offsets,
        "ng_gear": layout.gears,
        "ng_z_lower": bounds.lower,
        "ng_z_upper": bounds.upper,
        "ng_z_margin": bounds.margin,
    }
    return {name: np.asarray(array, dtype=np.float64) for name, array in arrays.items()}


_UNITS = {
    "ng_hip_gradient": "z1 = gradient . q [m/rad]",
    "ng_pitch_row": "pitch = row . q for each stance leg",
    "ng_torque_limit": "actuated joints, stance leg first [N m]",
    "ng_joint_lower": "by leg [rad]",
    "ng_joint_upper": "by leg [rad]",
    "ng_joint_sign": "of the file's joints, by leg",
    "ng_joint_offset": "angle where the file's is zero, by leg [rad]",
    "ng_gear": "joint torque per motor command, by leg [N m]",
    "ng_z_lower": "the policy knows z between these (m, kg m^2/s)",
    "ng_z_upper": "(m, kg m^2/s)",
    "ng_z_margin": "what it is told levels off within this much more (m, kg m^2/s)",
}


def _code(design: Design, functions: list[Emitted], tables: Tables) -> str:
    arrays = [
        f"/* {_UNITS[name]} */\nconst ng_real {_declaration(name, array)} = {braces(array)};"
        for name, array in _arrays(design).items()
    ]
    sections = [
        "/* Data and functions of the gait described in gait.h. Written by a program. */",
        '#include "controller.h"',
        *arrays,
        _laws(design),
        "/* Constants of the Programs; matrices stand column by column. */",
        *tables.texts.values(),
        *(function.body for function in functions),
    ]
    return "\n\n".join(sections) + "\n"


def _laws(design: Design) -> str:
    rows = [f"    {_law(name, c.law)}," for name, c in design.controllers.items()]
    return "\n".join(["const ng_law ng_laws[NG_LAW_COUNT] = {", *rows, "};"])


def _law(name: str, law: AbstractLaw) -> str:
    values = [f'.name = "{name}"', f".hold_ticks = {law.hold_ticks}"]
    if isinstance(law, Pd):
        values += [
            ".kind = NG_JOINT_PD",
            f".stiffness = {literal(law.stiffness)}",
            f".damping = {literal(law.damping)}",
            f".measure_z2 = {int(law.measure_z2)}",
        ]
    elif isinstance(law, Fblin):
        values += [
            ".kind = NG_LINEARISING",
            f".bandwidth = {literal(law.bandwidth)}",
            ".measure_z2 = 1",
        ]
    return "{" + ", ".join(values) + "}"


def _declaration(name: str, array: np.ndarray) -> str:
    return name + "".join(f"[{n}]" for n in array.shape)
