"""Prove a run: its conditions on their regions, its walking set, its orbit, its full order.

`certificate/run_certificate/run_proof.py` has the way from a run to its verdicts, and
`finish_certificate.py` beside this file writes them.
"""

import time

from neuralgaits.analysis.run import Run, open_run
from neuralgaits.certificate.level_target import ControlAssumption
from neuralgaits.certificate.run_certificate.certificate_files import (
    refuse_unwritable_certificate,
)
from neuralgaits.certificate.run_certificate.run_proof import ProofEffort, prove_run
from neuralgaits.certificate.run_certificate.scope import Scope
from neuralgaits.errors import InputError
from neuralgaits.runs.only_writer import only_writer
from neuralgaits.settings import CertifySettings, called_with
from neuralgaits.settings.certify_settings import errors_of_model
from neuralgaits.settings.forms import LEARNED
from neuralgaits.systems.family_tasks import task_of
from neuralgaits.systems.system_family import ProgressCallbacks
from neuralgaits.workflows.certify_result import CertifyResult
from neuralgaits.workflows.finish_certificate import finish_certificate


@called_with(CertifySettings)
def certify(settings: CertifySettings) -> CertifyResult:
    """Prove every condition of a run's spec on its region, and what follows for trajectories.

    The run may be an open one. A disturbance is a pair of bounds, `within` maps commands to
    ranges in SI units, and a box of robots maps kinds to half widths; an empty one means the
    robot of the file alone.

    Returns: `CertifyResult`. Proof, summary, boxes and map are in the run's folder.
    Raises: InputError on bad settings, or if another command works on the run; RunError if there
        are no boxes to resume from; SearchInterrupted for KeyboardInterrupt, with the results so
        far in the folder.
    """
    if (task := task_of("certify", settings)) is not None:
        return CertifyResult(task(ProgressCallbacks(proved=settings.progress)).result)
    trained = open_run(settings.run)
    with only_writer(trained.path):
        return certify_alone(trained, settings)


def certify_alone(trained: Run, settings: CertifySettings) -> CertifyResult:
    """Do what `certify` does, for a run whose lock the caller holds. Raises: as `certify`."""
    start_time = time.perf_counter()
    disturbance = _bounds(settings.disturbance, trained)
    scope = Scope.of(trained, settings.highest, settings.within, settings.parameters)
    refuse_unwritable_certificate(trained.path)
    effort = ProofEffort(
        settings.budget, settings.resume, settings.workers, settings.ray, settings.progress
    )
    control = ControlAssumption(
        settings.bandwidth,
        settings.clock == "free",
        settings.controller == "scheduled-pd",
        float(settings.error),
        settings.state_error,
        errors_of_model(settings.model_error),
    )
    proof = prove_run(trained, scope, disturbance, control, effort)
    try:
        result = finish_certificate(trained, scope, proof, start_time)
    except KeyboardInterrupt:
        raise proof.interruption from None
    if proof.interrupted:
        raise proof.interruption
    return result


def _bounds(disturbance: tuple[float, float] | str | None, run: Run) -> tuple[float, float]:
    """Return the bounds of a disturbance, or those that a run has learned. Raises: InputError."""
    if disturbance is None:
        return 0.0, 0.0
    if not isinstance(disturbance, str):
        return disturbance
    if run.learned is None:
        raise InputError(
            f"expected --disturbance {LEARNED} for a run with a residual, found one without in "
            f"{run.path}: refine a run first, or write A,B"
        )
    first, second = run.learned.error_bound
    return float(first), float(second)
