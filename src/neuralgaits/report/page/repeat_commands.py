"""Commands that reproduce a run, as far as its folder records how it was made.

Robots and specs are named here and nowhere else: by a built-in's name if the run's copy is the
built-in, else by the run's own copy, since the original file may have changed or moved.
"""

from collections.abc import Callable, Mapping
from dataclasses import fields
from pathlib import Path
from typing import Any, ParamSpec

from neuralgaits._checks import SEEDS
from neuralgaits._control_laws import CONTROL_LAWS
from neuralgaits.barriers import specs
from neuralgaits.errors import InputError
from neuralgaits.records.link_figures import LOCKSTEP, LinkFigures
from neuralgaits.records.simulated import SimulationSummary
from neuralgaits.records.training_config import GaitOrigin, TrainingConfig, config_of
from neuralgaits.report.page import phrases
from neuralgaits.robots import registry
from neuralgaits.runs import RunFolder
from neuralgaits.runs.names import GAIT, RESIDUAL, ROBOT, SPEC
from neuralgaits.runs.shell_words import command, named
from neuralgaits.settings import (
    CertifySettings,
    ImportGaitSettings,
    OptimiseSettings,
    RefineSettings,
    SimulateSettings,
    TrainSettings,
)
from neuralgaits.settings.forms import command_word
from neuralgaits.settings.options import words_of
from neuralgaits.simulation.incompatible_settings import REMOTE

P = ParamSpec("P")
NOT_REPEATED = frozenset({"engine", "workers", "ray", "log", "video", "begun", "push_left"})
"""Settings of `simulate` that change no walk of a walker: who computes it, and what is written."""
IN_DISTURB = frozenset({"sensing", "gains", "drive_rate"})
"""Settings of `simulate` that its summary records as values of `disturb`."""


def robot_word(folder: RunFolder) -> str:
    """Return the run's robot as a word of the command line."""
    copy, name = folder.path / ROBOT, config_of(folder).robot
    if name in registry.built_in() and copy.is_file():
        file = registry.model_file(name)
        if copy.read_bytes().decode(errors="replace") == file.read_text(encoding="utf-8"):
            return name
    return named(copy)


def spec_word(folder: RunFolder) -> str | None:
    """Return the run's spec as a word of the command line; None if no file defines it."""
    name = config_of(folder).spec
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
    config, spec = config_of(folder), spec_word(folder)
    if config.as_given is not None:
        return _recreating(folder, config.as_given, out)
    proving = config.certify
    usual: dict[str, Any] = {
        "seed": config.seed if seed is None else seed,
        "steps": config.steps if steps is None else steps,
        "certify": proving is not None,
        "budget": None if proving is None else proving.budget_s,
        "out": out,
    }
    if config.parent is not None:
        parent = _parent(folder, config.parent)
        if parent is None:
            return None
        disturbance = config.disturbance if any(config.disturbance or ()) else None
        residual = folder.path / RESIDUAL
        return _line(
            "refine", RefineSettings, parent, residual=residual, disturbance=disturbance, **usual
        )
    if spec is None:
        return None
    return _line(
        "train",
        TrainSettings,
        robot_word(folder),
        spec,
        init=config.init,
        hidden=config.hidden or None,
        parameters=config.parameters or None,
        **_meant_for(config),
        **usual,
    )


def _line(verb: str, kind: Callable[P, Any], *args: P.args, **kwargs: P.kwargs) -> str | None:
    """Return the command with these settings; None if a damaged file has impossible ones."""
    try:
        return command(verb, *words_of(kind(*args, **kwargs)))
    except InputError:
        return None


def _meant_for(config: TrainingConfig) -> dict[str, Any]:
    """Return the settings of a commanded speed, or of ranges of commands."""
    if config.speed is not None:
        return {"speed": config.speed}
    return {name: (command.low, command.high) for name, command in config.commands.items()}


def _recreating(folder: RunFolder, origin: GaitOrigin, out: Path | None) -> str:
    """Return the command that recreates a run whose gait was not trained."""
    robot = robot_word(folder)
    if origin.by == "optimise":
        assert origin.speed is not None
        again = OptimiseSettings(robot, origin.speed, degree=origin.degree, out=out)
        return command("optimise", *words_of(again))
    imported = ImportGaitSettings(folder.path / GAIT, robot, out=out)
    return command("import-gait", *words_of(imported))


def another_seed(folder: RunFolder) -> str | None:
    """Return the command that trains the same gait with the next seed; see `training`."""
    return training(folder, seed=(config_of(folder).seed + 1) % SEEDS)


def longer(folder: RunFolder) -> str:
    """Return the command that trains twice as long, or as long as the recipe asks for if longer.

    It is one that trains afresh if `training` has none.
    """
    twice = max(2 * config_of(folder).steps, config_of(folder).recipe_steps)
    anew = ("train", robot_word(folder), "--spec", spec_word(folder) or "walking")
    return training(folder, steps=twice) or command(*anew, "--steps", twice)


def _parent(folder: RunFolder, path: str) -> Path | None:
    """Find the parent run at its recorded path, or beside this run; None if it is in neither."""
    places = Path(path), folder.path.resolve().parent / Path(path).name
    return next((place for place in places if (place / "config.json").is_file()), None)


def certifying(
    run: Path,
    level: int | None,
    disturbance: tuple[float, ...] = (),
    within: Mapping[str, tuple[float, float]] | None = None,
    parameters: Mapping[str, float] | None = None,
) -> str:
    """Return the command that proves a run up to a level.

    Args:
        run: folder of the run.
        level: highest level to prove; that of `certify` itself if None.
        disturbance: bounds on the disturbance at level 2; empty for none.
        within: narrower ranges of its commands; the full ranges if None.
        parameters: box of robots; that of the run if None.
    """
    settings = CertifySettings(
        run,
        level=level,
        disturbance=(disturbance[0], disturbance[1]) if disturbance else None,
        within=within or None,
        parameters=parameters,
    )
    return command("certify", *words_of(settings))


def simulating(folder: RunFolder, simulation: SimulationSummary, run: Path) -> str | None:
    """Return the command that repeats a simulation.

    A setting is the field of the summary with the same name, if nothing else is said below. So a
    new field of `SimulateSettings` is repeated, if it is recorded; if not, this fails.

    Args:
        folder: run folder that holds the simulation.
        simulation: summary of the simulation.
        run: folder of the run that walks.

    Returns: the command, or None if the run kept no file of the plant or of the controller.
    """
    plant = plant_word(folder, simulation)
    if simulation.controller not in (*CONTROL_LAWS, REMOTE) or plant is None:
        return None
    changed = phrases.disturbances(simulation.changed)
    other_forms: dict[str, Any] = {
        "run": run,
        "plant": plant or None,
        "steps": 50 if simulation.steps is None else simulation.steps,
        "link": None if simulation.link is None else settings_of_link(simulation.link),
        "push": simulation.push or None,
        "command": command_word(simulation.command) if simulation.command else None,
        "parameters": simulation.parameters or None,
        "monitor": simulation.monitor is not None,
        "disturb": ",".join(f"{name}={value!r}" for name, value in changed.items()) or None,
    }
    names = {one.name for one in fields(SimulateSettings)} - NOT_REPEATED - IN_DISTURB
    same_form = {name: getattr(simulation, name) for name in names - other_forms.keys()}
    return _line("simulate", SimulateSettings, **other_forms, **same_form)


def plant_word(folder: RunFolder, simulation: SimulationSummary) -> str | None:
    """Return the plant of a simulation as a word of the command line.

    Returns: the empty string for the run's own robot; None if the run kept no file of the plant.
    """
    if simulation.plant_given == "":
        # Summaries of earlier versions have the name that the robot file gives itself.
        own = simulation.plant == config_of(folder).robot
        return "" if own else simulation.plant if simulation.plant in registry.built_in() else None
    word = simulation.plant_given
    if word is None or word in registry.built_in():
        return word or ""
    return named(folder.path / word) if (folder.path / word).is_file() else None


def settings_of_link(link: LinkFigures) -> str:
    """Return the settings of a controller's connection, as `--link` takes them."""
    numbers_of_link = {"loss": link.loss, "jitter_ms": link.jitter_ms, "blend_s": link.blend_s}
    lockstep = ["lockstep=1"] if link.mode == LOCKSTEP else []
    numbers = (f"{name}={value!r}" for name, value in numbers_of_link.items() if value)
    address = [] if link.address is None else [f"address={link.address}"]
    return ",".join([f"law={link.law}", *lockstep, *numbers, *address])
