"""Many tasks on many workers: processes of this machine, or a Ray cluster.

A task is a function of settings and the contents of files that returns the contents of files. It
sees no folder of the caller's, so it may run anywhere, twice, or again; `WorkerPool.map` gives what
became of each as it comes.
"""

from neuralgaits.engine.choice import worker_pool_for
from neuralgaits.engine.processes import Processes
from neuralgaits.engine.serial import Serial
from neuralgaits.engine.task import Failure, Files, Job, Settings, TaskResult, WorkerPool

__all__ = [
    "Failure",
    "Files",
    "Job",
    "Processes",
    "Serial",
    "Settings",
    "TaskResult",
    "WorkerPool",
    "worker_pool_for",
]
