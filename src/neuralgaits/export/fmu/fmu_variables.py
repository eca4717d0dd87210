"""Variables of the controller's FMU: names, places, units, descriptions and start values."""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from enum import Enum

import mujoco
import numpy as np

from neuralgaits.analysis.state_monitor import StateMonitor
from neuralgaits.control.safeguard import Fault
from neuralgaits.export.design import Design
from neuralgaits.export.supervisor_codes import Mode, Reason, Request, Waiting, listed
from neuralgaits.gait.commands import CommandLimits


class VariableType(Enum):
    """Type of a variable: its name in FMI 3.0 and in FMI 2.0."""

    REAL = ("Float64", "Real")
    INTEGER = ("Int32", "Integer")
    BOOLEAN = ("Boolean", "Boolean")


class Role(Enum):
    """Part of a variable, by its letter in C: causality and variability."""

    INPUT = ("i", "input", "continuous")
    FIXED = ("p", "parameter", "fixed")
    TUNABLE = ("t", "parameter", "tunable")
    OUTPUT = ("o", "output", "discrete")

    @property
    def letter(self) -> str:
        """Letter in the table of C."""
        return self.value[0]


@dataclass(frozen=True)
class FmuVariable:
    """A variable of the FMU.

    Attributes:
        name: name in the model description.
        place: macro of C; variables that follow each other share one.
        type: its type.
        role: causality and variability.
        start: value before the first tick.
        description: purpose, for a person.
        unit: unit; None without one.
        low, high: range of a command or a choice; None without one.
    """

    name: str
    place: str
    type: VariableType
    role: Role
    start: float | int | bool
    description: str
    unit: str | None = None
    low: float | int | None = None
    high: float | int | None = None


def identifier(name: str, otherwise: str) -> str:
    """Return a name as a part of a structured one: as it is, in quotes, or `otherwise`."""
    if name.isascii() and name.isidentifier():
        return name
    # Characters of a name that the standard accepts between single quotes.
    quotable = re.compile(r"[A-Za-z0-9_ !#$%&()*+,\-./:;<>=?@\[\]^{}|~]+")
    return f"'{name}'" if quotable.fullmatch(name) else otherwise


class JointList:
    """Joints of the legs, each once, in the order of the robot file."""

    def __init__(self, design: Design):
        """List the joints of a design's robot."""
        legs = design.controller.robot.layout.leg_joints
        own = [*legs[0], *(name for name in legs[1] if name not in legs[0])]
        model = mujoco.MjModel.from_xml_string(design.controller.robot.layout.xml)
        self.names: list[str] = sorted(own, key=lambda name: model.joint(name).id)
        self.parts = [identifier(name, f"joint{k}") for k, name in enumerate(self.names)]
        """Parts of variables' names."""
        self.by_leg = [[self.names.index(name) for name in leg] for leg in legs]
        """Number of each leg's joints, lowest first. [2, k]."""


def variables_of(design: Design) -> list[FmuVariable]:
    """Return all variables but time, in the order of their value references within each type."""
    joints = JointList(design)
    variables = [*_inputs(design, joints), *_parameters(design)]
    variables += [*_joint_outputs(joints), *_outputs(design)]
    if design.supervised:
        variables += _supervision()
    if design.monitor is not None:
        variables += _monitor(design.monitor, design.supervised)
    return [one for type in VariableType for one in variables if one.type is type]


def references(variables: Sequence[FmuVariable]) -> dict[str, int]:
    """Return the value reference of each variable by name; 0 is that of the time."""
    return {one.name: k for k, one in enumerate(variables, start=1)}


def _inputs(design: Design, joints: JointList) -> Iterator[FmuVariable]:
    def real(name: str, place: str, unit: str, description: str, start: float = 0.0) -> FmuVariable:
        return FmuVariable(
            name, place, VariableType.REAL, Role.INPUT, start, description, unit=unit
        )

    only = "after the first tick read only if `estimate` is false"
    yield real("pitch", "PITCH", "rad", "pitch of the root, as the robot file has it")
    yield real("pitch_rate", "PITCH_RATE", "rad/s", f"its rate; {only}")
    for axis, about in (("x", "forward"), ("z", "up")):
        text = f"velocity of the root's pitch axis in the world, {about}; {only}"
        yield real(f"velocity.{axis}", "VELOCITY", "m/s", text)
    for leg, foot in enumerate(design.controller.robot.layout.feet):
        text = f"normal force of the ground on {foot}, or a switch times the robot's weight"
        yield real(f"force.{identifier(foot, f'foot{leg}')}", "FORCE", "N", text)
    for name, part in zip(joints.names, joints.parts, strict=True):
        text = f"angle of {name}, signs and zero of the robot file"
        yield real(f"angle.{part}", "ANGLE", "rad", text)
    for name, part in zip(joints.names, joints.parts, strict=True):
        yield real(f"rate.{part}", "RATE", "rad/s", f"rate of {name}; {only}")
    if design.supervised:
        yield FmuVariable(
            "request",
            "REQUEST",
            VariableType.INTEGER,
            Role.INPUT,
            int(Request.DAMP),
            f"request of the operator ({listed(Request)})",
            low=0,
            high=int(max(Request)),
        )
    if design.commands:
        limits = CommandLimits.of(design.commands)
        ranges = zip(design.commands, limits.low, limits.high, strict=True)
        for k, (one, low, high) in enumerate(ranges):
            yield FmuVariable(
                f"command.{identifier(one.name, f'command{k}')}",
                "COMMAND",
                VariableType.REAL,
                Role.INPUT,
                0.5 * (float(low) + float(high)),
                f"requested {one.name}, latched at each touchdown; clamped to its range",
                unit="1" if one.unit == "-" else one.unit,
                low=float(low),
                high=float(high),
            )


def _parameters(design: Design) -> Iterator[FmuVariable]:
    real, limit = VariableType.REAL, float(np.max(design.controller.torque_limit))
    # Stiffness [N m/rad] and damping [N m s/rad] of drives with a loop of their own.
    stiffness, damping = 100.0, 3.0
    drives = "of drives with a loop of their own"
    limited = (
        "torque_limit",
        "TORQUE_LIMIT",
        Role.FIXED,
        limit,
        "largest torque of a joint; the robot file's limit holds where it is lower",
        "N.m",
    )
    texts = (
        ("kp", "KP", Role.TUNABLE, stiffness, f"stiffness {drives}", "N.m/rad"),
        ("kd", "KD", Role.TUNABLE, damping, f"damping {drives}", "N.m.s/rad"),
        ("blend", "BLEND", Role.FIXED, 0.0, "time from holding the first posture to the gait", "s"),
        limited,
    )
    # The supervisor has gains, a way to the first step and a first stance leg of its own.
    for name, place, role, start, text, unit in (limited,) if design.supervised else texts:
        yield FmuVariable(name, place, real, role, start, text, unit=unit)
    laws = ", ".join(f"{k}: {name}" for k, name in enumerate(design.controllers))
    yield FmuVariable(
        "law",
        "LAW",
        VariableType.INTEGER,
        Role.FIXED,
        list(design.controllers).index(design.default_law),
        f"control law ({laws})",
        low=0,
        high=len(design.controllers) - 1,
    )
    feet = " and ".join(
        f"{k} on {foot}" for k, foot in enumerate(design.controller.robot.layout.feet)
    )
    if not design.supervised:
        yield FmuVariable(
            "first_leg",
            "FIRST_LEG",
            VariableType.INTEGER,
            Role.FIXED,
            0,
            f"stance leg at the start ({feet})",
            low=0,
            high=1,
        )
    yield FmuVariable(
        "estimate",
        "ESTIMATE",
        VariableType.BOOLEAN,
        Role.FIXED,
        True,
        "rates and velocity are computed from angles, pitch and contacts; false: inputs give them",
    )


def _joint_outputs(joints: JointList) -> Iterator[FmuVariable]:
    groups = (
        ("torque.{}", "TORQUE", "N.m", "torque of joint {}, sign of the robot file"),
        ("motor.{}", "MOTOR", "N.m", "motor command of joint {}: its torque over its gear"),
        ("target.{}.q_des", "TARGET_ANGLE", "rad", "drive of {}: desired angle"),
        ("target.{}.dq_des", "TARGET_RATE", "rad/s", "drive of {}: desired rate"),
        ("target.{}.kp", "TARGET_KP", "N.m/rad", "drive of {}: stiffness, 0 after a fault"),
        ("target.{}.kd", "TARGET_KD", "N.m.s/rad", "drive of {}: damping"),
        ("target.{}.tau_ff", "TARGET_TORQUE", "N.m", "drive of {}: torque beside its loop"),
    )
    for pattern, place, unit, text in groups:
        for name, part in zip(joints.names, joints.parts, strict=True):
            yield FmuVariable(
                pattern.format(part),
                place,
                VariableType.REAL,
                Role.OUTPUT,
                0.0,
                text.format(name),
                unit=unit,
            )


def _outputs(design: Design) -> Iterator[FmuVariable]:
    real, integer, boolean = VariableType
    out = Role.OUTPUT
    feet = " and ".join(
        f"{k} on {foot}" for k, foot in enumerate(design.controller.robot.layout.feet)
    )
    faults = ", ".join(f"{one.value}: {one.name.lower().replace('_', ' ')}" for one in Fault)
    since = "time since the last touchdown, 1e30 before the first"
    yield FmuVariable("since_touchdown", "SINCE_TOUCHDOWN", real, out, 0.0, since, unit="s")
    text = "z1, the hip ahead of the stance foot"
    yield FmuVariable("hip_ahead", "HIP_AHEAD", real, out, 0.0, text, unit="m")
    text = "z2, angular momentum about the stance foot, forward positive"
    yield FmuVariable("momentum", "MOMENTUM", real, out, 0.0, text, unit="kg.m2/s")
    yield FmuVariable("stance_leg", "STANCE_LEG", integer, out, 0, f"stance leg ({feet})")
    effect = "damping" if design.supervised else "zero torque"
    text = f"reason of {effect} until reset ({faults})"
    yield FmuVariable("fault", "FAULT", integer, out, 0, text)
    text = "whether the stance leg changed at this tick"
    yield FmuVariable("touchdown", "TOUCHDOWN", boolean, out, False, text)
    text = "whether a torque of the law was clipped"
    yield FmuVariable("saturated", "SATURATED", boolean, out, False, text)


def _supervision() -> Iterator[FmuVariable]:
    """Yield the state of the supervisor."""
    texts = (
        ("mode", "MODE", f"what the robot does ({listed(Mode)})"),
        ("reason", "REASON", f"why the mode has changed last ({listed(Reason)})"),
        ("waiting", "WAITING", f"what the request waits for ({listed(Waiting)})"),
    )
    for name, place, text in texts:
        yield FmuVariable(name, place, VariableType.INTEGER, Role.OUTPUT, 0, text)


def _monitor(monitor: StateMonitor, supervised: bool) -> Iterator[FmuVariable]:
    """Return the monitor's answers by level, those of one kind after each other."""
    nameless = "-1: fault, or no walk" if supervised else "-1: fault"
    real, integer, boolean = VariableType
    out = Role.OUTPUT
    for level in monitor.levels:
        text = f"smallest margin of the set of level {level} that counts, negative outside"
        yield FmuVariable(f"monitor.level{level}.margin", "MARGIN", real, out, 0.0, text, unit="1")
    for level in monitor.levels:
        text = f"time outside of the set of level {level} since the start"
        yield FmuVariable(f"monitor.level{level}.outside", "OUTSIDE", real, out, 0.0, text, "s")
    for level in monitor.levels:
        text = f"time since the last tick inside the set of level {level}"
        yield FmuVariable(f"monitor.level{level}.stretch", "STRETCH", real, out, 0.0, text, "s")
    for level in monitor.levels:
        names = ", ".join(f"{k}: {one}" for k, one in enumerate(monitor.set_of(level).names))
        text = f"name of that margin ({nameless}, {names})"
        yield FmuVariable(f"monitor.level{level}.name", "MARGIN_NAME", integer, out, 0, text)
    text = "1: in the proved hold of level 5, 0: later, -1: none is proved"
    yield FmuVariable("monitor.in_time", "IN_TIME", integer, out, 0, text)
    for level in monitor.levels:
        text = f"whether the model's state is in the proved set of level {level}"
        yield FmuVariable(f"monitor.level{level}.inside", "INSIDE", boolean, out, False, text)
    text = "whether the latched commands are those that the proof is about"
    yield FmuVariable("monitor.admissible", "ADMISSIBLE", boolean, out, False, text)
