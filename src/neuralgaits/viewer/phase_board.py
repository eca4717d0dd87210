"""The board of the live page: flow, fences and orbit of a gait, and where it is proved."""

import numpy as np

from neuralgaits.analysis.flow import FlowQuantities, Mesh
from neuralgaits.analysis.phase_plane import plane
from neuralgaits.analysis.poincare_map import cycle, sampled_map
from neuralgaits.analysis.point_evaluator import PlaneChart, PointEvaluator
from neuralgaits.analysis.run import Run
from neuralgaits.errors import RunError
from neuralgaits.runs import read_arrays
from neuralgaits.runs.names import MAP
from neuralgaits.viewer.portrait import PROVED, REFUTED, Portrait

COLUMNS, ROWS, FENCE_POINTS = 41, 31, 61
PHASES, LEVELS = 41, 21
"""Grid of the cells whose least margin is shown if there is no certificate."""
ASIDE, ABOVE = 0.14, 0.22
"""Margins of the picture around the tube, in lengths of a step and heights of the tube."""


def portrait(run: Run, look: PointEvaluator, *, certified: bool) -> Portrait:
    """Compute the phase portrait of a run's gait.

    Args:
        run: run whose gait is drawn.
        look: evaluator of the quantities at states.
        certified: whether the map of the run's certificate is about exactly this gait.
    """
    chart = PlaneChart(run.gait, run.spec)
    motion = FlowQuantities(*look.each(*FlowQuantities._fields))
    with np.errstate(all="ignore"):
        around = plane(chart, phases=FENCE_POINTS, lines=(COLUMNS, ROWS), beyond=(ASIDE, ABOVE))
        dz = around.laid_out(motion.dz(around.states))
        boxes = _proved(run) if certified else None
        if boxes is None:
            boxes, known = _sampled(chart, look), "sampled margins, not a proof"
        elif np.all(boxes[1] == PROVED):
            known = "proved margins"
        else:
            known = "bounded margins (only green is proved)"
        orbit = sampled_map(motion, chart).orbit
        path = cycle(motion, orbit, Mesh.of_gait(chart.start, chart.guard)).z[:, 0]
    corners, answer, margin = boxes
    return Portrait(
        **around._asdict(),
        dz=dz,
        orbit=path[np.isfinite(path).all(axis=1)],
        corners=corners,
        answer=answer,
        margin=margin,
        title=f"Zero dynamics, {known}: click to put the robot there",
    )


def _proved(run: Run) -> tuple[np.ndarray, np.ndarray, np.ndarray] | None:
    """Return the certificate's boxes that have an area; None if its map is missing or damaged."""
    try:
        arrays, _ = read_arrays(run.path / MAP)
        corners, answer, margin = (arrays[name] for name in ("corners", "answer", "margin"))
    except (RunError, KeyError):
        return None
    wide = np.ptp(corners, axis=1).min(axis=1) > 0.0
    return corners[wide], answer[wide], margin[wide]


def _sampled(chart: PlaneChart, look: PointEvaluator) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the tube's cells, with the least margin at the middle of each."""
    phases, levels = np.linspace(0.0, 1.0, PHASES), np.linspace(0.0, 1.0, LEVELS)
    edges = chart.z(*np.meshgrid(phases, levels))
    corners = np.stack([edges[:-1, :-1], edges[:-1, 1:], edges[1:, 1:], edges[1:, :-1]], axis=2)
    middles = [0.5 * (ends[1:] + ends[:-1]) for ends in (phases, levels)]
    at_phase, at_level = np.meshgrid(*middles)
    found = look(chart.z(at_phase, at_level).reshape(-1, 2))
    least = np.nanmin(chart.margins(found, at_phase, at_level), axis=0, initial=np.inf).ravel()
    answer = np.where(least >= 0.0, PROVED, REFUTED)
    margin = np.where(np.isfinite(least), least, 0.0)
    return corners.reshape(-1, 4, 2), answer, margin
