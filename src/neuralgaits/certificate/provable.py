"""Reasons why a proof cannot be made: a gait's policy, its axes, or a user's own conditions."""

import contextlib
from collections.abc import Collection
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import equinox as eqx

from neuralgaits.barriers import AbstractCondition, GaitSpec, Pointwise, spec_file_errors, specs
from neuralgaits.barriers.description import describe_condition
from neuralgaits.barriers.functions import (
    impulse,
    normal_force,
)
from neuralgaits.certificate.chart import PLANE
from neuralgaits.certificate.traced import trace_spec
from neuralgaits.errors import InputError, NeuralGaitsError, SpecError
from neuralgaits.gait.commands import LEAN, Commands, command_named
from neuralgaits.gait.policies.commanded_gait import AnyGait
from neuralgaits.gait.stepping_robot import SteppingRobot
from neuralgaits.programs.program import MOST_AXES
from neuralgaits.runs import plain

if TYPE_CHECKING:
    from neuralgaits.analysis.run import Run


def why_not_provable(gait: AnyGait) -> str | None:
    """Explain why a policy is not smooth, or return None."""
    network = getattr(gait.policy, "network", None)
    if network is None or network.activation != "relu":
        return None
    return "the policy's activation is ReLU, whose derivative jumps: use tanh or softplus"


def why_not_robust(run: "Run") -> str | None:
    """Explain why a run cannot be proved for a box of robots, or return None."""
    if run.learned is not None:
        return "one whose dynamics carry a learned residual, which is of one robot"
    if getattr(run.trained.policy, "z2_dependence", True):
        # On the robot z2 would be computed from masses that nobody knows.
        return "a policy of z1 and z2, and z2 depends on masses that the robot does not know"
    return None


def why_not_of_beliefs(commands: Commands, kinds: Collection[str]) -> str | None:
    """Explain why no proof is about these kinds of parameter of a gait's robot, or return None.

    A robot that learns its lean is never exactly where it believes it to be, so a proof about one
    lean would be about no robot; and only a gait that is told one has a belief to be near to.

    Args:
        commands: commands of the gait.
        kinds: kinds of change, of `parameter_box.UNITS`.
    """
    if command_named(commands, LEAN) is None:
        return None if LEAN not in kinds else "a gait that is told no lean: leave lean out"
    if set(kinds) == {LEAN}:
        return None
    others = ", ".join(kinds) or "none"
    return f"a gait that is told a lean with a box of {others}: give --parameters lean=SIZE alone"


def refuse_many_axes(spec: GaitSpec) -> None:
    """Refuse a spec with more axes than a proof can have. Raises: InputError."""
    if spec.chart_size > MOST_AXES:
        raise InputError(
            f"expected at most {MOST_AXES - PLANE} parameters and axes of commands in all, found "
            f"{spec.chart_size - PLANE}: this robot has that many; leave one of --parameters out"
        )


def refuse_untraceable(
    spec: GaitSpec, robot: SteppingRobot, gait: AnyGait, file: Path | None = None
) -> None:
    """Trace the conditions, with a smooth network in place of a ReLU network.

    Args:
        spec: a user's spec.
        robot: robot for the evaluation.
        gait: gait for the evaluation.
        file: file that defines the spec, if any.

    Raises: SpecError naming the operation and line of a condition that cannot be traced, or what
        is wrong with one that raises.
    """
    if why_not_provable(gait) is not None:
        network = gait.policy.network  # pyright: ignore[reportAttributeAccessIssue]
        smooth = type(network)(network.weights, network.biases, "tanh")
        gait = eqx.tree_at(lambda g: g.policy.network, gait, smooth)
    try:
        with spec_file_errors.blamed():
            trace_spec(spec, robot, gait)
    except NeuralGaitsError:
        raise
    except Exception as error:
        name = _culprit(spec, robot, gait)
        if name is None:
            raise
        raise spec_file_errors.miswritten(name, error, file) from error


def _culprit(spec: GaitSpec, robot: SteppingRobot, gait: AnyGait) -> str | None:
    """Return a user's own condition that raises; None if only conditions of this package do.

    The fault may be a number in place of a function, or a bound of the wrong shape. No line of the
    user's code runs then, yet it is the user's condition.
    """

    def raises(condition: AbstractCondition) -> bool:
        try:
            trace_spec(replace(spec, conditions=(condition,), weights={}), robot, gait)
        except Exception:
            return True
        return False

    names = _built_in_conditions(robot)
    not_built_in = [one for one in spec.conditions if plain(describe_condition(one)) not in names]
    suspect = next(filter(raises, not_built_in), None)
    if suspect is None:
        return None
    # What conditions rest on: if that cannot be evaluated, it is not for this one's sake.
    basis = [Pointwise("basis", suspect.region, 1.0, one) for one in (normal_force, impulse)]
    return None if any(map(raises, basis)) else suspect.name


def _built_in_conditions(robot: SteppingRobot) -> list[Any]:
    """Return the conditions of a robot's built-in specs, as data."""
    names = []
    for name in specs.BUILT_IN:
        with contextlib.suppress(SpecError):
            names += [plain(describe_condition(one)) for one in specs.load(name, robot).conditions]
    return names
