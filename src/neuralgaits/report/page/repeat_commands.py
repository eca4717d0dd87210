"""Commands that reproduce a run, as far as its folder records how it was made.

Robots and specs are named here and nowhere else: by a built-in's name if the run's copy is the
built-in, else by the run's own copy, since the original file may have changed or moved.
"""

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from neuralgaits._control_laws import CONTROL_LAWS
from neuralgaits.barriers import specs
from neuralgaits.records.simulated import LOCKSTEP, MUJOCO, LinkFigures, Simulated
from neuralgaits.records.training_config import GaitOrigin, TrainingConfig, asked_of
from neuralgaits.report.page import phrases
from neuralgaits.robots import registry
from neuralgaits.runs import RunFolder
from neuralgaits.runs.names import GAIT, RESIDUAL, ROBOT, SPEC
from neuralgaits.runs.shell_words import command, named
from neuralgaits.simulation.incompatible_settings import REMOTE

CONTROLLERS = *CONTROL_LAWS, REMOTE


def robot_word(folder: RunFolder) -> str:
    """Return the run's robot as a word of the command line."""
    copy, name = folder.path / ROBOT, asked_of(folder).robot
    if name in registry.built_in() and copy.is_file():
        file = registry.model_file(name)
        if copy.read_bytes().decode(errors="replace") == file.read_text(encoding="utf-8"):
            return name
    return named(copy)


def spec_word(folder: RunFolder) -> str | None:
    """Return the run's spec as a word of the command line; None if no file defines it."""
    name = asked_of(folder).spec
    if specs.is_built_in(name):
        return name
    file, colon, attribute = name.rpartition(":")
    return f"{named(folder.path / SPEC)}:{attribute}" if colon and file.endswith(".py") else None


def training(
    folder: RunFolder, out: Path | None = None, *, steps: int | None = None, seed: int | None = None
) -> str | None:
    """Return the command that trains the gait again, optionally with other steps or another seed.

    Args:
        folder: folder of the run.
        out: new run folder; a fresh one below `runs` if None.
        steps: gradient steps, the run's own if None.
        seed: the run's own if None.

    Returns: the command, or None if the run's spec is in no file or its parent run is missing. For
        a gait that was not trained, the command ignores steps and seed.
    """
    asked, spec = asked_of(folder), spec_word(folder)
    if asked.parent is not None:
        parent = _parent(folder, asked.parent)
        if parent is None:
            return None
        line = ["refine", named(parent), "--residual", named(folder.path / RESIDUAL)]
        if asked.disturbance and any(asked.disturbance):
            line += ["--disturbance", ",".join(repr(bound) for bound in asked.disturbance)]
    elif asked.as_given is not None:
        return command(
            *_given(folder, asked.as_given), *([] if out is None else ["--out", named(out)])
        )
    elif spec is None:
        return None
    else:
        line = ["train", robot_word(folder), "--spec", spec, "--init", asked.init]
        if asked.hidden:
            line += ["--hidden", ",".join(str(width) for width in asked.hidden)]
        line += _told(asked)
    line += ["--seed", str(asked.seed if seed is None else seed)]
    line += ["--steps", str(asked.steps if steps is None else steps)]
    if asked.certify is not None:
        budget = asked.certify.budget_s
        line += ["--certify", *([] if budget is None else ["--budget", str(budget)])]
    return command(*line, *([] if out is None else ["--out", named(out)]))


def _given(folder: RunFolder, given: GaitOrigin) -> list[str]:
    """Return the words that recreate a run whose gait was not trained."""
    robot = robot_word(folder)
    if given.by == "optimise":
        return ["optimise", robot, f"--speed={given.speed!r}", "--degree", str(given.degree)]
    return ["import-gait", named(folder.path / GAIT), "--robot", robot]


def another_seed(folder: RunFolder) -> str | None:
    """Return the command that trains the same gait with the next seed; see `training`."""
    return training(folder, seed=(asked_of(folder).seed + 1) % 2**31)


def longer(folder: RunFolder) -> str:
    """Return the command that trains twice as long; a fresh one if `training` has none."""
    twice = 2 * asked_of(folder).steps
    anew = ("train", robot_word(folder), "--spec", spec_word(folder) or "walking")
    return training(folder, steps=twice) or command(*anew, "--steps", twice)


def _told(asked: TrainingConfig) -> list[str]:
    """Return the flags of a commanded speed, of ranges of commands, or of a box of robots."""
    if asked.speed is not None:
        return [f"--speed={asked.speed!r}"]
    words = [] if not asked.parameters else ["--parameters", box(asked.parameters)]
    for name, told in asked.commands.items():
        ends = (_typed(name, x) for x in (told.low, told.high))
        words.append(f"--{name.replace('_', '-')}={':'.join(repr(float(x)) for x in ends)}")
    return words


def _typed(name: str, value: float) -> float:
    """Convert a command to the unit of the command line: a slope to degrees."""
    return math.degrees(value) if name == "slope" else value


def _parent(folder: RunFolder, told: str) -> Path | None:
    """Find the parent run at its recorded path, or beside this run; None if it is in neither."""
    places = Path(told), folder.path.resolve().parent / Path(told).name
    return next((place for place in places if (place / "config.json").is_file()), None)


def box(parameters: Mapping[str, float]) -> str:
    """Write a box of robots as the command line takes it, every number exactly; `none` if empty."""
    units = {"com": "m", "floor": "m"}
    sizes = (f"{name}={half!r}{units.get(name, '')}" for name, half in parameters.items())
    return ",".join(sizes) or "none"


def certifying(
    run: Path,
    level: int,
    disturbance: tuple[float, ...] = (),
    within: Mapping[str, tuple[float, float]] | None = None,
    parameters: Mapping[str, float] | None = None,
) -> str:
    """Return the command that proves a run up to a level.

    Args:
        run: folder of the run.
        level: highest level to prove.
        disturbance: bounds on the disturbance at level 2; empty for none.
        within: narrower ranges of its commands; the full ranges if None.
        parameters: box of robots; that of the run if None.
    """
    line: list[Any] = ["certify", named(run), "--level", level]
    if disturbance:
        line += ["--disturbance", ",".join(repr(bound) for bound in disturbance)]
    if within:
        ranges = (
            f"{name}={':'.join(repr(_typed(name, end)) for end in ends)}"
            for name, ends in within.items()
        )
        line += ["--within", ",".join(ranges)]
    if parameters is not None:
        line += ["--parameters", box(parameters)]
    return command(*line)


def simulating(folder: RunFolder, done: Simulated, run: Path) -> str | None:
    """Return the command that repeats a simulation.

    Args:
        folder: run folder that holds the simulation.
        done: summary of the simulation.
        run: folder of the run that walks.

    Returns: the command, or None if the run kept no file of the plant or of the controller.
    """
    plant = plant_word(folder, done)
    if done.controller not in CONTROLLERS or plant is None:
        return None
    line: list[Any] = ["simulate", named(run), *(["--plant", plant] if plant else [])]
    line += ["--controller", done.controller, "--steps", 50 if done.steps is None else done.steps]
    if done.link is not None:
        line += ["--link", _link(done.link)]
    if done.simulator != MUJOCO:
        line += ["--simulator", done.simulator]
    line += ["--start", done.start, "--seed", done.seed, "--episodes", done.episodes]
    if done.push:
        line += ["--push", done.push]
    if done.command:
        told = (f"{name}={_typed(name, value)!r}" for name, value in done.command.items())
        line += ["--command", ",".join(told)]
    if done.commands is not None:
        line += ["--commands", done.commands]
    if done.parameters:
        line += ["--parameters", box(done.parameters)]
    if done.terrain is not None:
        line += ["--terrain", done.terrain]
    changed = phrases.disturbances(done.changed)
    if changed:
        line += ["--disturb", ",".join(f"{name}={value!r}" for name, value in changed.items())]
    return command(*line)


def plant_word(folder: RunFolder, done: Simulated) -> str | None:
    """Return the plant of a simulation as a word of the command line.

    Returns: the empty string for the run's own robot; None if the run kept no file of the plant.
    """
    if done.plant_given == "":
        # Summaries of earlier versions have the name that the robot file gives itself.
        own = done.plant == asked_of(folder).robot
        return "" if own else done.plant if done.plant in registry.built_in() else None
    given = done.plant_given
    if given is None or given in registry.built_in():
        return given or ""
    return named(folder.path / given) if (folder.path / given).is_file() else None


def _link(link: LinkFigures) -> str:
    """Return the settings of a controller's connection, as `--link` takes them."""
    asked = {"loss": link.loss, "jitter_ms": link.jitter_ms, "blend_s": link.blend_s}
    lockstep = ["lockstep=1"] if link.mode == LOCKSTEP else []
    numbers = (f"{name}={value!r}" for name, value in asked.items() if value)
    return ",".join([f"law={link.law}", *lockstep, *numbers])
