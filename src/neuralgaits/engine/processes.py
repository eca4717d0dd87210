"""Tasks in processes of this machine, one thread each.

A worker is started afresh (`spawn`), so it shares nothing with this process. Each has a pipe of
its own: it is known which task a dead one had, and another takes that over.
"""

import contextlib
import multiprocessing
import os
import signal
import threading
from collections import deque
from collections.abc import Generator, Iterable
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess

from neuralgaits._environment import one_thread, prepare
from neuralgaits.engine.carry import carry_out
from neuralgaits.engine.task import (
    TRIES,
    Failure,
    Files,
    Job,
    Task,
    TaskResult,
    WorkerPool,
    name_of,
)
from neuralgaits.errors import InputError

_READY = "ready"
_GONE = (EOFError, ConnectionError, OSError)
"""Errors that a pipe raises when the process at its other end has died."""


class Processes(WorkerPool):
    """Processes of this machine.

    Args:
        workers: number of workers.
        memory_bytes: memory that each may have; an equal share of the machine's if None. A task
            that needs more fails with a line that says so.

    Raises: InputError for no workers.
    """

    name = "processes"

    def __init__(self, workers: int, memory_bytes: int | None = None):
        if workers < 1:
            raise InputError(f"expected at least 1 worker, found {workers}")
        self._memory = _share(workers) if memory_bytes is None else memory_bytes
        self._count = workers
        self._all: list[_Worker] = []
        self._idle: list[_Worker] = []

    @property
    def workers(self) -> int:
        """Number of processes requested; each starts when it is first needed."""
        return self._count

    def map(
        self, task: Task, jobs: Iterable[Job], *, common: Files | None = None
    ) -> Generator[TaskResult, None, None]:
        """Carry out the jobs in processes of this machine; see `WorkerPool.map`."""
        named, left = name_of(task), iter(jobs)
        again: deque[tuple[Job, int]] = deque()
        busy: dict[Connection, tuple[_Worker, Job, int]] = {}
        fresh = set[Connection]()
        try:
            while True:
                while len(busy) < self._count:
                    job, tried = again.popleft() if again else (next(left, None), 0)
                    if job is None:
                        break
                    worker = self._idle.pop() if self._idle else self._start_worker()
                    busy[worker.pipe] = worker, job, tried + 1
                    common_settings = None if worker.pipe in fresh else dict(common or {})
                    # One that has died meanwhile is met below, where its pipe has ended.
                    with contextlib.suppress(*_GONE):
                        worker.pipe.send((named, job, common_settings))
                    fresh.add(worker.pipe)
                if not busy:
                    return
                for pipe in wait(list(busy)):
                    assert isinstance(pipe, Connection)
                    worker, job, tried = busy[pipe]
                    try:
                        answer = pipe.recv()
                    except _GONE:
                        del busy[pipe]
                        self._all.remove(worker)
                        end = worker.ended()
                        if tried < TRIES:
                            again.append((job, tried))
                        else:
                            died = f"{tried} workers died of it, one after the other"
                            lost = Failure("lost", f"{died}; the last {end}")
                            yield TaskResult(job.name, {}, lost, tried, 0.0)
                        continue
                    if answer == _READY:
                        worker.ready = True
                        continue
                    del busy[pipe]
                    self._idle.append(worker)
                    files, failure, wall = answer
                    yield TaskResult(job.name, files, failure, tried, wall)
        finally:
            for worker, *_ in busy.values():
                if worker in self._all:
                    self._all.remove(worker)
                    worker.kill()

    def close(self) -> None:
        """End all worker processes at once."""
        while self._all:
            self._all.pop().kill()
        self._idle.clear()

    def _start_worker(self) -> "_Worker":
        self._all.append(_Worker(self._memory))
        return self._all[-1]


class _Worker:
    """A worker process and the pipe to it."""

    def __init__(self, memory_bytes: int):
        context = multiprocessing.get_context("spawn")
        self.pipe, theirs = context.Pipe()
        self.ready = False
        self._process: BaseProcess = context.Process(
            target=_work, args=(theirs, memory_bytes), daemon=True
        )
        self._process.start()
        # Held by the worker alone: when it dies, this end of the pipe says so.
        theirs.close()

    def ended(self) -> str:
        """Describe in words how the process ended. Raises: InputError if it never began."""
        self.pipe.close()
        self._process.join()
        code = self._process.exitcode or 0
        if not self.ready and code > 0:
            raise InputError(
                f"expected workers that start, found one that ended with code {code}: in a script "
                "of your own, call this below `if __name__ == '__main__':`"
            )
        if code >= 0:
            return f"ended with code {code}"
        name = signal.Signals(-code).name
        memory = code == -signal.SIGKILL
        return f"was killed by {name}" + (", as happens when memory runs out" if memory else "")

    def kill(self) -> None:
        """End the process at once and close its pipe."""
        self.pipe.close()
        self._process.kill()
        self._process.join()


def _share(workers: int) -> int:
    """An equal share of the machine's memory [bytes]."""
    try:
        whole = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    except (AttributeError, ValueError, OSError):
        return 0
    least_bytes = 2**31  # Memory that a worker always gets, however many there are.
    return max(whole // max(workers, 1), least_bytes)


def _work(pipe: Connection, memory_bytes: int) -> None:
    """Run a worker: tasks until its pipe ends, which happens when the parent process ends."""
    # Ctrl-C reaches all processes of a terminal; the one that shows the progress ends the others.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    prepare()
    one_thread()
    _bound_memory(memory_bytes)
    common: Files = {}
    threading.Thread(target=_end_with_parent, daemon=True).start()
    with contextlib.suppress(*_GONE):
        pipe.send(_READY)
        while True:
            task, job, common_settings = pipe.recv()
            common = common if common_settings is None else common_settings
            pipe.send(carry_out(task, job, common))


def _end_with_parent() -> None:
    """End at once if the parent process is killed, since nobody waits for an answer."""
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(0)


def _bound_memory(most: int) -> None:
    """Make requests for more memory than this fail, where the system can."""
    if not most:
        return
    with contextlib.suppress(ImportError, AttributeError, ValueError, OSError):
        import resource

        _, hard = resource.getrlimit(resource.RLIMIT_DATA)
        if hard != resource.RLIM_INFINITY:
            most = min(most, hard)
        resource.setrlimit(resource.RLIMIT_DATA, (most, hard))
