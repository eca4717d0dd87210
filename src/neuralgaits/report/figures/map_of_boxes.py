"""Boxes of a certificate mapped into the plane of the zero dynamics, as data and as a figure."""

from collections.abc import Sequence

import numpy as np

from neuralgaits._printable import printable
from neuralgaits.analysis.box_map import BoxAnswer, BoxMap
from neuralgaits.analysis.run import Run
from neuralgaits.certificate.search.branch_and_bound import Search
from neuralgaits.certificate.search.problem import Problem
from neuralgaits.programs import POINT, evaluate
from neuralgaits.programs.tracing.tracer import trace
from neuralgaits.report.drawing.figure import png
from neuralgaits.report.figures.certificate_map import draw
from neuralgaits.runs.names import MAP, MAP_FIGURE


def map_files(run: Run, problems: Sequence[Problem], states: Sequence[Search]) -> dict[str, bytes]:
    """Return file contents by name: the corners and states of all boxes, and a figure."""
    chart = trace(lambda u: {"z": run.gait.z(u)}, {"u": (2,)})
    parts = []
    for state in states:
        tree, leaf = state.tree, state.tree.is_leaf
        low, high = (corner[leaf] for corner in tree.corners)
        corners = [low, np.stack([high[:, 0], low[:, 1]], 1), high]
        corners.append(np.stack([low[:, 0], high[:, 1]], 1))
        z = evaluate(chart, {"u": np.concatenate(corners)}, POINT)["z"]
        lower, upper = tree.lower[leaf], tree.upper[leaf]
        answer = np.where(np.all(lower >= 0.0, axis=1), BoxAnswer.PROVED, BoxAnswer.UNDECIDED)
        answer = np.where(np.any(upper < 0.0, axis=1), BoxAnswer.REFUTED, answer)
        parts.append((z.reshape(4, -1, 2).swapaxes(0, 1), answer, lower.min(axis=1)))
    points = [point.z for state in states for point in state.refuted.values()]
    corners, answers, margins = (np.concatenate(part) for part in zip(*parts, strict=True))
    names = sorted({name for state in states for name in state.refuted})
    conditions = {name for problem in problems for name in problem.names}
    title = f"{run.config.robot}, {run.config.spec}: {len(conditions)} conditions"
    if names:
        title += f"; refuted: {', '.join(names)}"
    broken = np.array(points, dtype=np.float64).reshape(-1, 2)
    boxes = BoxMap(corners, answers, margins, broken, printable(title))
    return {MAP: boxes.content(), MAP_FIGURE: png(draw(boxes))}
