"""Turn one step of a gait into functions of CasADi, traced from the package's own formulas.

Two Programs are evaluated on symbols, one of a state along the step and one of the state at its
end. Both read every quantity and every condition where training and proofs read them, so each has
one definition.
"""

from collections.abc import Mapping
from typing import Any, NamedTuple

import equinox as eqx
import jax.numpy as jnp
import numpy as np

from neuralgaits.barriers import Barrier, Gait, GaitSpec, Pointwise
from neuralgaits.barriers import functions as f
from neuralgaits.barriers.hzd import empty_tube
from neuralgaits.gait import BezierPolicy, ZeroDynamics
from neuralgaits.gait.zero_coordinates import momentum_of, position_of
from neuralgaits.programs import Program, evaluate
from neuralgaits.programs.algebras.symbols import SymbolAlgebra
from neuralgaits.programs.tracing.tracer import trace


class StepFunctions(NamedTuple):
    """Functions of (coefficients, ends, phase, zeta) to columns, by name.

    Attributes:
        along: rates per phase, power and the margins of conditions, in scales.
        end: the state after the impact, and the margins at the guard.
        margin_ranges: names of conditions by the first and last phase of their regions.
        unit: unit of zeta [(kg m^2/s)^2].
    """

    along: "NamedFunction"
    end: "NamedFunction"
    margin_ranges: Mapping[str, tuple[float, float]]
    unit: float


class NamedFunction(NamedTuple):
    """A function of CasADi whose results have names."""

    function: Any
    names: tuple[str, ...]

    def __call__(self, *arguments: Any) -> dict[str, Any]:
        """Return the function's results by name."""
        return dict(zip(self.names, self.function(*arguments), strict=True))


def transcribe(casadi: Any, bare: ZeroDynamics, spec: GaitSpec) -> StepFunctions:
    """Trace the robot's step and make it functions of symbols.

    Args:
        casadi: the module.
        bare: zero dynamics of the robot under a `BezierPolicy`, whose numbers do not count.
        spec: spec whose pointwise conditions and barriers must hold along the orbit.
    """
    assert isinstance(bare.policy, BezierPolicy)
    rows_shape = bare.policy.coefficients.shape
    shapes = {"rows": rows_shape, "ends": (2,), "phase": (), "zeta": ()}
    tube = empty_tube(bare.robot, (0.0, 1.0))
    unit = float(tube.unit)
    conditions = [c for c in spec.conditions if isinstance(c, Pointwise | Barrier)]
    by_region, at_guard = {}, []
    for condition in conditions:
        boxes = spec.regions[condition.region]
        first, last = min(box.low[0] for box in boxes), max(box.high[0] for box in boxes)
        if first == last == 1.0:
            at_guard.append(condition)
        else:
            by_region[condition.name] = (first, last)

    def point_of(rows, ends, phase, zeta):
        # The checks of its constructor are for numbers.
        policy = eqx.tree_at(
            lambda p: (p.coefficients, p.start_and_guard), bare.policy, (rows, ends)
        )
        z1 = ends[0] + phase * (ends[1] - ends[0])
        point = ZeroDynamics(bare.robot, policy).point(jnp.stack([z1, jnp.sqrt(2.0 * unit * zeta)]))
        return Gait(policy, tube), point

    def along(rows, ends, phase, zeta):
        gait, point = point_of(rows, ends, phase, zeta)
        length = ends[1] - ends[0]
        margins = {
            c.name: c.margins(point, gait) / c.scale for c in conditions if c.name in by_region
        }
        pace, momentum, falling = position_of(point.dz), momentum_of(point.z), momentum_of(point.dz)
        return margins | {
            "slope": momentum * falling * length / (pace * unit),
            "pace": length / pace,
            "power": point.torque * point.dq[1:],
        }

    def end(rows, ends, phase, zeta):
        gait, point = point_of(rows, ends, phase, zeta)
        margins = {c.name: c.margins(point, gait) / c.scale for c in at_guard}
        return margins | {
            "foot": point.foot,
            "z1": position_of(point.z_after),
            "zeta": 0.5 * momentum_of(point.z_after) ** 2 / unit,
            "outputs": f.output_mismatch(point),
            "rates": f.rate_mismatch(point),
        }

    first, last = (_function(casadi, trace(part, shapes), shapes) for part in (along, end))
    return StepFunctions(first, last, by_region, unit)


def _function(
    casadi: Any, program: Program, shapes: Mapping[str, tuple[int, ...]]
) -> NamedFunction:
    symbols = {name: casadi.SX.sym(name, int(np.prod(shape))) for name, shape in shapes.items()}
    outputs = evaluate(program, symbols, SymbolAlgebra(casadi))
    ordered = [symbols[name] for name in ("rows", "ends", "phase", "zeta")]
    dense = [casadi.densify(value) for value in outputs.values()]
    return NamedFunction(casadi.Function("step", ordered, dense), tuple(outputs))
