"""The run folder of a gait that was not trained; it appears complete or not at all."""

import time
from pathlib import Path

import numpy as np

from neuralgaits.analysis.run import Run
from neuralgaits.barriers import Gait, GaitSpec, specs
from neuralgaits.certificate.traced import after_impact, trace_spec
from neuralgaits.errors import ConvergenceError, InputError, NeuralGaitsError
from neuralgaits.gait import ZeroDynamics
from neuralgaits.hzd.gait_file import GivenGait, write_gait
from neuralgaits.hzd.given_orbit import Steady, steady
from neuralgaits.hzd.tube import fit_tube
from neuralgaits.programs import POINT, Program, evaluate
from neuralgaits.records.trained import TrainingSummary, Violations, measured_hashes
from neuralgaits.records.training_config import GaitOrigin, TrainingConfig
from neuralgaits.robots.robot_source import planar_biped
from neuralgaits.runs import RunFolder, finish
from neuralgaits.runs.names import GAIT, ROBOT, SPEC, WEIGHTS
from neuralgaits.workflows.train import violations


def given_run(
    zd: ZeroDynamics,
    gait: GivenGait,
    origin: GaitOrigin,
    *,
    solve_s: float = 0.0,
    start_time: float,
    out: str | Path | None,
    root: Path,
) -> Run:
    """Find the orbit of a gait, fit a tube around it, and write a finished run.

    Args:
        zd: zero dynamics of the robot that it walks on, under its policy.
        gait: its outputs.
        origin: origin of the outputs.
        solve_s: duration of an optimisation (s).
        start_time: start time of the command (s, of `time.perf_counter`).
        out: the run folder; a new one below `root` if None.
        root: folder of the runs.

    Raises: InputError if no orbit attracts, ConvergenceError if an optimisation led to such a gait.
    """
    robot = planar_biped(zd.robot)
    walk = _attracting_orbit(zd, origin)
    spec = specs.load(specs.GIVEN, robot, degree=gait.degree)
    trained = Gait(zd.policy, fit_tube(zd, spec, walk))
    config = TrainingConfig(
        robot=robot.name,
        spec=spec.name,
        seed=0,
        init="posture",
        hidden=None,
        steps=0,
        described=spec.describe(),
        not_provable_because=None,
        given=origin,
    )
    copies = {
        ROBOT: robot.layout.xml,
        SPEC: specs.source_path(spec.name).read_text(encoding="utf-8"),
        GAIT: write_gait(robot, gait),
    }
    place = None if out is None else Path(out)
    folder = RunFolder.create(config, copies, name=robot.name, seed=0, root=root, out=place)
    folder.write_tree(WEIGHTS, trained)
    run = Run(folder, robot, spec, trained)
    finish(folder, _summary(run, walk, solve_s, start_time), root)
    return run


def _attracting_orbit(zd: ZeroDynamics, origin: GaitOrigin) -> Steady:
    """Return the periodic orbit of a gait. Raises: as `given_run`, if none attracts."""
    name = zd.robot.name
    no_solution = "its zero dynamics have no finite solution"
    try:
        walk = steady(zd)
    except (ArithmeticError, np.linalg.LinAlgError):
        walk = no_solution
    if not isinstance(walk, str) and not all(np.isfinite(part).all() for part in walk):
        walk = no_solution
    if isinstance(walk, str):
        remedy = (
            f"expected a gait with a periodic orbit on {name}, found that {walk}: check "
            "the joints' convention, and whether it is this robot's"
        )
        raise _refusal(name, origin, walk, remedy)
    if not 0.0 < walk.multiplier < 1.0:
        problem = f"a Poincare multiplier of {walk.multiplier:.4g}"
        remedy = (
            f"expected an orbit that attracts, found {problem}: no tube around it is kept; give a "
            "gait that is stable without feedback along z"
        )
        raise _refusal(name, origin, f"its orbit has {problem}", remedy)
    return walk


def _refusal(name: str, origin: GaitOrigin, problem: str, remedy: str) -> NeuralGaitsError:
    """Return the error for a gait without an attracting orbit, imported or optimised.

    Args:
        name: name of the robot that it should walk on.
        origin: origin of the gait.
        problem: defect of the gait, in words.
        remedy: message for an imported gait.
    """
    if origin.by == "optimise":
        # Equations hold at the nodes; the flow between them is what decides.
        return ConvergenceError(
            f"expected a gait of {name} at {origin.speed:g} m/s, found one in which, by its "
            f"flow, {problem}: ask for another speed, or for polynomials of another --degree"
        )
    return InputError(remedy)


def _summary(run: Run, walk: Steady, solve_s: float, start_time: float) -> TrainingSummary:
    """Return the summary of the gait: its orbit, and its conditions on samples of the tube."""
    program = trace_spec(run.spec, run.robot, run.gait)
    return TrainingSummary(
        run=str(run.path),
        robot=run.config.robot,
        spec=run.config.spec,
        steps=0,
        loss=None,
        conditions=_measured(run.spec, program),
        program_hash=program.hash,
        after_impact=after_impact(run.robot, run.gait),
        speed_m_s=walk.speed_m_s,
        cost_of_transport=walk.cost_of_transport,
        multiplier=walk.multiplier,
        sha256=measured_hashes(run.path),
        train_s=solve_s,
        wall_s=time.perf_counter() - start_time,
    )


def _measured(spec: GaitSpec, program: Program) -> dict[str, Violations]:
    """Return each condition's violations on random samples of its region."""
    rng = np.random.default_rng(0)
    samples = {}
    for name, boxes in spec.regions.items():
        points = []
        for box in boxes:
            low, high = np.array(box.low), np.array(box.high)
            points.append(low + (high - low) * rng.random((2000, 2)))
        samples[name] = evaluate(program, {"u": np.concatenate(points)}, POINT)
    return {c.name: violations(samples[c.region][c.name], c.scale) for c in spec.conditions}
