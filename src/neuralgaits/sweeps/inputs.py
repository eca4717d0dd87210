"""Copies of the files that a sweep starts from: its robots, and the specs that are in files."""

from collections.abc import Mapping, Sequence
from typing import Any

from neuralgaits._inputs import same_folder
from neuralgaits.barriers import specs as known_specs
from neuralgaits.barriers.commanded_spec import commands_of
from neuralgaits.robots.mjcf.loader import load_robot, robot_text
from neuralgaits.sweeps.grid import refuse_same, speed_of


def inputs_of(names: Sequence[str], settings: Mapping[str, Any]) -> dict[str, bytes]:
    """Return copies of the robots and of the specs that are in files, each checked to load.

    Raises: InputError, RobotError or SpecError.
    """
    refuse_same("robots", names)
    refuse_same("specs", settings["specs"])
    inputs = {}
    for spec in settings["specs"]:
        if spec not in known_specs.BUILT_IN and not known_specs.source_path(spec).is_file():
            # Says what is wrong with the name.
            known_specs.load(spec, load_robot(names[0]))
    for number, name in enumerate(names):
        inputs[robot_file(number)] = robot_text(name)[0].encode()
        robot = load_robot(name)
        for spec in settings["specs"]:
            for speed in settings["speeds"]:
                speed_range = speed_of(speed)
                spread = speed_range if isinstance(speed_range, tuple) else None
                one = None if isinstance(speed_range, tuple) else speed_range
                with same_folder():
                    known_specs.load(spec, robot, commands_of(speed=spread), one)
    for number, spec in enumerate(settings["specs"]):
        if spec not in known_specs.BUILT_IN:
            inputs[spec_file(number)] = known_specs.source_path(spec).read_bytes()
    return inputs


def robot_file(number: int) -> str:
    """Return the name of the copy of a robot."""
    return f"robot-{number}.xml"


def spec_file(number: int) -> str:
    """Return the name of the copy of a spec."""
    return f"spec-{number}.py"
