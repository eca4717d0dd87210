"""One task after the other, in this process."""

from collections.abc import Generator, Iterable

from neuralgaits.engine.carry import carry_out
from neuralgaits.engine.task import Done, Files, Job, Task, WorkerPool, name_of


class Serial(WorkerPool):
    """No workers but this process: what dies takes it along."""

    name = "serial"

    @property
    def workers(self) -> int:
        """One."""
        return 1

    def map(
        self, task: Task, jobs: Iterable[Job], *, common: Files | None = None
    ) -> Generator[Done, None, None]:
        """See `WorkerPool.map`."""
        named = name_of(task)
        for job in jobs:
            files, failure, wall = carry_out(named, job, common or {})
            yield Done(job.name, files, failure, 1, wall)

    def close(self) -> None:
        """Nothing to let go of."""
