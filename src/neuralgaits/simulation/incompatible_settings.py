"""Refuse settings of a walk that exclude each other, each pair with one line.

`simulate` calls this before anything is compiled. Where one file reads both settings of a pair, it
refuses them: `setup/command_schedule.py`, `setup/drives.py`, `setup/floor_of_box.py`.
"""

import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from neuralgaits._control_laws import CONTROL_LAWS, names_of_laws
from neuralgaits.analysis.run import Run
from neuralgaits.control import AbstractLaw
from neuralgaits.control.law_by_name import at_bandwidth, exported_laws, law_named
from neuralgaits.control.speed_adapter import ADAPTED
from neuralgaits.errors import InputError
from neuralgaits.gait.commands import LEAN, SLOPE, Commands, place_of
from neuralgaits.robots.mjcf.drawn_robots import DrawnRobots
from neuralgaits.robots.parameter_box import checked_box
from neuralgaits.robots.robot_file import RobotFile
from neuralgaits.simulation.linked.config import LinkConfig, parse_link
from neuralgaits.simulation.setup.command_schedule import parsed
from neuralgaits.simulation.setup.disturbance import PlantChanges
from neuralgaits.simulation.setup.terrain_kinds import commands_from_terrain

REMOTE = "c"
"""Name of the controller that runs in a process of its own."""


def drawn_robots(
    run: Run,
    parameters: Mapping[str, float] | None,
    seed: int,
    plant: object | None,
    terrain: str | Path | None,
    controller: str | AbstractLaw,
) -> DrawnRobots | None:
    """Return robots of a box around a run's; None without a box.

    Raises: InputError if others are to walk.
    """
    box = checked_box(parameters or {})
    if not box:
        return None
    others = {"--plant": plant, "--terrain": terrain}
    names = [name for name, value in others.items() if value is not None]
    if controller == REMOTE:
        names.append(f"--controller {REMOTE}")
    if names:
        raise InputError(
            f"expected --parameters without {names[0]}, found both: robots are drawn around the "
            "run's own, and walk on its floor; leave one out"
        )
    return DrawnRobots(run.robot, box, seed)


def refuse_shared(
    controller: str | AbstractLaw,
    log: str | Path | None,
    film: str | Path | None,
    terrain: str | Path | None,
    *,
    monitor: bool = False,
    joints: bool = False,
) -> None:
    """Refuse options that only work in this process. Raises: InputError."""
    if not isinstance(controller, str) or controller == REMOTE:
        raise InputError(
            f"expected controller {names_of_laws()} with --workers or --ray, found "
            f"{_name(controller)}: leave --workers and --ray out, or --controller"
        )
    if log is not None or film is not None:
        raise InputError(
            "expected --workers or --ray without --log and --video, found them together: walk the "
            "one that is to be kept by itself"
        )
    for flag, value in (("--monitor", monitor), ("--joints", joints)):
        if value:
            raise InputError(
                f"expected {flag} without --workers or --ray, found them together: leave these out"
            )
    if terrain is not None:
        raise InputError(
            "expected --terrain without --workers or --ray, found them together: leave these out"
        )


def refuse_without_command(adapt: tuple[str, ...], commands: Commands) -> None:
    """Refuse to adapt commands that a gait does not take. Raises: InputError."""
    absent = [name for name in adapt if place_of(commands, name) is None]
    if not absent:
        return
    names = ", ".join(one.name for one in commands) or "no command"
    flags = {ADAPTED: "--speed A:B", LEAN: "--lean SIZE", SLOPE: "--slope A:B"}
    remedy = " ".join(flags[name] for name in absent)
    raise InputError(
        f"--adapt {','.join(adapt)}: expected a gait that takes {' and '.join(absent)} as command, "
        f"found one that takes {names}: train one with {remedy}, or leave --adapt out"
    )


def refuse_without_model(controller: str | AbstractLaw, wire: LinkConfig | None) -> None:
    """Refuse identified joints for a law whose torques are not the model's. Raises: InputError."""
    law = controller if wire is None else wire.law
    if wire is not None and wire.address:
        raise InputError(
            "expected --joints with a controller of this run, found --link address: that process "
            "was compiled without them here; export it with --joints, and leave --joints out"
        )
    if not law_named(law).takes_joints:
        *names, last = (name for name in CONTROL_LAWS if law_named(name).takes_joints)
        raise InputError(
            f"--joints: expected a law whose torques are the model's, {', '.join(names)} or "
            f"{last}, found {_name(law)}: leave --joints out"
        )


def refuse_bandwidth(
    controller: str | AbstractLaw, wire: LinkConfig | None, bandwidth: float | None
) -> None:
    """Refuse a bandwidth for a law without one, or in a process made before. Raises: InputError."""
    if bandwidth is None:
        return
    if wire is not None and wire.address:
        raise InputError(
            "expected --bandwidth with a controller of this run, found --link address: that "
            "process was compiled with its own; export it with --bandwidth, and leave this one out"
        )
    at_bandwidth(controller if wire is None else wire.law, bandwidth)


def about_other_robot(robot: RobotFile, plant: RobotFile) -> str | None:
    """State that a plant is another robot than the one that a gait was trained for.

    Args:
        robot: robot of the gait.
        plant: robot that walks, with as many links.

    Returns: one line; None for the same robot with slightly other numbers.
    """
    pairs = {
        "mass": (float(robot.mass), float(plant.mass), "kg"),
        "leg length": (robot.layout.leg_length, plant.layout.leg_length, "m"),
    }
    largest = 0.25  # Share by which mass or leg length differ before it is another robot.
    settings = [
        f"{what} {theirs:.3g} instead of {ours:.3g} {unit}"
        for what, (ours, theirs, unit) in pairs.items()
        if abs(theirs - ours) > largest * ours
    ]
    joints, others = robot.layout.leg_joints, plant.layout.leg_joints
    if joints != others:
        settings.insert(0, f"joints {', '.join(others[0])} instead of {', '.join(joints[0])}")
    welded, other = (welded_joints(one.layout.xml) for one in (robot, plant))
    if welded != other:
        settings.append(
            f"joints welded in its file: {other or 'none'}, and in that of the gait: "
            f"{welded or 'none'}"
        )
    if not settings:
        return None
    return (
        f"plant {plant.name} is another robot than {robot.name}, which the gait was trained for: "
        f"{'; '.join(settings)}; without --plant it walks on its own"
    )


def welded_joints(xml: str) -> str:
    """Return the joints that a file's list of changes has as welded; "" without any."""
    lines = re.findall(
        r"^ *(?:welded [^:\n]*: (.*)|ankle ([^:\n]*): removed.*)$", xml, re.MULTILINE
    )
    return ", ".join(listed or ankle for listed, ankle in lines)


def link_of(
    link: str | Mapping[str, Any] | LinkConfig | None, controller: str | AbstractLaw
) -> LinkConfig | None:
    """Return the settings of the link to a controller's process; None without one."""
    if controller != REMOTE:
        if link is None:
            return None
        raise InputError(
            f"expected --link with --controller {REMOTE} only, found {link!r} with "
            f"{_name(controller)}: {_linked(controller)}, or leave --link out"
        )
    return parse_link(link)


def _linked(controller: str | AbstractLaw) -> str:
    """Return the words of a command line that walks a law in a process of its own."""
    law = f"law={controller}," if controller in exported_laws() else ""
    return f"write --controller {REMOTE} --link {law}lockstep=1"


def _name(controller: str | AbstractLaw) -> str:
    return controller if isinstance(controller, str) else type(controller).__name__


def refuse_beside_terrain(
    terrain: str,
    command: str | Mapping[str, float] | None,
    commands: str | Path | None,
    disturbance: PlantChanges,
) -> None:
    """Refuse options that exclude a terrain. Raises: InputError."""
    if commands is not None:
        raise InputError(
            "expected --terrain or --commands, found both: what the robot sees sets its commands"
        )
    requested = parsed(command) if isinstance(command, str) else command or {}
    names = [name for name in requested if name in commands_from_terrain(terrain)]
    if names:
        raise InputError(
            f"expected --command without {names[0]} on a terrain, found {names[0]}: there the "
            "robot is told what it sees; leave it out"
        )
    if disturbance.slope_deg or disturbance.floor_height:
        raise InputError(
            "expected a terrain or a floor that is disturbed, found both: leave out slope_deg and "
            "floor_height"
        )
