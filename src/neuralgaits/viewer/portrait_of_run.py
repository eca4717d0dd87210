"""The phase portrait of a run: flow, fences and orbit of its gait, and where it is proved."""

import numpy as np

from neuralgaits.analysis.box_map import BoxAnswer, BoxMap
from neuralgaits.analysis.flow import FlowQuantities, Mesh
from neuralgaits.analysis.phase_plane import plane
from neuralgaits.analysis.poincare_map import cycle, sampled_map
from neuralgaits.analysis.point_evaluator import PlaneChart, PointEvaluator
from neuralgaits.analysis.run import Run
from neuralgaits.errors import RunError
from neuralgaits.runs.names import MAP
from neuralgaits.viewer.portrait import Portrait


def portrait(run: Run, evaluate: PointEvaluator, *, certified: bool) -> Portrait:
    """Compute the phase portrait of a run's gait.

    Args:
        run: run whose gait is drawn.
        evaluate: evaluator of the quantities at states.
        certified: whether the map of the run's certificate is about exactly this gait.
    """
    chart = PlaneChart(run.gait, run.spec)
    motion = FlowQuantities(*evaluate.each(*FlowQuantities._fields))
    with np.errstate(all="ignore"):
        around = plane(chart, phases=61, lines=(41, 31), beyond=(0.14, 0.22))
        dz = around.laid_out(motion.dz(around.states))
        boxes = _proved(run) if certified else None
        if boxes is None:
            boxes, basis = _sampled(chart, evaluate), "sampled margins, not a proof"
        elif np.all(boxes.answer == BoxAnswer.PROVED):
            basis = "proved margins"
        else:
            basis = "bounded margins (only green is proved)"
        orbit = sampled_map(motion, chart).orbit
        path = cycle(motion, orbit, Mesh.of_gait(chart.start, chart.guard)).z[:, 0]
    return Portrait(
        **around._asdict(),
        dz=dz,
        orbit=path[np.isfinite(path).all(axis=1)],
        boxes=boxes,
        title=f"Zero dynamics, {basis}",
    )


def _proved(run: Run) -> BoxMap | None:
    """Return the certificate's boxes; None if their map is missing or damaged."""
    try:
        return BoxMap.read(run.path / MAP)
    except RunError:
        return None


def _sampled(chart: PlaneChart, evaluate: PointEvaluator) -> BoxMap:
    """Return the tube's cells, with the least margin at the middle of each."""
    phases, levels = np.linspace(0.0, 1.0, 41), np.linspace(0.0, 1.0, 21)
    edges = chart.z(*np.meshgrid(phases, levels))
    corners = np.stack([edges[:-1, :-1], edges[:-1, 1:], edges[1:, 1:], edges[1:, :-1]], axis=2)
    middles = [0.5 * (ends[1:] + ends[:-1]) for ends in (phases, levels)]
    at_phase, at_level = np.meshgrid(*middles)
    values = evaluate(chart.z(at_phase, at_level).reshape(-1, 2))
    least = np.nanmin(chart.margins(values, at_phase, at_level), axis=0, initial=np.inf).ravel()
    answer = np.where(least >= 0.0, BoxAnswer.PROVED, BoxAnswer.REFUTED)
    margin = np.where(np.isfinite(least), least, 0.0)
    return BoxMap(corners.reshape(-1, 4, 2), answer, margin)
