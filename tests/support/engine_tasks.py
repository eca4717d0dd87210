"""Tasks for the tests of engines. Workers import them: the folder of tests is on their path."""

import errno
import os
import signal
import time
from pathlib import Path

from neuralgaits._environment import cores
from neuralgaits.engine import Files, Settings
from neuralgaits.errors import InputError, RunError


def echo(settings: Settings, files: Files) -> Files:
    """What it is given, joined, with the setting."""
    return {"out": b"".join(files[name] for name in sorted(files)) + str(settings["n"]).encode()}


def refuses_odd(settings: Settings, files: Files) -> Files:
    """An error of the caller's for odd numbers, a mistake of the program for 4."""
    if settings["n"] == 4:
        raise ZeroDivisionError("of four")
    if settings["n"] % 2:
        raise InputError(f"expected an even number,\nfound {settings['n']}")
    return {"n": str(settings["n"]).encode()}


def dies(settings: Settings, files: Files) -> Files:
    """Kills its worker as often as `times` says, which a folder of the test's counts."""
    if settings["times"]:
        seen = Path(settings["folder"])
        deaths = len(list(seen.glob(f"{settings['n']}-*")))
        if deaths < settings["times"]:
            (seen / f"{settings['n']}-{deaths}").touch()
            os.kill(os.getpid(), signal.SIGKILL)
    return {"n": str(settings["n"]).encode()}


def hungry(settings: Settings, files: Files) -> Files:
    """Takes as much memory as it is told."""
    return {"bytes": str(len(bytearray(settings["bytes"]))).encode()}


def fills_disk(settings: Settings, files: Files) -> Files:
    """What a full disk makes of a task: the system's error, or a library's that has its words."""
    full = OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
    raise full if settings["n"] == 0 else RunError(f"expected a file, found {full}")


def about_itself(settings: Settings, files: Files) -> Files:
    """Its process, and the threads that it may use."""
    return {"pid": str(os.getpid()).encode(), "cores": str(cores()).encode()}


def sleeps(settings: Settings, files: Files) -> Files:
    """Says that it has begun, and goes on for as long as it is let."""
    Path(settings["began"]).touch()
    time.sleep(settings["seconds"])
    return {}
