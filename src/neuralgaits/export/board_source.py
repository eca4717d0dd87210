"""Write the map of a deployment file in C: its numbers, beside the code that every map shares."""

import numpy as np

from neuralgaits.deployment.board_map import BoardMap
from neuralgaits.deployment.deployment_file import DeploymentFile
from neuralgaits.export import output_folder
from neuralgaits.export.design import Design
from neuralgaits.export.source import commented
from neuralgaits.programs.c99.constant_arrays import braces, literal

BOARD_SOURCES = ("board_map.c", "board_facts.c")
"""Files to compile beside those of the controller."""


def board_files(design: Design) -> dict[str, str]:
    """Return the files of the map of a design's deployment file; none without one.

    Returns: `board_map.h`, `board_map.c`, `board_facts.h`, `board_facts.c` by name.
    """
    deployment = design.deployment
    if deployment is None:
        return {}
    board = BoardMap.of(deployment, design.controller.robot.layout)
    about = [
        "The numbers of a deployment file; the map that they make: board_map.h.",
        f"deployment file sha256 {deployment.sha256}",
        "",
        *_table(deployment),
    ]
    comment = ["/*", *(f" * {commented(line)}".rstrip() for line in about), " */"]
    reals = _reals(board)
    header = [
        *comment,
        "#ifndef NG_BOARD_FACTS_H",
        "#define NG_BOARD_FACTS_H",
        "",
        '#include "gait.h"',
        "",
        f'#define NG_BOARD_SHA256 "{deployment.sha256}"',
        f"#define NG_BOARD_MOTORS {board.motors}",
        f"#define NG_BOARD_CHANNELS {board.channels}",
        f"#define NG_BOARD_PITCH_SIGN {literal(board.pitch_sign)}",
        f"#define NG_BOARD_PITCH_ZERO {literal(board.pitch_zero)} /* [rad] */",
        "",
        "extern const int ng_board_motor[NG_LEGS][NG_LEG_JOINTS];",
        "extern const int ng_board_channel[NG_LEGS];",
        *(f"extern const ng_real {_name(name, value)};" for name, value in reals.items()),
        "",
        "#endif",
    ]
    rows = ", ".join("{" + ", ".join(map(str, row)) + "}" for row in board.motor.tolist())
    code = [
        '#include "board_facts.h"',
        "",
        f"const int ng_board_motor[NG_LEGS][NG_LEG_JOINTS] = {{{rows}}};",
        f"const int ng_board_channel[NG_LEGS] = {{{', '.join(map(str, board.channel.tolist()))}}};",
        *(f"const ng_real {_name(n, value)} = {braces(value)};" for n, value in reals.items()),
    ]
    return output_folder.board() | {
        "board_facts.h": "\n".join(header) + "\n",
        "board_facts.c": "\n".join(code) + "\n",
    }


def _reals(board: BoardMap) -> dict[str, np.ndarray]:
    """Return the arrays of real numbers by name: units as in the deployment file."""
    return {
        "sign": board.sign,
        "zero": board.zero,
        "gear": board.gear,
        "lower": board.lower,
        "upper": board.upper,
        "torque_limit": board.torque_limit,
        "kp": board.kp,
        "kd": board.kd,
        "newton": board.newton,
        "no_contact": board.contact_zero,
    }


def _name(name: str, value: np.ndarray) -> str:
    sizes = "[NG_LEGS][NG_LEG_JOINTS]" if value.ndim == 2 else "[NG_LEGS]"
    return f"ng_board_{name}{sizes}"


def _table(deployment: DeploymentFile) -> list[str]:
    """Return a line for each motor, in their order."""
    return [
        f"  motor {one.motor}: {one.joint}, sign {one.sign:+d}, zero {one.zero_rad:g} rad, "
        f"gear {one.gear:g}"
        for one in sorted(deployment.joints, key=lambda one: one.motor)
    ]
