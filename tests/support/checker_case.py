"""Proof files about random robots and gaits, with conditions of every kind."""

import json
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import equinox as eqx
import jax
import numpy as np

from neuralgaits.barriers import (
    AbstractCondition,
    Barrier,
    Box,
    DiscreteBarrier,
    Equality,
    Fence,
    Gait,
    Inlet,
    Pointwise,
    Tube,
    TubeWidth,
    specs,
)
from neuralgaits.barriers import functions as f
from neuralgaits.barriers.conditions import FencesApart
from neuralgaits.certificate.chart import PLANE_ONLY, Chart
from neuralgaits.certificate.levels.level_search import LevelSets
from neuralgaits.certificate.levels.orbit.theorem import Attraction, OrbitConstants
from neuralgaits.certificate.levels.problems import trace_certificate
from neuralgaits.certificate.levels.walking_set.theorem import WalkingSetConstants
from neuralgaits.certificate.proof_file.model_data import model_data
from neuralgaits.certificate.proof_file.theorem_tables import Theorems
from neuralgaits.certificate.traced import trace_spec
from neuralgaits.gait import HybridInvariantPolicy, MLPPolicy, Network, Residuals
from neuralgaits.gait.commands import LEAN, Command, command_named
from neuralgaits.gait.flow_residual import Residual
from neuralgaits.gait.policies.commanded_gait import AnyGait, CommandedGait
from neuralgaits.gait.reset_residual import ResetResidual
from neuralgaits.programs import POINT, evaluate
from neuralgaits.robots import PlanarBiped, load_robot
from neuralgaits.robots.mjcf.loader import robot_from_text
from neuralgaits.robots.mjcf.parameters import axes_of
from support.random_biped import random_biped

EVERYWHERE = Box((0.0, 0.0), (1.0, 1.0))

POINTWISE = {
    "joint_angles": f.joint_angles,
    "joint_rates": f.joint_rates,
    "torques": f.torques,
    "normal_force": f.normal_force,
    "foot_height": f.foot_height,
    "foot_forward": f.foot_forward,
    "foot_vertical_velocity": f.foot_vertical_velocity,
    "hip_height": f.hip_height,
    "hip_forward": f.hip_forward,
    "hip_speed": f.hip_speed,
    "forward_rate": f.forward_rate,
    "transversal_inertia": f.transversal_inertia,
    "hip_state": f.hip_state,
    "momentum": f.momentum,
    "reset_hip_sum": f.reset_hip_sum,
    "reset_hip": f.reset_hip,
    "output_mismatch": f.output_mismatch,
    "squared_mismatch": f.squared_mismatch,
    "rate_mismatch": f.rate_mismatch,
    "state_mismatch": f.state_mismatch,
    "impulse": f.impulse,
    "normal_impulse": f.normal_impulse,
    "old_foot_lift": f.old_foot_lift,
    "friction_forward": f.friction_forward(0.4),
    "friction_backward": f.friction_backward(0.45),
    "impulse_cone_forward": f.impulse_cone_forward(0.5),
    "impulse_cone_backward": f.impulse_cone_backward(0.55),
    "torque_reserve_lower": f.torque_reserve("lower", 0.9),
    "torque_reserve_upper": f.torque_reserve("upper", 0.8),
    "knee_bend": f.knee_bend((0, 2), (1.0, -1.0), 0.05),
    "foot_above_arc": f.foot_above_arc(0.02),
    "foot_on_circle": f.foot_on_circle((0.05, -0.65), 0.7),
    "parabolic_clearance": f.parabolic_clearance(0.02, 0.17, 0.001),
    "orbital_energy": f.orbital_energy(0.9, 0.3),
    "at_least": f.at_least(f.hip_height, 0.7),
    "after_reset": f.after_reset(f.foot_vertical_velocity),
    "after_reset_force": f.after_reset(f.normal_force),
}
BARRIERS = (
    "joint_angles joint_rates foot_height foot_forward hip_speed hip_state momentum forward_rate"
    " reset_hip_sum output_mismatch squared_mismatch foot_on_circle orbital_energy old_foot_lift"
    " foot_above_arc parabolic_clearance after_reset"
).split()


OF_FEET = {
    "pressure_heel": f.pressure_reserve("heel", 0.9),
    "pressure_toe": f.pressure_reserve("toe", 0.8),
    "ankle_lower": f.ankle_reserve("lower", 0.9),
    "ankle_upper": f.ankle_reserve("upper", 0.8),
    "impulse_heel": f.impulse_reserve("heel", 0.9),
    "impulse_toe": f.impulse_reserve("toe", 0.7),
    "sole_above_arc": f.sole_above_arc(0.02),
    "sole_vertical_velocity": f.sole_vertical_velocity,
    "old_sole_lift": f.old_sole_lift,
    "stance_ankle": f.stance_ankle,
}


def conditions(robot: PlanarBiped):
    """One of every quantity and of every kind."""
    quantities = POINTWISE | ({"torso_angle": f.torso_angle} if robot.torso is not None else {})
    quantities = quantities | (OF_FEET if robot.feet is not None else {})
    found: list[AbstractCondition] = []
    for name, quantity in quantities.items():
        found.append(Pointwise(name, "tube", 2.0, quantity))
    for name in BARRIERS:
        found.append(Barrier(f"{name} rate", "tube", 1.0, quantities[name], (2.0, 7.0)))
    found += [
        Barrier("one gain", "tube", 1.0, f.at_most(f.hip_height, 0.9), 3.0),
        DiscreteBarrier("discrete", "tube", 1.0, f.orbital_energy(0.9), 0.3),
        Equality("equality", "tube", 1.0, f.output_mismatch, 0.1),
        TubeWidth("width", "tube", 1.0, 0.2),
    ]
    for side in ("lower", "upper"):
        found += [Fence(f"fence {side}", "tube", 1.0, side), Inlet(f"in {side}", "tube", 1.0, side)]
    return tuple(found)


@dataclass(frozen=True)
class Case:
    """A robot and a gait, known by a name such as amber3m, torso-2 or legs-3."""

    name: str
    activation: str = "tanh"
    learned: bool = False
    """Whether residuals are added to flow and reset."""

    @property
    def random(self) -> bool:
        """Whether the robot is drawn."""
        return self.name.startswith(("torso-", "legs-"))

    @cached_property
    def robot(self):
        if not self.random:
            return load_robot(self.name)
        kind, links = self.name.split("-")
        return robot_from_text(random_biped(11, int(links), torso=kind == "torso"), self.name)

    @property
    def chart(self) -> Chart:
        """Of what it is a function."""
        return PLANE_ONLY

    def drawn(self, shares: np.ndarray) -> np.ndarray:
        """Chart points at shares of a step, of its level and of further axes. [points, axes]."""
        axes = self.chart.parameters
        low, high = ([0.0, 0.0, *(getattr(a, end) for a in axes)] for end in ("low", "high"))
        high[:2] = 1.0, 1.0
        return np.array(low) + shares * np.subtract(high, low)

    @cached_property
    def gait(self) -> AnyGait:
        """By construction hybrid invariant on the built-in robots, a free network elsewhere."""
        key = jax.random.key(5)
        kind = MLPPolicy if self.random else HybridInvariantPolicy
        policy = kind.init(self.robot, key=key, hidden=(8, 7), activation=self.activation)
        if isinstance(policy, HybridInvariantPolicy) and policy.ankle is not None:
            # An untrained ankle hardly pushes.
            last = policy.ankle.network.weights[-1]
            policy = eqx.tree_at(lambda p: p.ankle.network.weights[-1], policy, 30.0 * last)
        start, guard = (float(end) for end in policy.z1_range)
        span = (1.1 * start, 0.9 * guard) if self.random else None
        tube = Tube.between_energies(
            self.robot, (0.3, 0.6), height=0.9, span=span, start=(start, guard), degree=5, tilt=0.1
        )
        return Gait(policy, tube)

    @property
    def residuals(self) -> Residuals:
        """Of sizes that matter, of flow and reset."""
        if not self.learned:
            return Residuals()
        draw, m = np.random.default_rng(8), self.robot.n - 1
        layers = [(5, 2), (4, 5), (2, 4)]
        weights = tuple(draw.normal(size=shape) for shape in layers)
        biases = tuple(draw.normal(size=rows) for rows, _ in layers)
        scale, shift = np.array([0.2, 9.0]), np.array([0.1, 1.1])
        bounds = np.array([0.05, 3.0]), draw.uniform(0.01, 0.05, size=1 + m)
        flow = Residual(Network(weights, biases, "tanh"), scale, shift, bounds[0])
        weight, offset = draw.normal(size=(1 + m, 2)), draw.normal(size=1 + m)
        return Residuals(flow, ResetResidual(weight, offset, scale, shift, bounds[1]))

    @cached_property
    def spec(self):
        walking = specs.load("walking", self.robot)
        regions = {"tube": (EVERYWHERE,)}
        recipe = replace(walking.recipe, samples={"tube": 4})
        own = conditions(self.robot)
        return replace(
            walking, name="all", conditions=own, regions=regions, recipe=recipe, weights={}
        )

    @cached_property
    def program(self):
        return trace_spec(self.spec, self.robot, self.gait, self.residuals)

    def values(self, u: np.ndarray) -> dict[str, np.ndarray]:
        """Margins of the conditions' Python functions at points. [points, elements] each."""
        values = evaluate(self.program, {"u": u}, POINT)
        return {name: value.reshape(len(u), -1) for name, value in values.items()}

    @cached_property
    def table(self) -> dict[str, Any]:
        """A proof file; what it claims need not be true."""
        claim = {
            "conditions": ["width"],
            "region": "tube",
            "scales": {"width": 1.0},
            "bounds": {"width": 0.0},
            "degree": 2,
            "root": {
                "low": ["0x0p0", "0x0p0", *(a.low.hex() for a in self.chart.parameters)],
                "high": ["0x1p0", "0x1p0", *(a.high.hex() for a in self.chart.parameters)],
            },
            "tree": "-",
        }
        return {
            "format": 3,
            "kind": "neuralgaits certificate",
            "robot": {"name": self.name, "sha256": "0"},
            "weights_sha256": "0",
            "spec": {"name": "all", "sha256": "0"},
            "program": json.loads(self.program.to_json()),
            "program_hash": self.program.hash,
            "chart": self.chart.table(),
            "statements": [claim],
            "theorems": self.theorems,
            "model": model_data(self.robot, self.gait, self.spec, self.program, self.residuals),
        }

    @property
    def theorems(self) -> list[dict[str, Any]]:
        return []

    def write(self, path: Path) -> Path:
        path.write_text(json.dumps(self.table))
        return path


@dataclass(frozen=True)
class SetCase(Case):
    """The outputs of levels 2 and 3, for sets around nothing in particular.

    Attributes:
        disturbance: of the walking set.
        attraction: of the orbit.
    """

    disturbance: tuple[float, float] = (0.0, 0.0)
    attraction: Attraction = "contraction"

    @cached_property
    def sets(self) -> LevelSets:
        assert isinstance(self.gait, Gait)
        tube = self.gait.tube
        low, high = (np.asarray(side) * float(tube.unit) for side in (tube.lower, tube.upper))
        thin = [tuple((low + share * (high - low)).tolist()) for share in (0.4, 0.6)]
        rates = [tuple(row) for row in np.random.default_rng(4).normal(size=(3, 4)).tolist()]
        pushed = WalkingSetConstants(
            0.01, 0.008, 0.1, 0.8, self.disturbance, ("lean", "bent", "brisk"), ()
        )
        orbit = OrbitConstants(self.attraction, 0.99, 1.01, thin[0], thin[1], *rates)
        return LevelSets({2: pushed, 3: orbit})

    @cached_property
    def spec(self):
        found = super().spec
        own = (
            Barrier("lean", "tube", 1.0, f.hip_height, 3.0),
            Barrier("bent", "tube", 1.0, f.joint_angles, (2.0, 7.0)),
            Barrier("brisk", "tube", 1.0, f.hip_speed, 3.0),
            TubeWidth("width", "tube", 1.0, 0.2),
        )
        return replace(found, conditions=own)

    @cached_property
    def program(self):
        return trace_certificate(self.spec, self.robot, self.gait, self.sets, self.residuals)

    @property
    def theorems(self) -> list[dict[str, Any]]:
        return list(Theorems(self.sets.parameters).tables())


def chart_table(*more: tuple[str, float, float]) -> list[dict[str, str]]:
    """The chart of a proof file: phase, level, and further axes (name, low, high)."""
    axes = (("phase", -0.05, 1.05), ("level", 0.0, 1.0), *more)
    return [{"name": name, "low": low.hex(), "high": high.hex()} for name, low, high in axes]


def holds(answer) -> bool:
    """Whether all that a file states was confirmed; a file of some statements is undecided."""
    last = (answer.stdout.splitlines() or [""])[-1]
    part = answer.returncode == 3 and last.startswith("undecided: every statement holds")
    return part or (answer.returncode == 0 and last.startswith("proved "))


def bounds(
    proofcheck, file: Path, low: np.ndarray, high: np.ndarray, *options: str
) -> list[dict[str, Any]]:
    """The checker's enclosures of all margins over boxes. Each: name to [elements, 2] or None."""
    boxes = np.concatenate([low, high], axis=1)
    lines = "\n".join(" ".join(float(x).hex() for x in box) for box in boxes)
    answer = proofcheck(*options, "--bounds", file, text=lines)
    assert answer.returncode == 0, answer.stdout[-500:] + answer.stderr
    found = []
    for block in answer.stdout.strip().split("\n\n"):
        table: dict[str, Any] = {}
        for line in block.splitlines():
            name, *rest = line.split("\t")
            if len(rest) == 1:
                table[name] = None
            else:
                table.setdefault(name, []).append([float.fromhex(x) for x in rest[1:]])
        found.append({k: None if v is None else np.array(v) for k, v in table.items()})
    return found


@dataclass(frozen=True)
class ToldCase(Case):
    """A gait that is told commands, with the outputs of levels 2 and 3.

    Attributes:
        commands: that it is told.
    """

    commands: tuple[Command, ...] = ()

    @cached_property
    def gait(self) -> CommandedGait:
        """An untrained family, moved so that no coefficient is zero."""
        draw = np.random.default_rng(3)
        found = specs.commanded(self.robot, self.commands).new_gait(
            jax.random.key(5), "posture", (8, 7)
        )
        assert isinstance(found, CommandedGait)

        def moved(size: float):
            return lambda leaf: np.asarray(leaf) + size * draw.normal(size=np.shape(leaf))

        p, sizes = found.policy, (0.02, 0.05, 0.002, 0.02)
        leaves = (p.guard_outputs, p.guard_slopes, p.guard_z1, p.curves)
        policy = eqx.tree_at(
            lambda p: (p.guard_outputs, p.guard_slopes, p.guard_z1, p.curves),
            p,
            tuple(moved(size)(leaf) for size, leaf in zip(sizes, leaves, strict=True)),
        )
        tube = eqx.tree_at(
            lambda t: (t.lower, t.upper),
            found.tube,
            tuple(map(moved(0.002), (found.tube.lower, found.tube.upper))),
        )
        return CommandedGait(policy, tube)

    @property
    def chart(self) -> Chart:
        """With two axes a command, and how far the robot is from a lean that it is told."""
        return Chart.of(self.commands, self.spec.parameters)

    @cached_property
    def spec(self):
        leans = command_named(self.commands, LEAN) is not None
        near = axes_of(self.robot, {LEAN: 0.003}) if leans else ()
        found = replace(super().spec, commands=self.commands, parameters=near)
        return found.with_conditions(FencesApart("apart", "tube", 0.1))

    @cached_property
    def sets(self) -> LevelSets:
        """For sets around nothing in particular."""
        names = tuple(one.name for one in self.commands)
        held = ("one gain", "joint_angles rate")
        return LevelSets(
            {
                2: WalkingSetConstants(0.01, 0.008, 0.1, 0.8, (0.02, 0.3), held, (), names),
                3: OrbitConstants("any two walks", expansion=(0.1, -0.2, 0.3)),
            }
        )

    @cached_property
    def program(self):
        return trace_certificate(self.spec, self.robot, self.gait, self.sets, self.residuals)

    @property
    def theorems(self) -> list[dict[str, Any]]:
        return list(Theorems(self.sets.parameters).tables())
