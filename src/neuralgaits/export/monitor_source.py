"""Write the monitor of a gait: `monitor_set.h` and `.c`, from the Programs of its sets."""

import numpy as np

from neuralgaits.analysis.state_monitor import NO_NUMBER, StateMonitor, StateSet
from neuralgaits.export import output_folder
from neuralgaits.export.design import Design
from neuralgaits.export.source import commented, quoted
from neuralgaits.programs.c99.c_writer import CFunction
from neuralgaits.programs.c99.constant_arrays import Tables, braces, wrapped
from neuralgaits.programs.c99.function import emit


def monitor_files(design: Design) -> dict[str, str]:
    """Return the files of a gait's monitor; none if nothing is proved of it.

    Raises: SpecError naming an operation of a set that has no form in C.
    """
    monitor = design.monitor
    if monitor is None:
        return {}
    tables = Tables("ng")
    functions = [emit(one.program, _function(one), one.about, tables) for one in monitor.sets]
    own = {
        "monitor_set.h": _header(design, monitor, functions),
        "monitor_set.c": _code(monitor, functions, tables),
    }
    return output_folder.monitor() | own


def _function(one: StateSet) -> str:
    return f"ng_{one.name}_margins"


def _prose(design: Design, monitor: StateMonitor) -> list[str]:
    """Say what the sets are, and what they are about."""
    lines = [
        "Sets that are proved of this gait, for monitor.c. Written by a program, from the",
        "functions of the certificate itself.",
        "",
        f"proof file  sha256 {monitor.proof_sha256}",
        f"robot file  sha256 {monitor.robot_sha256}",
        f"stated {design.origin.proof_verdict}; check-proof bounds its boxes again",
        "",
        "States are q, dq of the model that stands on its foot, with the masses of the robot file.",
    ]
    for one in monitor.sets:
        lines += [
            "",
            f"Level {' and '.join(map(str, one.levels))}. A state is in the set if no margin is "
            "negative.",
            f"  Ends of a step count only where they are negative: {', '.join(one.ends)}.",
            f"  Others: {', '.join(one.walls)}.",
        ]
    if 2 in monitor.levels:
        lines += ["", "Level 2 is about outputs that are zero, and its set does not look at them."]
    if monitor.bandwidth is not None:
        lines += [
            "",
            "Level 4 is about the torques of exact input-output linearisation in continuous time,",
            f"with w = {monitor.bandwidth!r} rad/s.",
        ]
    if monitor.hold_s is not None:
        lines += [
            "Level 5 is about one law, bandwidth and clock, which gait.h names, with ticks at most",
            "NG_MONITOR_HOLD_US apart.",
        ]
    return lines


def _header(design: Design, monitor: StateMonitor, functions: list[CFunction]) -> str:
    words = {"PROOF": monitor.proof_sha256, "ROBOT": monitor.robot_sha256}
    size = max(len(one.names) for one in monitor.sets)
    lines = [
        *("/*", *(f" * {commented(x)}".rstrip() for x in _prose(design, monitor)), " */"),
        "#ifndef NG_MONITOR_SET_H",
        "#define NG_MONITOR_SET_H",
        "",
        '#include "controller.h"',
        "",
        *(f"#define NG_MONITOR_{k}_SHA256 {quoted(v)}" for k, v in words.items()),
        f"#define NG_MONITOR_LEVELS {len(monitor.levels)}",
        f"#define NG_MONITOR_SETS {len(monitor.sets)}",
        f"#define NG_MONITOR_MARGINS {size} /* the most of a set */",
        f"#define NG_MONITOR_HOLD_US {monitor.hold_us}u /* 0: no time between ticks is proved */",
        "",
        "extern const int ng_monitor_level[NG_MONITOR_LEVELS];",
        "extern const int ng_monitor_set_of[NG_MONITOR_LEVELS]; /* the set of each level */",
        "extern const int ng_monitor_ends[NG_MONITOR_SETS];     /* margins that come first */",
        "extern const int ng_monitor_walls[NG_MONITOR_SETS];    /* margins behind them */",
        "extern const char *const ng_monitor_names[NG_MONITOR_SETS][NG_MONITOR_MARGINS];",
        *(f"extern const ng_real ng_monitor_{name}[NG_COMMANDS];" for name in _ranges(monitor)),
        "",
        "/* All margins of a state in a set, those of ends first. */",
        "void ng_monitor_margins(int set, const ng_state *state, const ng_command *command,",
        "                        ng_real margins[NG_MONITOR_MARGINS]);",
        "",
        "/* Written from the Programs of the sets. */",
        *(f"{function.prototype};" for function in functions),
        "",
        "#endif",
    ]
    return "\n".join(lines) + "\n"


def _ranges(monitor: StateMonitor) -> dict[str, np.ndarray]:
    """Return the proved ranges of commands, by name; none without commands."""
    if not monitor.commands:
        return {}
    changes = [-NO_NUMBER if one.change is None else one.change for one in monitor.commands]
    return {
        "low": np.array([one.low for one in monitor.commands]),
        "high": np.array([one.high for one in monitor.commands]),
        "change": np.array(changes),
    }


def _code(monitor: StateMonitor, functions: list[CFunction], tables: Tables) -> str:
    levels = monitor.levels
    places = [monitor.sets.index(monitor.set_of(level)) for level in levels]
    counts = {
        "level[NG_MONITOR_LEVELS]": levels,
        "set_of[NG_MONITOR_LEVELS]": places,
        "ends[NG_MONITOR_SETS]": [len(one.ends) for one in monitor.sets],
        "walls[NG_MONITOR_SETS]": [len(one.walls) for one in monitor.sets],
    }
    names = [
        wrapped(f"    {{{', '.join(quoted(name) for name in one.names)}}},") for one in monitor.sets
    ]
    sections = [
        "/* Sets of the gait that monitor_set.h describes. Written by a program. */",
        '#include "monitor_set.h"',
        "\n".join(
            f"const int ng_monitor_{name} = {{{', '.join(map(str, values))}}};"
            for name, values in counts.items()
        ),
        "\n".join(
            [
                "const char *const ng_monitor_names[NG_MONITOR_SETS][NG_MONITOR_MARGINS] = {",
                *names,
                "};",
            ]
        ),
        *(
            f"const ng_real ng_monitor_{name}[NG_COMMANDS] = {braces(values)};"
            for name, values in _ranges(monitor).items()
        ),
        "/* Constants of the Programs; matrices stand column by column. */",
        *tables.texts.values(),
        *(function.body for function in functions),
        _dispatch(monitor),
    ]
    return "\n\n".join(sections) + "\n"


def _dispatch(monitor: StateMonitor) -> str:
    """Write the function that asks for the margins of a set by its number."""
    lines = [
        "void ng_monitor_margins(int set, const ng_state *state, const ng_command *command,",
        "                        ng_real margins[NG_MONITOR_MARGINS])",
        "{",
        "    (void)state;",
        "    switch (set) {",
    ]
    # Places of the inputs of a set in the controller.
    places = {
        "after": "state->after",
        "before": "state->before",
        "dq": "command->dq",
        "q": "command->q",
        "step": "state->step",
    }
    for number, one in enumerate(monitor.sets):
        inputs = [places[item.name] for item in one.program.inputs]
        arguments = ", ".join([*inputs, "margins", f"margins + {len(one.ends)}"])
        lines += [
            f"    case {number}:",
            f"        {_function(one)}({arguments});",
            "        break;",
        ]
    return "\n".join([*lines, "    }", "}"])
