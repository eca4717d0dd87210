"""What a task is, what became of it, and what an engine does."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Generator, Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any, Literal, NamedTuple, Self

Settings = Mapping[str, Any]
"""Values that JSON can hold, by name."""
Files = Mapping[str, bytes]
"""Contents of files by name."""
Task = Callable[[Settings, Files], Files]
"""A function that stands in a module; it keeps nothing and is sent by its name."""

TRIES = 3
"""Workers that may die of a task before it is given up."""


@dataclass(frozen=True)
class Job:
    """One call of a task. Attributes: name: that tells it from others of the same map."""

    name: str
    settings: Settings
    files: Files = field(default_factory=dict)


class Failure(NamedTuple):
    """Why a task gave nothing.

    Attributes:
        kind: `refused`: the task said no, and would again; `defect`: it met a mistake of the
            program; `lost`: its workers died, or had too little memory.
        reason: one line.
    """

    kind: Literal["refused", "defect", "lost"]
    reason: str


class Done(NamedTuple):
    """What became of a job.

    Attributes:
        name: of the job.
        files: that it returned; none of one that failed.
        failure: None if it did not fail.
        tries: workers that began it.
        wall_s: that the last of them took [s].
    """

    name: str
    files: Files
    failure: Failure | None
    tries: int
    wall_s: float


class WorkerPool(ABC):
    """Workers, and how tasks reach them."""

    name: str
    """What a summary calls it."""

    @property
    @abstractmethod
    def workers(self) -> int:
        """Tasks that run at once."""

    @abstractmethod
    def map(
        self, task: Task, jobs: Iterable[Job], *, common: Files | None = None
    ) -> Generator[Done, None, None]:
        """Carry out a task for every job, in no particular order.

        Jobs are taken one at a time, as workers become free, and nothing is kept of one that is
        done: memory does not grow with their number. A job whose worker dies is given to another;
        one that fails is `Done` with a failure. Closed early, it ends what is under way.

        Args:
            task: a function that stands in a module.
            jobs: with names of their own.
            common: files of every job, sent once to a worker.

        Raises: InputError if workers do not start, or run another version than this process.
        """

    @abstractmethod
    def close(self) -> None:
        """Let the workers go."""

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *raised: object) -> None:
        self.close()


def name_of(task: Task) -> str:
    """`module:function` of a task. Raises: ValueError for one that cannot be found by that."""
    name = f"{task.__module__}:{task.__qualname__}"
    if "<" in name or task.__module__ == "__main__":
        raise ValueError(f"expected a function that stands in a module, found {name}")
    return name
