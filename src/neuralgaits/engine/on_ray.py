"""Tasks on a Ray cluster: the extra `ray`.

Ray places tasks, moves their files, and reports when a worker or a node is gone. Which
task is tried again, and how often, is decided here as for processes.
"""

# pyright: reportMissingImports=false
# An extra: what runs without it must not need it.

import contextlib
import logging
import os
import socket
import time
from collections import deque
from collections.abc import Generator, Iterable
from typing import Any

from neuralgaits.engine.carry import carry_out, differing, versions
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

LOCAL = "local"
_COUNT_S = 5.0
"""Interval between two counts of the cluster's cores, since nodes come and go [s]."""


class OnRay(WorkerPool):
    """A Ray cluster.

    Args:
        address: `local` for one of this machine, `auto` for the one that this machine is part
            of, or HOST:PORT of its head.
        workers: cores of a local one; all if None.

    Raises: InputError without Ray, or if there is no cluster at the address.
    """

    name = "ray"

    def __init__(self, address: str, workers: int | None = None):
        try:
            import ray
        except ImportError:
            raise InputError(
                "expected Ray for --ray, found none: pip install 'neuralgaits[ray]', or leave it "
                "out for processes of this machine"
            ) from None
        self._ray: Any = ray
        # Without an address, Ray would join one that runs here already.
        where: dict[str, Any] = {"address": LOCAL, "num_cpus": workers, "include_dashboard": False}
        if address != LOCAL:
            _reach(address)
            where = {"address": address}
        # Its news of a cluster's start and of workers that die is not for our reader.
        os.environ.setdefault("RAY_ACCEL_ENV_VAR_OVERRIDE_ON_ZERO", "0")
        os.environ.setdefault("RAY_USAGE_STATS_ENABLED", "0")
        _keep_off_stdout()
        try:
            ray.init(**where, log_to_driver=False, logging_level=logging.CRITICAL)
        except Exception as error:
            message = " ".join(str(error).split())[:300]
            if address == LOCAL:
                raise InputError(
                    f"expected a Ray of this machine to start, found that it did not ({message}): "
                    "try again when the machine is less busy, or leave --ray out for processes"
                ) from None
            raise InputError(
                f"expected a Ray cluster at {address}, found that it cannot be joined ({message}): "
                "give HOST:PORT as `ray start --head` prints it, or --ray local"
            ) from None
        self._counted, self._workers = -_COUNT_S, 1

    @property
    def workers(self) -> int:
        """Number of cores that the cluster has now."""
        now = time.monotonic()
        if now - self._counted >= _COUNT_S:
            cpus = self._ray.cluster_resources().get("CPU", 0)
            self._counted, self._workers = now, max(int(cpus), 1)
        return self._workers

    def map(
        self, task: Task, jobs: Iterable[Job], *, common: Files | None = None
    ) -> Generator[TaskResult, None, None]:
        """Carry out the jobs as remote Ray functions; see `WorkerPool.map`."""
        ray = self._ray
        named = name_of(task)
        left = iter(jobs)
        remote = ray.remote(num_cpus=1, max_retries=0)(_carry_out_here)
        # Put once: every node fetches it once.
        shared = ray.put(dict(common or {}))
        again: deque[tuple[Job, int]] = deque()
        busy: dict[Any, tuple[Job, int]] = {}
        try:
            while True:
                # Tasks under way for each core: the next one waits on the node where it will run.
                while len(busy) < 2 * self.workers:
                    job, tried = again.popleft() if again else (next(left, None), 0)
                    if job is None:
                        break
                    busy[remote.remote(versions(), named, job, shared)] = job, tried + 1
                if not busy:
                    return
                ready, _ = ray.wait(list(busy), num_returns=1, timeout=_COUNT_S)
                for one in ready:
                    job, tried = busy.pop(one)
                    files, failure, wall = self._answer(one)
                    if failure is not None and failure.kind == "lost" and tried < TRIES:
                        again.append((job, tried))
                        continue
                    if failure is not None and failure.kind == "lost":
                        failure = Failure("lost", f"tried {tried} times; at last {failure.reason}")
                    yield TaskResult(job.name, files, failure, tried, wall)
        finally:
            for one in busy:
                ray.cancel(one, force=True)

    def close(self) -> None:
        """Leave the cluster; a local one is shut down."""
        self._ray.shutdown()

    def _answer(self, reference: Any) -> tuple[Files, Failure | None, float]:
        """Return the files of a task, or the way it was lost, and its time [s].

        Raises: InputError if a worker has other versions.
        """
        errors = self._ray.exceptions
        try:
            answer = self._ray.get(reference)
        except errors.OutOfMemoryError:
            return {}, Failure("lost", "its node ran out of memory"), 0.0
        except (errors.WorkerCrashedError, errors.NodeDiedError, errors.ObjectLostError) as error:
            return {}, Failure("lost", f"its worker died ({type(error).__name__})"), 0.0
        except errors.RayTaskError as error:
            line = " ".join(str(error.cause or error).split())[-300:]
            raise InputError(
                f"expected neuralgaits on every node of the cluster, found a worker that cannot "
                f"use it ({line}): install the same version there"
            ) from None
        except errors.RayError as error:
            return {}, Failure("lost", f"its worker was lost ({type(error).__name__})"), 0.0
        if isinstance(answer, str):
            raise InputError(
                f"expected the same versions on every node, found {answer}: install the same there"
            )
        return answer


def _carry_out_here(
    theirs: dict[str, str], task: str, job: Job, common: Files
) -> tuple[Files, Failure | None, float] | str:
    """Carry out a task on a node, or report that its versions differ from the sender's."""
    from neuralgaits._environment import one_thread, prepare

    prepare()
    one_thread()
    differ = differing(theirs)
    return carry_out(task, job, common) if differ is None else differ


def _keep_off_stdout() -> None:
    """Keep Ray from reporting on stdout that a node is gone: programs read the answer there.

    No setting of Ray does so: `log_to_driver` is about the output of workers.
    """
    with contextlib.suppress(ImportError):
        from ray._private import worker

        worker.print_to_stdstream = lambda *_, **__: None


def _reach(address: str) -> None:
    """Raise InputError at once if nothing listens there: Ray would wait for minutes."""
    if address == "auto":
        return
    host, _, port = address.rpartition(":")
    if not host or not port.isdecimal() or "/" in address:
        raise InputError(
            f"expected --ray local, auto or HOST:PORT, found {address!r}: `ray start --head` "
            "prints the address of a cluster"
        )
    try:
        socket.create_connection((host, int(port)), timeout=5.0).close()
    except (OSError, OverflowError) as error:
        raise InputError(
            f"expected a Ray cluster at {address}, found none ({error}): start its head with "
            "`ray start --head`, or give --ray local"
        ) from None
