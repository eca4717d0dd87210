"""Choose the engine that a command runs its tasks on."""

from neuralgaits._environment import cores
from neuralgaits._printable import shown
from neuralgaits.engine.processes import Processes
from neuralgaits.engine.task import WorkerPool
from neuralgaits.errors import InputError


def worker_pool_for(workers: int | None = None, ray: str | None = None) -> WorkerPool:
    """Return the engine of `--workers N` or `--ray ADDRESS|local`.

    Args:
        workers: processes, or cores of a local Ray; one a core if None.
        ray: `local`, `auto`, or HOST:PORT of a cluster's head; None for processes.

    Raises: InputError for settings that do not go together, or without Ray.
    """
    if workers is not None and workers < 1:
        raise InputError(f"expected at least 1 worker, found {workers}")
    most_workers = 4096  # Largest number of processes: more than any one machine has cores.
    if workers is not None and workers > most_workers:
        raise InputError(f"expected at most {most_workers} workers, found {shown(workers)}")
    if ray is None:
        return Processes(cores() if workers is None else workers)
    # In place of an address, it starts Ray on this machine for the duration of the command.
    if workers is not None and ray != "local":
        raise InputError(
            f"expected --workers or --ray {ray}, found both: a cluster has as many workers as cores"
        )
    from neuralgaits.engine.on_ray import OnRay

    return OnRay(ray, workers)
