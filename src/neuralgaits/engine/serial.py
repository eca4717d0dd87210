"""Run one task after the other, in this process."""

from collections.abc import Generator, Iterable

from neuralgaits.engine.carry import carry_out
from neuralgaits.engine.task import Files, Job, Task, TaskResult, WorkerPool, name_of


class Serial(WorkerPool):
    """Engine without workers, in this process: a task that crashes ends it."""

    name = "serial"

    @property
    def workers(self) -> int:
        """Number of tasks that run at once: always one."""
        return 1

    def map(
        self, task: Task, jobs: Iterable[Job], *, common: Files | None = None
    ) -> Generator[TaskResult, None, None]:
        """Carry out the jobs in order, in this process; see `WorkerPool.map`."""
        named = name_of(task)
        for job in jobs:
            files, failure, wall = carry_out(named, job, common or {})
            yield TaskResult(job.name, files, failure, 1, wall)

    def close(self) -> None:
        """Do nothing: this engine holds no resources to release."""
