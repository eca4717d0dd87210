"""Carry out a task in a worker, whoever sent it: errors become a failure in one line."""

import hashlib
import platform
import time
import traceback
from functools import cache
from importlib import import_module, metadata
from pathlib import Path
from typing import Any

from neuralgaits._environment import why_jax_failed
from neuralgaits._version import __version__
from neuralgaits.engine.task import Failure, Files, Job, Task
from neuralgaits.errors import NeuralGaitsError, is_full


def carry_out(task: str, job: Job, common: Files) -> tuple[Files, Failure | None, float]:
    """Carry out `module:function` for a job. Returns: files, reason of a failure, and seconds."""
    start_time = time.perf_counter()
    files: Files = {}
    failure = None
    module, _, name = task.partition(":")
    try:
        function: Task = getattr(import_module(module), name)
        files = function(job.settings, {**common, **job.files})
    except MemoryError:
        failure = Failure("lost", "a worker ran out of memory")
    except Exception as error:
        if "RESOURCE_EXHAUSTED" in str(error):
            failure = Failure("lost", "a worker ran out of memory")
        elif is_full(error):
            failure = Failure("lost", f"a worker found its disk full ({_line(str(error))})")
        elif isinstance(error, NeuralGaitsError):
            failure = Failure("refused", _line(str(error)))
        elif (setting := why_jax_failed(error)) is not None:
            failure = Failure("lost", setting)
        else:
            failure = Failure(
                "defect", f"{type(error).__name__}: {_line(str(error))}{_raised_at(error)}"
            )
    return files, failure, time.perf_counter() - start_time


def _line(text: str) -> str:
    return " ".join(text.split())[:300]


def _raised_at(error: Exception) -> str:
    """Return the place where an error was raised, for a report of it."""
    frames = traceback.extract_tb(error.__traceback__)
    return f" ({Path(frames[-1].filename).name}:{frames[-1].lineno})" if frames else ""


@cache
def versions() -> dict[str, str]:
    """Return the versions that decide the digits of results; all workers must have the same."""
    root = Path(__file__).parents[1]
    code = hashlib.sha256()
    for file in sorted(root.rglob("*")):
        if file.suffix in (".py", ".c", ".h", ".cpp", ".xml"):
            code.update(f"{file.relative_to(root)}:{file.stat().st_size}:".encode())
            code.update(file.read_bytes())
    return {
        "neuralgaits": f"{__version__} ({code.hexdigest()[:12]})",
        **{name: metadata.version(name) for name in ("jax", "jaxlib", "mujoco", "numpy")},
        "machine": f"{platform.system()} {platform.machine()}",
    }


def differing(requirements: dict[str, Any]) -> str | None:
    """Describe how this worker's versions differ from the required ones; None if they do not."""
    differences = [
        f"{name} {mine} in place of {requirements.get(name, 'none')}"
        for name, mine in versions().items()
        if requirements.get(name) != mine
    ]
    return ", ".join(differences) or None
