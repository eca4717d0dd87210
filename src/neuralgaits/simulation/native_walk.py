"""Compile the walk of a gait once, from files as `export` writes them, and keep it by its hash."""

import tempfile
from collections.abc import Mapping
from dataclasses import dataclass
from importlib import resources
from pathlib import Path
from typing import Literal

import mujoco

from neuralgaits._cache import cache_folder
from neuralgaits._compiler import Compiler, CompilerError, SharedLibrary
from neuralgaits.analysis.run import Run
from neuralgaits.control import Controller
from neuralgaits.control.controlled_gait import ControlledGait
from neuralgaits.control.joint_model import JointModel
from neuralgaits.control.law_by_name import law_named
from neuralgaits.errors import InputError, SpecError
from neuralgaits.export import output_folder
from neuralgaits.export.design import Design, Origin
from neuralgaits.export.robot_programs import ground
from neuralgaits.export.source import gait_files
from neuralgaits.simulation.native.compiled_walk import Library, NativeError
from neuralgaits.simulation.setup.starts import controlled_gait, momentum_range

Choice = Literal["native", "jax"]
FLAGS = ("-std=gnu99", "-O1", "-ffp-contract=off", "-fPIC", "-shared")
"""Compiler flags. Products and sums are not fused, so a walk is the same on every machine. With -O3
it is compiled in twice the time and walks no faster: most of a tick is MuJoCo's."""
SOURCES = ("walk.c", "clf_qp.c", "controller.c", "estimator.c", "adapt.c", "gait.c")
_own_folders: list[tempfile.TemporaryDirectory] = []
"""Folders that are deleted when this process ends."""


@dataclass(frozen=True)
class WalkEngine:
    """The loop that runs a walk: compiled code or JAX.

    Attributes:
        library: the compiled walk, None for the loop in JAX.
        note: one line on a limitation, such as a missing compiler; None without one.
    """

    library: Library | None
    note: str | None


def engine_of(controlled: ControlledGait, choice: Choice | None = None) -> WalkEngine:
    """Choose the loop that walks a gait.

    Args:
        controlled: the gait, and what its controllers share.
        choice: `native` to require it, `jax` for the reference, None for native where it works.

    Raises: InputError in one line if native was required and does not work.
    """
    if choice not in (None, "native", "jax"):
        raise InputError(f"engine: expected native or jax, found {choice!r}")
    if choice == "jax":
        return WalkEngine(None, None)
    try:
        design = _design(controlled)
        return _engine(sources(design), design.controller)
    except (NativeError, CompilerError) as error:
        if choice == "native":
            raise InputError(f"--engine native: expected a compiled walk, but {error}") from None
        return WalkEngine(None, f"walking with JAX, many times slower, because {error}")


def engine_of_run(run: Run, choice: Choice | None = None) -> WalkEngine:
    """Choose the loop for the gait of a run; for a family, the gait at the run's command."""
    return engine_of(ControlledGait(run.robot, run.gait, momentum_range(run.gait)), choice)


def engine_of_trained(
    run: Run, choice: Choice | None = None, joints: JointModel | None = None
) -> WalkEngine:
    """Choose the loop for all gaits of a run; a family takes its commands."""
    return engine_of(controlled_gait(run, joints), choice)


def _design(controlled: ControlledGait) -> Design:
    # Hashes are for those who get a controller; here the text itself is what is hashed.
    unknown = "0" * 64
    origin = Origin(unknown, unknown, None, None, "walk", "-")
    # Walks bring the law that they are asked for.
    return Design.of(controlled, {"pd": law_named("pd")}, origin)


def sources(design: Design) -> dict[str, str]:
    """Return all files to compile. Raises: NativeError for a policy that C cannot express."""
    try:
        gait = gait_files(design, (ground(design.controller),))
    except SpecError as error:
        raise NativeError(f"C cannot express its policy ({error})") from None
    shipped = output_folder.shipped() | output_folder.adaptation()
    folder = resources.files("neuralgaits.simulation.native") / "c"
    loop_files = ("walk.c", "walk.h", "clf_qp.c", "clf_qp.h")
    loop = {name: (folder / name).read_text(encoding="utf-8") for name in loop_files}
    shipped_files = (
        *("controller.h", "ng_math.h", "estimator.h", "adapt.h"),
        *("controller.c", "estimator.c", "adapt.c"),
    )
    return gait | loop | {name: shipped[name] for name in shipped_files}


def _engine(texts: Mapping[str, str], controller: Controller) -> WalkEngine:
    """Return the walk of these sources, compiled now or before.

    Raises: CompilerError if they do not compile, NativeError without a compiler or if the library
        does not load.
    """
    compiler = Compiler.for_c()
    if compiler is None:
        raise NativeError(
            "there is no C compiler: install gcc or clang, or pip install 'neuralgaits[compiler]'"
        )
    walk, folder = _shared_library(texts), cache_folder() / "walks"
    try:
        return WalkEngine(Library(compiler.cached(walk, folder), controller), None)
    except OSError as error:
        note = (
            f"compiled the walk for this command alone, because {folder} cannot be written "
            f"({error.strerror})"
        )
        # A folder each: what is loaded under one name is not loaded again.
        _own_folders.append(tempfile.TemporaryDirectory(prefix="neuralgaits-"))
        library = compiler.compile(walk, Path(_own_folders[-1].name))
        return WalkEngine(Library(library, controller), note)


def _shared_library(texts: Mapping[str, str]) -> SharedLibrary:
    """Return the library of a walk, to compile."""
    return SharedLibrary(
        "walk",
        texts,
        SOURCES,
        FLAGS,
        headers=(Path(mujoco.__file__).parent / "include",),
        links=("-lm",),
        depends_on=(mujoco.__version__,),
    )
