"""Compile the walk of a gait once, from files as `export` writes them, and keep it by its hash."""

import contextlib
import hashlib
import importlib.util
import os
import platform
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from importlib import resources
from pathlib import Path
from typing import Literal

import mujoco

from neuralgaits._cache import cache_folder
from neuralgaits.analysis.run import Run
from neuralgaits.control import Controller
from neuralgaits.control.laws import EXPORTED
from neuralgaits.errors import InputError, SpecError
from neuralgaits.export import output_folder
from neuralgaits.export.facts import Design, Origin
from neuralgaits.export.programs import ground
from neuralgaits.export.source import gait_files
from neuralgaits.gait.gaits import AnyGait
from neuralgaits.gait.reset_residual import ResetCorrection
from neuralgaits.robots import PlanarBiped
from neuralgaits.simulation.native.compiled_walk import Library, NativeError
from neuralgaits.simulation.setup.starts import momentum_range

Choice = Literal["native", "jax"]
FLAGS = ("-std=gnu99", "-O3", "-ffp-contract=off", "-fPIC", "-shared")
"""Compiler flags. Products and sums are not fused, so a walk is the same on every machine."""
SOURCES = ("walk.c", "clf_qp.c", "controller.c", "estimator.c", "gait.c")
_LOOP = ("walk.c", "walk.h", "clf_qp.c", "clf_qp.h")
_SHIPPED = ("controller.h", "ng_math.h", "estimator.h", "controller.c", "estimator.c")
_COMPILERS = ("cc", "gcc", "clang")
_COMPILE_S = 300.0
_UNKNOWN = "0" * 64
_own_folders: list[tempfile.TemporaryDirectory] = []
"""Folders that are deleted when this process ends."""
_SHOWN = 200
NO_COMPILER = "there is no C compiler: install gcc or clang, or pip install 'neuralgaits[compiler]'"


@dataclass(frozen=True)
class WalkEngine:
    """The loop that runs a walk: compiled code or JAX.

    Attributes:
        library: the compiled walk, None for the loop in JAX.
        note: one line on a limitation, such as a missing compiler; None without one.
    """

    library: Library | None
    note: str | None


def engine_of(
    robot: PlanarBiped,
    gait: AnyGait,
    z2_range: tuple[float, float],
    choice: Choice | None = None,
    reset_residual: ResetCorrection = None,
) -> WalkEngine:
    """Choose the loop that walks a gait.

    Args:
        robot: the controller's model.
        gait: policy and region, or a family of them.
        z2_range: momenta of the region (kg m^2/s).
        choice: `native` to require it, `jax` for the reference, None for native where it works.
        reset_residual: corrects the impact that the steps of a family begin with.

    Raises: InputError in one line if native was required and does not work.
    """
    if choice not in (None, "native", "jax"):
        raise InputError(f"engine: expected native or jax, found {choice!r}")
    if choice == "jax":
        return WalkEngine(None, None)
    try:
        design = _design(robot, gait, z2_range, reset_residual)
        return _engine(sources(design), design.controller)
    except NativeError as error:
        if choice == "native":
            raise InputError(f"--engine native: expected a compiled walk, but {error}") from None
        return WalkEngine(None, f"walking with JAX, many times slower, because {error}")


def engine_of_run(run: Run, choice: Choice | None = None) -> WalkEngine:
    """Choose the loop for the gait of a run; for a family, the gait at the run's command."""
    return engine_of(run.robot, run.gait, momentum_range(run.gait), choice)


def engine_of_trained(run: Run, choice: Choice | None = None) -> WalkEngine:
    """Choose the loop for all gaits of a run; a family takes its commands."""
    trained, reset = run.trained, run.residuals.reset
    return engine_of(run.robot, trained, momentum_range(trained), choice, reset)


def compiler() -> list[str] | None:
    """Return the command of a C compiler: CC, the machine's own, or that of extra `compiler`."""
    chosen = os.environ.get("CC", "").split()
    if chosen:
        return chosen
    for name in _COMPILERS:
        if shutil.which(name):
            return [name]
    if importlib.util.find_spec("ziglang") is not None:
        return [sys.executable, "-m", "ziglang", "cc"]
    return None


def _design(
    robot: PlanarBiped,
    gait: AnyGait,
    z2_range: tuple[float, float],
    reset_residual: ResetCorrection = None,
) -> Design:
    # Hashes are for those who get a controller; here the text itself is what is hashed.
    origin = Origin(_UNKNOWN, _UNKNOWN, None, None, "walk", "-")
    return Design.of(robot, gait, EXPORTED, z2_range, origin, reset_residual=reset_residual)


def sources(design: Design) -> dict[str, str]:
    """Return all files to compile. Raises: NativeError for a policy that C cannot express."""
    try:
        own = gait_files(design, (ground(design.robot),))
    except SpecError as error:
        raise NativeError(f"C cannot express its policy ({error})") from None
    shipped = output_folder.shipped()
    folder = resources.files("neuralgaits.simulation.native") / "c"
    loop = {name: (folder / name).read_text(encoding="utf-8") for name in _LOOP}
    return own | loop | {name: shipped[name] for name in _SHIPPED}


def _engine(texts: Mapping[str, str], controller: Controller) -> WalkEngine:
    """Return the walk of these sources, compiled now or before. Raises: NativeError."""
    command = compiler()
    if command is None:
        raise NativeError(NO_COMPILER)
    kept = _place(command, texts)
    # One that is kept and does not load is damaged, and made anew.
    with contextlib.suppress(NativeError):
        if kept.is_file():
            return WalkEngine(Library(kept, controller), None)
    try:
        kept.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(prefix="compiling-", dir=kept.parent) as place:
            os.replace(_compile(command, Path(place), texts), kept)
        return WalkEngine(Library(kept, controller), None)
    except OSError as error:
        note = (
            f"compiled the walk for this command alone, because {kept.parent} cannot be written "
            f"({error.strerror})"
        )
        # A folder each: what is loaded under one name is not loaded again.
        _own_folders.append(tempfile.TemporaryDirectory(prefix="neuralgaits-"))
        made = _compile(command, Path(_own_folders[-1].name), texts)
        return WalkEngine(Library(made, controller), note)


def _place(command: Sequence[str], texts: Mapping[str, str]) -> Path:
    """Return a library's place, named by a hash of its sources and its compiler."""
    key = hashlib.sha256()
    about = (*command, _version(tuple(command)), *FLAGS, mujoco.__version__, platform.machine())
    for text in (*about, *(part for item in sorted(texts.items()) for part in item)):
        key.update(f"{len(text)}:{text}".encode())
    return cache_folder() / "walks" / f"walk-{key.hexdigest()[:32]}.so"


def _compile(command: Sequence[str], place: Path, texts: Mapping[str, str]) -> Path:
    """Compile into a folder. Returns: the library. Raises: NativeError."""
    for name, text in texts.items():
        (place / name).write_text(text, encoding="utf-8")
    made = place / "walk.so"
    headers = Path(mujoco.__file__).parent / "include"
    files = [str(place / name) for name in SOURCES]
    line = [
        *command,
        *FLAGS,
        *files,
        "-I",
        str(place),
        "-isystem",
        str(headers),
        "-o",
        str(made),
        "-lm",
    ]
    try:
        done = subprocess.run(
            line,
            capture_output=True,
            encoding="utf-8",
            errors="replace",
            timeout=_COMPILE_S,
            check=False,
        )
    except (OSError, subprocess.TimeoutExpired) as error:
        raise NativeError(f"{command[0]} does not run ({error})"[:_SHOWN]) from None
    if done.returncode != 0 or not made.is_file():
        said = [line for line in done.stderr.splitlines() if "error" in line]
        said = said or done.stderr.splitlines() or [f"exit {done.returncode}"]
        raise NativeError(f"{command[0]} fails ({' '.join(said[0].split())[:_SHOWN]})")
    return made


@cache
def _version(command: tuple[str, ...]) -> str:
    """Return a compiler's version text; empty if it does not run."""
    with contextlib.suppress(OSError, subprocess.TimeoutExpired):
        done = subprocess.run(
            [*command, "--version"],
            capture_output=True,
            encoding="utf-8",
            errors="replace",
            timeout=60.0,
            check=False,
        )
        return done.stdout
    return ""
