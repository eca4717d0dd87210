"""Data of a gait for figures: computed once, kept in the run. See `analysis.data`."""

import hashlib
import json

import numpy as np

from neuralgaits.analysis.data import GaitData
from neuralgaits.analysis.flow import FlowQuantities, Mesh, swing
from neuralgaits.analysis.link_points import skeleton
from neuralgaits.analysis.phase_plane import plane
from neuralgaits.analysis.poincare_map import cycle, sampled_map
from neuralgaits.analysis.point_evaluator import PlaneChart, PointEvaluator, quantities
from neuralgaits.analysis.run import Run
from neuralgaits.barriers import Barrier
from neuralgaits.errors import RunError
from neuralgaits.gait.zero_coordinates import momentum_of, positions_of
from neuralgaits.runs import read_arrays, write_arrays
from neuralgaits.runs.arrays import SHA256
from neuralgaits.runs.names import RESIDUAL, ROBOT, SPEC, WEIGHTS

FILE = "figures/data.safetensors"
VERSION = 1
"""Version of the arrays and their meaning: data of another version are computed again."""
PHASES = 81
"""Number of phases of each grid."""


def gait_data(run: Run) -> GaitData:
    """Read the data computed for this very gait, or compute and save them."""
    of, path = fingerprint(run), run.path / FILE
    if path.is_file():
        try:
            arrays, words = read_arrays(path)
        except RunError:
            words: dict[str, str] = {}
        if SHA256 in words and words.get("of") == of:
            return _with_names(run, arrays)
    arrays = compute(run)
    write_arrays(path, arrays, {"of": of})
    return _with_names(run, arrays)


def fingerprint(run: Run) -> str:
    """Return a hash of everything the data depend on."""
    parts = [f"{VERSION}"]
    for file in (ROBOT, SPEC, WEIGHTS, RESIDUAL):
        path = run.path / file
        parts.append(hashlib.sha256(path.read_bytes()).hexdigest() if path.is_file() else "-")
    parts.append(json.dumps(run.config.described, sort_keys=True))
    return hashlib.sha256("\n".join(parts).encode()).hexdigest()


def _with_names(run: Run, arrays: dict[str, np.ndarray]) -> GaitData:
    conditions = run.spec.conditions
    return GaitData(
        arrays,
        tuple(condition.name for condition in conditions),
        tuple(condition.name for condition in conditions if isinstance(condition, Barrier)),
        tuple(one.data for one in run.config.conditions),
        run.robot.joint_names[1:],
        run.robot.torso is not None,
        run.residuals.flow is not None,
    )


def compute(run: Run) -> dict[str, np.ndarray]:
    """Compute all arrays of `analysis.data`. Raises: SpecError if the gait cannot be evaluated."""
    evaluate = PointEvaluator(quantities(run.zero_dynamics, run.gait, run.spec))
    motion = FlowQuantities(*evaluate.each(*FlowQuantities._fields))
    tube = PlaneChart(run.gait, run.spec)
    with np.errstate(all="ignore"):
        arrays = (
            _chart(evaluate, tube) | _plane(evaluate, tube) | _orbit(run, evaluate, motion, tube)
        )
        arrays |= _walks(motion, tube)
    robot = run.robot
    arrays |= {
        "robot/torque_limit": np.asarray(robot.torque_limit),
        "robot/mass": np.asarray(robot.mass),
        "robot/gravity": np.asarray(robot.gravity),
        "robot/friction": np.asarray(robot.friction),
        "robot/leg_length": np.asarray(robot.leg_length),
    }
    return {name: np.asarray(array, dtype=np.float64) for name, array in arrays.items()}


def _chart(evaluate: PointEvaluator, tube: PlaneChart) -> dict[str, np.ndarray]:
    phase, level = np.linspace(0.0, 1.0, PHASES), np.linspace(0.0, 1.0, 41)
    at_phase, at_level = np.meshgrid(phase, level)
    z = tube.z(at_phase, at_level)
    values = evaluate(z.reshape(-1, 2))
    return {
        "chart/phase": phase,
        "chart/level": level,
        "chart/z": z,
        "chart/margins": tube.margins(values, at_phase, at_level),
        "chart/barriers": tube.barriers(values, at_phase.shape),
        "fences/z1": positions_of(z[0]),
        "fences/z2": tube.fences(phase),
        "guard/z": z[:, -1],
        "guard/z_after": values["z_after"].reshape(*at_phase.shape, 2)[:, -1],
    }


def _plane(evaluate: PointEvaluator, tube: PlaneChart) -> dict[str, np.ndarray]:
    columns, rows = 61, 41
    reach = 0.12  # Of the grid beyond the tube, in lengths of a step and heights.
    around = plane(tube, phases=PHASES, lines=(columns, rows), beyond=(reach, reach))
    values = evaluate(around.states)
    return {
        "plane/z1": around.z1,
        "plane/z2": around.z2,
        "plane/dz": around.laid_out(values["dz"]),
        "plane/nominal_dz": around.laid_out(values["nominal_dz"]),
        "plane/foot": around.laid_out(values["foot"][:, 1]),
        "plane/barriers": tube.barriers(values, (rows, columns)),
    }


def _orbit(
    run: Run, evaluate: PointEvaluator, motion: FlowQuantities, tube: PlaneChart
) -> dict[str, np.ndarray]:
    """Return the sampled map, and one step from landing to landing; no nodes without an orbit."""
    mapped, robot = sampled_map(motion, tube), run.robot
    orbit = mapped.orbit
    path = cycle(motion, orbit, Mesh.of_gait(tube.start, tube.guard))
    z, t = path.z[:, 0], path.t[:, 0]
    values = evaluate(z) if len(z) else evaluate(np.array([[0.0, 1.0]]))
    values = {name: array[: len(z)] for name, array in values.items()}
    phase, level = tube.chart(z)
    names = ("q", "dq", "torque", "force", "foot", "foot_velocity")
    return {
        "map/z2": mapped.z2,
        "map/z2_after": mapped.after,
        "orbit/t": t,
        "orbit/z": z,
        **{f"orbit/{name}": values[name] for name in names},
        "orbit/skeleton": skeleton(values["theta"], np.asarray(robot.foot), robot.torso),
        "orbit/margins": tube.margins(values, phase, level),
        "orbit/barriers": tube.barriers(values, phase.shape),
        "orbit/numbers": np.array(
            [momentum_of(orbit.fixed_point), orbit.multiplier, orbit.period_s, orbit.step_length_m]
        ),
    }


def _walks(motion: FlowQuantities, tube: PlaneChart) -> dict[str, np.ndarray]:
    """Return walks that start after an impact near either fence."""
    phase, mesh = np.zeros(2), Mesh.of_gait(tube.start, tube.guard, 30)
    state, pieces = tube.z(phase, np.array([0.05, 0.95])), []
    for _ in range(4):
        path = swing(motion, state, mesh)
        if not path.landed.all():
            break
        pieces.append(path.z)
        state = np.array(motion.z_after(path.z[-1]))
        # One line for both needs one z1; resets differ by what a free policy leaves.
        positions_of(state)[:] = positions_of(state).mean()
    gap = np.full((1, 2), np.nan)
    lines = [part for side in (0, 1) for piece in pieces for part in (piece[:, side], gap)]
    return {"walks/z": np.concatenate(lines) if lines else gap}
