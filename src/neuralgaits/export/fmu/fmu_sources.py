"""Write the C files of the controller's FMU."""

import hashlib
import re
from collections.abc import Iterable, Mapping, Sequence
from importlib import resources
from itertools import groupby

from neuralgaits.export import build
from neuralgaits.export.design import Design
from neuralgaits.export.fmu.fmu_variables import FmuVariable, JointList, VariableType
from neuralgaits.export.source import quoted
from neuralgaits.programs.c99.constant_arrays import wrapped

_ADAPTERS = {"3.0": ("fmi3.c", "fmi3_unused.c"), "2.0": ("fmi2.c", "fmi2_unused.c")}
_NAMES = {
    VariableType.REAL: ("real", "double"),
    VariableType.INTEGER: ("integer", "int32_t"),
    VariableType.BOOLEAN: ("boolean", "int"),
}


def model_identifier(design: Design) -> str:
    """Return the name of the FMU's binary, an identifier of C."""
    return f"neuralgaits_{re.sub('[^A-Za-z0-9_]', '_', design.controller.robot.name)}"


def headers() -> dict[str, str]:
    """Return the header files of both versions of the standard, which no FMU may hold."""
    folder = resources.files("neuralgaits.export.fmu") / "fmi_headers"
    return {
        entry.name: entry.read_text(encoding="utf-8")
        for entry in sorted(folder.iterdir(), key=lambda entry: entry.name)
        if entry.name.endswith(".h")
    }


def compiled_files(design: Design, version: str) -> tuple[str, ...]:
    """Return the names of the C files that make the binary."""
    monitor = () if design.monitor is None else ("monitor.c", "monitor_set.c")
    control = ("supervisor.c", "fmu_supervised.c") if design.supervised else ("fmu_gait.c",)
    return (*build.CORE, *monitor, *control, "fmu_model.c", "fmu.c", *_ADAPTERS[version])


def _included(names: Iterable[str], files: Mapping[str, str]) -> set[str]:
    """Return those of some files that are among `names`, or that these include."""
    included, ahead = set[str](), [name for name in names if name in files]
    while ahead:
        name = ahead.pop()
        if name not in included:
            included.add(name)
            ahead += [one for one in re.findall(r'#include "(.*?)"', files[name]) if one in files]
    return included


def source_files(
    design: Design,
    variables: Sequence[FmuVariable],
    version: str,
    controller: Mapping[str, str],
) -> tuple[dict[str, str], str]:
    """Return the files of `sources/`, and the token that ties them to their description.

    Args:
        design: design of the controller.
        variables: its variables, in the order of their value references.
        version: `2.0` or `3.0`.
        controller: files of the exported controller.
    """
    folder = resources.files("neuralgaits.export.fmu") / "c"
    available = dict(controller) | {"fmu_model.c": _tables(design, variables)}
    for name in ("fmu.c", "fmu.h", "fmu_gait.c", "fmu_supervised.c", *_ADAPTERS[version]):
        available[name] = (folder / name).read_text(encoding="utf-8")
    files = {
        name: available[name] for name in _included(compiled_files(design, version), available)
    }
    # The token is a hash of everything else, names of variables included.
    whole = hashlib.sha256(_header(design, variables, "").encode())
    for name in sorted(files):
        whole.update(f"{name} {len(files[name])}\n{files[name]}".encode())
    whole.update(repr(variables).encode())
    token = f"{{{whole.hexdigest()}}}"
    files["fmu_model.h"] = _header(design, variables, token)
    return dict(sorted(files.items())), token


def _typed(variables: Sequence[FmuVariable], type: VariableType) -> list[FmuVariable]:
    return [one for one in variables if one.type is type]


def _header(design: Design, variables: Sequence[FmuVariable], token: str) -> str:
    lines = [
        "/* Variables of the FMU: places, kinds and start values. Written by a program. */",
        "#ifndef NG_FMU_MODEL_H",
        "#define NG_FMU_MODEL_H",
        "",
        '#include "supervisor.h"' if design.supervised else '#include "gait.h"',
        "",
        f"#define NG_FMU_TOKEN {quoted(token)}",
        f"#define NG_FMU_MONITOR {int(design.monitor is not None)}",
        f"#define NG_FMU_SUPERVISOR {int(design.supervised)}",
        "",
        "/* Value references: of the time, and of the first variable of each type. */",
        "#define NG_FMU_TIME 0u",
    ]
    first = 1
    for type, (name, _) in _NAMES.items():
        count = len(_typed(variables, type))
        lines += [
            f"#define NG_FMU_FIRST_{name.upper()} {first}u",
            f"#define NG_FMU_{name.upper()}S {count}u",
        ]
        first += count
    lines += ["", "/* Places among the variables of a type; those of one group follow. */"]
    for type in VariableType:
        places = groupby(enumerate(_typed(variables, type)), key=lambda pair: pair[1].place)
        for place, members in places:
            lines.append(f"#define NG_FMU_{place} {next(members)[0]}")
    lines += [
        "",
        "/* Number of each joint, lowest first: a shared hip is one joint of both legs. */",
        "extern const int ng_fmu_joint[NG_LEGS][NG_LEG_JOINTS];",
        "",
        "/* i: input, p: parameter that is fixed, t: one that is tunable, o: output. */",
    ]
    for name, c_type in _NAMES.values():
        lines += [
            f"extern const char ng_fmu_{name}_kind[NG_FMU_{name.upper()}S + 1];",
            f"extern const {c_type} ng_fmu_{name}_start[NG_FMU_{name.upper()}S];",
        ]
    lines += [
        "",
        "/* Largest value of an integer that may be set; the smallest is 0. */",
        "extern const int32_t ng_fmu_integer_most[NG_FMU_INTEGERS];",
    ]
    return "\n".join([*lines, "", "#endif"]) + "\n"


def _tables(design: Design, variables: Sequence[FmuVariable]) -> str:
    legs = ", ".join(f"{{{', '.join(map(str, leg))}}}" for leg in JointList(design).by_leg)
    sections = [
        "/* See fmu_model.h. Written by a program. */",
        '#include "fmu_model.h"',
        f"const int ng_fmu_joint[NG_LEGS][NG_LEG_JOINTS] = {{{legs}}};",
    ]
    for type, (name, c_type) in _NAMES.items():
        own = _typed(variables, type)
        kinds = "".join(one.role.letter for one in own)
        starts = ", ".join(repr(one.start + 0) for one in own)
        size = f"NG_FMU_{name.upper()}S"
        sections += [
            f'const char ng_fmu_{name}_kind[{size} + 1] =\n    "{kinds}";',
            wrapped(f"const {c_type} ng_fmu_{name}_start[{size}] = {{{starts}}};"),
        ]
    most = ", ".join(str(one.high or 0) for one in _typed(variables, VariableType.INTEGER))
    sections.append(f"const int32_t ng_fmu_integer_most[NG_FMU_INTEGERS] = {{{most}}};")
    return "\n\n".join(sections) + "\n"
