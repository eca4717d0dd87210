"""Data of a proof's model for readers that derive the dynamics on their own.

Numbers of links and policy are float64 in hexadecimal; arrays that the Program carries by name are
referred to by that name. Nothing derived from the links is stored: no mass matrix, no coefficient
of a position. Such a reader shares no formula with the Program.
"""

from typing import Any

import numpy as np

from neuralgaits.barriers import GaitSpec
from neuralgaits.certificate.proof_file.array_tables import array_table, hexes
from neuralgaits.gait import NO_RESIDUALS, HybridInvariantPolicy, MLPPolicy, Residuals
from neuralgaits.gait.commands import Command
from neuralgaits.gait.flow_residual import Residual
from neuralgaits.gait.policies.commanded import CommandedPolicy
from neuralgaits.gait.policies.commanded_gait import AnyGait
from neuralgaits.gait.policy import AbstractPolicy
from neuralgaits.gait.reset_residual import ResetResidual
from neuralgaits.gait.tubes import CommandedTube
from neuralgaits.programs import Program
from neuralgaits.robots.derive import LegData, TorsoData
from neuralgaits.robots.mjcf.loader import links_from_text
from neuralgaits.robots.robot_file import RobotFile
from neuralgaits.runs import plain

_NETWORK_POLICY = ("lower", "upper", "input_scale", "input_shift")
_ARRAYS = {
    HybridInvariantPolicy: (*_NETWORK_POLICY, "z_guard", "z_start", "cubic"),
    MLPPolicy: (*_NETWORK_POLICY, "start_and_guard"),
    CommandedPolicy: (*_NETWORK_POLICY, "guard_outputs", "guard_slopes", "guard_z1", "curves"),
}
"""Fields that desired outputs depend on, beside the network."""


def model_data(
    robot: RobotFile,
    gait: AnyGait,
    spec: GaitSpec,
    program: Program,
    residuals: Residuals = NO_RESIDUALS,
) -> dict[str, Any] | None:
    """Return the object "model" of a proof file.

    "robot": a leg from the lowest link up, each link with the joint at its upper end; "torso" or
    null; gravity, friction, foot radius; "sole" if the lowest link is a flat foot. A centre of mass
    is "along" the line from the lower to the upper joint (a torso's: from the hip upwards) and
    "across" it, counter-clockwise; SI. "policy", "tube": arrays, each {"shape", "values"} or
    {"constant": name in the Program}; "commands" of a policy that takes some, with their ranges and
    largest changes or null. "regions": boxes of the chart. "conditions": by name, as in
    `GaitSpec.describe`. "residuals": of flow and reset, arrays or null; only if something was
    learned.

    Returns: plain data; None for a policy or a residual that is not one of this package's.
    """
    policy, learned = _policy(gait.policy, program), _residuals(residuals)
    if policy is None or learned is None:
        return None
    described = plain(spec.describe())
    leg, torso = links_from_text(robot.layout.xml, robot.name)
    tube = gait.tube
    span = None if isinstance(tube, CommandedTube) else tube.span
    arrays = {"lower": tube.lower, "upper": tube.upper, "unit": tube.unit, "span": span}
    return {
        "robot": _robot(robot, leg, torso),
        "policy": policy,
        "tube": array_table("tube", arrays, program.parameters),
        "regions": {
            name: [{"low": hexes(box["low"]), "high": hexes(box["high"])} for box in boxes]
            for name, boxes in described["regions"].items()
        },
        "conditions": {row.pop("name"): row for row in described["conditions"]},
        **({"residuals": learned} if any(learned.values()) else {}),
    }


def _robot(robot: RobotFile, leg: LegData, torso: TorsoData | None) -> dict[str, Any]:
    names = ("length", "mass", "inertia", "armature", "damping", "torque_limit", "lower", "upper")
    links = []
    for place, com in enumerate(leg.com):
        row = {name: float(getattr(leg, name)[place]).hex() for name in names}
        links.append(row | _centre(com))
    trunk = None
    if torso is not None:
        trunk = {"mass": float(torso.mass).hex(), "inertia": float(torso.inertia).hex()}
        trunk |= _centre(torso.com)
    return {
        "name": robot.name,
        "leg": links,
        "torso": trunk,
        "gravity": float(robot.gravity).hex(),
        "friction": float(robot.friction).hex(),
        "foot_radius": float(robot.foot_radius).hex(),
        **_sole(robot),
    }


def _sole(robot: RobotFile) -> dict[str, Any]:
    if robot.feet is None:
        return {}
    feet = robot.feet
    return {"sole": {"heel": float(feet.heel).hex(), "toe": float(feet.toe).hex()}}


def _centre(com: complex) -> dict[str, str]:
    return {"along": float(np.real(com)).hex(), "across": float(np.imag(com)).hex()}


def _policy(policy: AbstractPolicy, program: Program) -> dict[str, Any] | None:
    kind = type(policy)
    if kind not in _ARRAYS or not isinstance(
        policy, HybridInvariantPolicy | MLPPolicy | CommandedPolicy
    ):
        return None
    arrays = {name: getattr(policy, name) for name in _ARRAYS[kind]}
    arrays |= _layers(policy.network)
    return {
        "kind": kind.__name__,
        "activation": policy.network.activation,
        "layers": len(policy.network.weights),
        "z2_dependence": bool(getattr(policy, "z2_dependence", True)),
        "arrays": array_table("policy", arrays, program.parameters),
        **_ankle(policy, program),
        **({"commands": [_command(one) for one in policy.commands]} if policy.commands else {}),
    }


def _ankle(policy: AbstractPolicy, program: Program) -> dict[str, Any]:
    """Return the torque of a stance ankle as data, if the policy has one."""
    ankle = getattr(policy, "ankle", None)
    if ankle is None:
        return {}
    arrays = {name: getattr(ankle, name) for name in ("most", "input_scale", "input_shift")}
    arrays |= _layers(ankle.network)
    return {
        "ankle": {
            "layers": len(ankle.network.weights),
            "arrays": array_table("policy.ankle", arrays, program.parameters),
        }
    }


def _command(command: Command) -> dict[str, Any]:
    change = command.largest_change
    return {
        "name": command.name,
        "low": float(command.low).hex(),
        "high": float(command.high).hex(),
        "largest_change": None if change is None else float(change).hex(),
    }


def _residuals(residuals: Residuals) -> dict[str, Any] | None:
    """Return the learned residuals as data; None if `fit` does not learn their kind."""
    tables: dict[str, Any] = {"flow": None, "reset": None}
    kinds = {"flow": Residual, "reset": ResetResidual}  # Kinds of residual that `fit` learns.
    fields = {
        "flow": ("scale", "shift", "bound"),
        "reset": ("weight", "offset", "scale", "shift", "bound"),
    }
    for part, learned in residuals._asdict().items():
        if learned is None:
            continue
        if type(learned) is not kinds[part]:
            return None
        arrays = {name: getattr(learned, name) for name in fields[part]}
        tables[part] = {"arrays": arrays}
        if part == "flow":
            arrays |= _layers(learned.network)
            tables[part]["layers"] = len(learned.network.weights)
        tables[part]["arrays"] = array_table("residuals", arrays, {})
    return tables


def _layers(network: Any) -> dict[str, Any]:
    """Return the arrays of a network by name."""
    return {
        f"network.{what}[{layer}]": array
        for what in ("weights", "biases")
        for layer, array in enumerate(getattr(network, what))
    }
