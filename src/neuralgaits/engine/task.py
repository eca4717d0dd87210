"""Types of a task, its job and its outcome, and the interface of an engine."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Generator, Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any, Literal, NamedTuple, Self

Settings = Mapping[str, Any]
"""Values that JSON can hold, by name."""
Files = Mapping[str, bytes]
"""Contents of files by name."""
Task = Callable[[Settings, Files], Files]
"""A stateless module-level function, sent to workers by its qualified name."""

TRIES = 3
"""Number of workers that may die of a task before it is given up."""


@dataclass(frozen=True)
class Job:
    """One call of a task. Attributes: name: unique among the jobs of one map."""

    name: str
    settings: Settings
    files: Files = field(default_factory=dict)


class Failure(NamedTuple):
    """Reason why a task returned nothing.

    Attributes:
        kind: `refused`: the task refused, and would again; `defect`: it met a mistake of the
            program; `lost`: its workers died, or had too little memory or no platform for JAX.
        reason: reason in one line.
    """

    kind: Literal["refused", "defect", "lost"]
    reason: str


class TaskResult(NamedTuple):
    """Outcome of a job.

    Attributes:
        name: name of the job.
        files: returned by the task; empty if it failed.
        failure: None if it did not fail.
        tries: number of workers that began it.
        wall_s: time that the last of them took [s].
    """

    name: str
    files: Files
    failure: Failure | None
    tries: int
    wall_s: float


class WorkerPool(ABC):
    """Interface of an engine: workers, and how tasks reach them."""

    name: str
    """Name of the engine in a summary."""

    @property
    @abstractmethod
    def workers(self) -> int:
        """Number of tasks that run at once."""

    @abstractmethod
    def map(
        self, task: Task, jobs: Iterable[Job], *, common: Files | None = None
    ) -> Generator[TaskResult, None, None]:
        """Carry out a task for every job, in no particular order.

        Jobs are taken one at a time, as workers become free, and nothing is kept of a finished
        one: memory does not grow with their number. A job whose worker dies is given to another;
        one that fails is a `TaskResult` with a failure. Closing the generator early ends what
        is under way.

        Args:
            task: a module-level function.
            jobs: jobs with unique names.
            common: files of every job, sent once to a worker.

        Raises: InputError if workers do not start, or run another version than this process.
        """

    @abstractmethod
    def close(self) -> None:
        """Release the workers and what they hold."""

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *raised: object) -> None:
        self.close()


def name_of(task: Task) -> str:
    """Return `module:function` of a task. Raises: ValueError if that does not lead back to it."""
    name = f"{task.__module__}:{task.__qualname__}"
    if "<" in name or task.__module__ == "__main__":
        raise ValueError(f"expected a function that stands in a module, found {name}")
    return name
