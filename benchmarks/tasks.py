"""What handing out a task costs, and whether the memory of the one that hands out grows.

Tasks that do nothing, on each engine: wall and processor time of this process a task, and its
resident memory after 1000 of them, 10,000 and 100,000 (TASKS=1000 for fewer). `ray` needs the
extra `ray` and is left out without it. `tasks.py serial processes` measures these alone.

Asked: at most 20 ms a task on this machine, 50 ms on Ray; memory flat in the number of tasks.
"""

import importlib.util
import os
import sys
import time
from collections.abc import Sequence

from common import show

from neuralgaits.engine import Job, Serial, WorkerPool, worker_pool_for
from support import engine_tasks

TASKS = int(os.environ.get("TASKS", "100000"))
WORKERS = 2
ENGINES = {
    "serial": (Serial, "<= 20 ms"),
    "processes": (lambda: worker_pool_for(WORKERS), "<= 20 ms"),
    "ray": (lambda: worker_pool_for(WORKERS, "local"), "<= 50 ms"),
}


def main(names: Sequence[str]) -> None:
    """Print figures of each engine."""
    for name in names:
        if name == "ray" and importlib.util.find_spec("ray") is None:
            show("ray", "left out: no Ray")
            continue
        make, asked = ENGINES[name]
        with make() as engine:
            hand_out(engine, 100)
            known = resident_mb()
            count = min(1000, TASKS)
            while count <= TASKS:
                wall, own = hand_out(engine, count)
                after = resident_mb()
                show(f"{name}: {count} tasks, ms of the clock each", 1e3 * wall / count, asked)
                show("  ms of this process's processor each", 1e3 * own / count)
                show("  resident memory before, after [MB]", f"{known:.1f}, {after:.1f}", "flat")
                count *= 10


def hand_out(engine: WorkerPool, count: int) -> tuple[float, float]:
    """Carry out tasks that do nothing. Returns: time of the clock, and of this processor [s]."""
    jobs = (Job(str(n), {"n": n}) for n in range(count))
    start_time, own, good = time.perf_counter(), time.process_time(), 0
    for done in engine.map(engine_tasks.echo, jobs):
        good += done.files.get("out") == done.name.encode()
    if good != count:
        raise SystemExit(f"expected {count} answers, found {good}")
    return time.perf_counter() - start_time, time.process_time() - own


def resident_mb() -> float:
    """Memory that this process has in use now [MB]."""
    with open("/proc/self/statm") as counts:
        pages = int(counts.read().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") / 2**20


if __name__ == "__main__":
    # Ray's workers have a path of their own.
    os.environ["PYTHONPATH"] = os.pathsep.join(sys.path)
    main(sys.argv[1:] or list(ENGINES))
