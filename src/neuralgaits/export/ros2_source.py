"""Write a ros2_control package around the controller in C."""

import html
import re
from importlib import resources

from neuralgaits._version import __version__
from neuralgaits.deployment.board_map import BoardMap
from neuralgaits.errors import SpecError
from neuralgaits.export.board_source import BOARD_SOURCES
from neuralgaits.export.build import CORE
from neuralgaits.export.design import Design
from neuralgaits.export.source import quoted

_PLAIN = {
    "START": "blend_s: 1.0  # from holding the first posture to the gait\n    stance_leg: 0",
    "DEPEND": "",
    "FIND": "",
    "USED": "",
}
"""Words of a package that walks once it is activated."""
_SUPERVISED = {
    "START": "request: damp  # damp, stand or walk; it may be set while the controller is active",
    "DEPEND": "<depend>rcl_interfaces</depend>",
    "FIND": "find_package(rcl_interfaces REQUIRED)",
    "USED": " rcl_interfaces",
}
"""Words of a package with the supervisor, which asks for the result of setting a parameter."""


def ros2_files(design: Design, controller: dict[str, str]) -> dict[str, str]:
    """Return the files of a ROS 2 package.

    Args:
        design: design of the controller, with a deployment file.
        controller: files of the controller in C.

    Returns: text of each file, those of the controller included.
    Raises: SpecError without a deployment file.
    """
    if design.deployment is None:
        raise SpecError("expected a design with a deployment file, found none: give it one")
    # Files of the controller in C that a plugin has no use for.
    unused = {"link.c", "amber_log.c", "amber_log.h", "adapt.c", "adapt.h"}
    if not design.supervised:
        unused |= {"supervisor.c", "supervisor.h"}
    own = {name: text for name, text in controller.items() if name not in unused}
    folder = resources.files("neuralgaits.export") / "ros2"
    texts = {
        entry.name: entry.read_text(encoding="utf-8")
        for entry in folder.iterdir()
        if entry.name.rpartition(".")[2] in ("cpp", "hpp", "txt", "xml", "yaml")
    }
    words = _words(design, own)
    package = package_name(design)
    for name, text in texts.items():
        for key, value in words.items():
            # A word that is empty leaves no empty line.
            text = re.sub(rf"^ *@{key}@\n", "", text, flags=re.MULTILINE) if not value else text
            text = text.replace(f"@{key}@", value)
        own[name] = text.replace("neuralgaits_package", package)
    return own | {"ros2_facts.h": _facts(design)}


def package_name(design: Design) -> str:
    """Return the name of the package: small letters, digits and single underscores."""
    robot = re.sub("[^a-z0-9]+", "_", design.controller.robot.name.lower()).strip("_")
    return f"neuralgaits_{robot or 'robot'}"


def _sources(files: dict[str, str]) -> list[str]:
    """Return the C files to compile."""
    monitor = [name for name in ("monitor.c", "monitor_set.c") if name in files]
    supervisor = [name for name in ("supervisor.c",) if name in files]
    return [*CORE, *supervisor, "selftest.c", *BOARD_SOURCES, *monitor]


def _joints(design: Design) -> list[str]:
    """Return names of joints by motor index; empty for a motor without one."""
    assert design.deployment is not None
    names = [""] * BoardMap.of(design.deployment, design.controller.robot.layout).motors
    for one in design.deployment.joints:
        names[one.motor] = one.joint
    return names


def _contacts(design: Design) -> list[str]:
    """Return state interfaces of contacts by channel; empty for a channel without one."""
    assert design.deployment is not None
    names = [""] * BoardMap.of(design.deployment, design.controller.robot.layout).channels
    for one in design.deployment.contacts:
        names[one.channel] = f"{one.foot}/contact"
    return names


def _words(design: Design, files: dict[str, str]) -> dict[str, str]:
    origin = design.origin
    about = (
        f"A walking gait of {design.controller.robot.name}, spec {origin.spec}, policy sha256 "
        f"{origin.policy_sha256}"
    )
    return {
        "VERSION": ".".join([*re.findall("[0-9]+", __version__), "0", "0", "0"][:3]),
        "DESCRIPTION": html.escape("".join(c if c.isprintable() else "?" for c in about)),
        "SOURCES": "\n  ".join(_sources(files)),
        "RATE": str(round(1.0 / design.controller.period_s)),
        "JOINTS": ", ".join(_yaml(name) for name in _joints(design)),
        "CONTACTS": ", ".join(_yaml(name) for name in _contacts(design)),
        "LAW": design.default_law,
        **(_SUPERVISED if design.supervised else _PLAIN),
    }


def _yaml(text: str) -> str:
    """Return a text between single quotes, as YAML reads it."""
    return "'" + text.replace("'", "''") + "'"


def _facts(design: Design) -> str:
    """Return `ros2_facts.h`: names of interfaces, and what there is beside the controller."""
    lines = [
        "/* Names that the controller asks for, by motor and by channel. Written by a program. */",
        "#ifndef NG_ROS2_FACTS_H",
        "#define NG_ROS2_FACTS_H",
        "",
        f"#define NG_ROS2_MONITOR {int(design.monitor is not None)}",
        f"#define NG_ROS2_SUPERVISOR {int(design.supervised)}",
        "",
        *_array("joints", _joints(design)),
        *_array("contacts", _contacts(design)),
        "",
        "#endif",
    ]
    return "\n".join(lines) + "\n"


def _array(name: str, texts: list[str]) -> list[str]:
    rows = ", ".join(quoted(text) for text in texts)
    return [f"static const char *const ng_ros2_{name}[] = {{{rows}}};"]
