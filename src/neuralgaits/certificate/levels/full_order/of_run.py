"""Level 4 of a certificate: the full-order theorem, with a proof file of its own."""

import time
from dataclasses import dataclass
from pathlib import Path

from neuralgaits.analysis.run import Run
from neuralgaits.certificate.levels.full_order.conclude import LEVEL
from neuralgaits.certificate.levels.full_order.margins import BANDWIDTH, FullOrderModel
from neuralgaits.certificate.levels.full_order.prove import BUDGET_S, FullOrderResult, full_order
from neuralgaits.certificate.proof_file.model_data import model_data
from neuralgaits.certificate.proof_file.of_run import proof_of
from neuralgaits.certificate.proof_file.theorem_tables import Theorems
from neuralgaits.certificate.proof_file.writer import Proof
from neuralgaits.certificate.search.schedule import Progress
from neuralgaits.errors import SpecError
from neuralgaits.records.certified import FULL_ORDER, Conclusion


@dataclass(frozen=True)
class FullOrderAnswer:
    """Conclusion of level 4, the proof file if there is one, and how many boxes it took."""

    conclusion: Conclusion
    file: Path | None = None
    boxes: int = 0


def certify_full_order(run: Run, deadline: float, progress: Progress | None) -> FullOrderAnswer:
    """Prove level 4 of a run until a deadline (of `time.monotonic`), and write what is proved.

    Raises: SearchInterrupted for KeyboardInterrupt; no file is left then.
    """
    path = run.path / FULL_ORDER
    path.unlink(missing_ok=True)
    budget = min(BUDGET_S, deadline - time.monotonic())
    if run.learned is not None:
        return _undecided("it is about the rigid model, and the run's dynamics carry a residual")
    if not budget > 0.0:
        return _undecided("the budget was spent on the levels before")
    try:
        result = full_order(model_of(run), budget=budget, progress=progress)
    except SpecError as error:
        return _undecided(str(error))
    if not result.statements:
        return FullOrderAnswer(result.conclusion, boxes=result.boxes)
    proof(run, result).write(path)
    return FullOrderAnswer(result.conclusion, path, result.boxes)


def model_of(run: Run, bandwidth: float = BANDWIDTH) -> FullOrderModel:
    """Robot, gait and spec of a run at full order."""
    return FullOrderModel(run.robot, run.gait, run.spec, bandwidth)


def _undecided(reason: str) -> FullOrderAnswer:
    return FullOrderAnswer(Conclusion(LEVEL, "undecided", reason, (), {}))


def proof(run: Run, result: FullOrderResult) -> Proof:
    """The proof file of a result with statements."""
    assert result.program is not None  # There are statements about it.
    claimed = (LEVEL,) if result.conclusion.verdict == "proved" else ()
    theorems = Theorems.of(result.shape, claimed=claimed)
    model = model_data(run.robot, run.gait, run.spec, result.program)
    return proof_of(run, result.program, result.statements, theorems, model)
