"""Write the files of one gait: `gait.h` with its facts, `gait.c` with its functions."""

import string
from collections.abc import Sequence

import numpy as np

from neuralgaits.control import AbstractLaw
from neuralgaits.export import controller_facts, controller_prose
from neuralgaits.export.design import Design
from neuralgaits.export.programs import parts
from neuralgaits.export.robot_programs import Part
from neuralgaits.export.schedule_tables import schedule_literal
from neuralgaits.programs.c99.c_writer import CFunction
from neuralgaits.programs.c99.constant_arrays import Tables, braces, literal
from neuralgaits.programs.c99.function import emit

_PLAIN = frozenset(string.ascii_letters + string.digits + " _-.,:;+/()[]")
"""Characters that are safe in a string of C, whatever comes before and after."""


def gait_files(design: Design, host_parts: Sequence[Part] = ()) -> dict[str, str]:
    """Return the text of `gait.h` and `gait.c`.

    Args:
        design: design of the controller.
        host_parts: functions that a host needs beside those of the controller.

    Raises: SpecError naming the primitive of a policy that C cannot express, InputError for a
    law that is not one of this package.
    """
    tables = Tables("ng")
    functions = [
        emit(part.program, part.function, part.about, tables)
        for part in (*parts(design.controller), *host_parts)
    ]
    return {"gait.h": _header(design, functions), "gait.c": _code(design, functions, tables)}


def _header(design: Design, functions: list[CFunction]) -> str:
    lines = [
        *(
            "/*",
            *(f" * {commented(line)}".rstrip() for line in controller_prose.prose(design)),
            " */",
        ),
        "#ifndef NG_GAIT_H",
        "#define NG_GAIT_H",
        "",
        '#include "ng_math.h"',
        "",
        *_names(design),
        "",
        "/* Numbers with units. */",
        *(
            f"#define NG_{number.name.upper()} {_literal(number.value)} /* {number.unit} */"
            for number in controller_facts.numbers(design)
        ),
        "",
        "/* Arrays: see gait.c for units. */",
        *(
            f"extern const ng_real {_declaration(array)};"
            for array in controller_facts.arrays(design)
        ),
        "",
        "/* Written from the Programs of the gait. */",
        *(f"{function.prototype};" for function in functions),
        "",
        "#endif",
    ]
    return "\n".join(lines) + "\n"


def _names(design: Design) -> list[str]:
    """Return macros without a unit; laws are numbered as in `ng_laws`."""
    words = controller_facts.names(design) | {
        f"law_{name.replace('-', '_')}": number for number, name in enumerate(design.controllers)
    }
    words["law_default"] = list(design.controllers).index(design.default_law)
    return [
        f"#define NG_{name.upper()} {value if isinstance(value, int) else quoted(value)}"
        for name, value in words.items()
    ]


def commented(line: str) -> str:
    """Return a line of a comment. Names come from other people's files; none may end it."""
    printable = "".join(sign if sign.isprintable() else "?" for sign in line)
    return printable.replace("*/", "* /").replace("/*", "/ *").rstrip("\\")


def quoted(text: str) -> str:
    """Return a string of C. A character that could end it is written as a number, byte by byte."""
    signs = (chr(byte) if chr(byte) in _PLAIN else f"\\{byte:03o}" for byte in text.encode())
    return f'"{"".join(signs)}"'


def _literal(value: float | int) -> str:
    return f"{value}u" if isinstance(value, int) else literal(value)


def _code(design: Design, functions: list[CFunction], tables: Tables) -> str:
    arrays = [
        f"/* {array.unit} */\nconst ng_real {_declaration(array)} = {braces(array.value)};"
        for array in controller_facts.arrays(design)
    ]
    # Before the tables are written: a law may add some.
    laws = _laws(design, tables)
    sections = [
        "/* Data and functions of the gait described in gait.h. Written by a program. */",
        '#include "controller.h"',
        *arrays,
        "/* Constants of the Programs, whose matrices stand column by column, and of laws. */",
        *tables.texts.values(),
        laws,
        *(function.body for function in functions),
    ]
    return "\n\n".join(sections) + "\n"


def _laws(design: Design, tables: Tables) -> str:
    rows = [f"    {_law(name, c.law, tables)}," for name, c in design.controllers.items()]
    return "\n".join(["const ng_law ng_laws[NG_LAW_COUNT] = {", *rows, "};"])


def _law(name: str, law: AbstractLaw, tables: Tables) -> str:
    form = controller_prose.exported_form(law)
    values = [
        f".name = {quoted(name)}",
        f".hold_ticks = {law.hold_ticks}",
        f".model = {int(form.model)}",
        f".measure_z2 = {int(form.measure_z2)}",
        f".uses_impact_consistent_rates = {int(law.uses_impact_consistent_rates)}",
        f".bandwidth = {literal(form.bandwidth)}",
    ]
    for gain in ("stiffness", "damping"):
        if numbers := getattr(form, gain):
            values.append(f".{gain} = {braces(np.array(numbers))}")
    if form.schedule is not None:
        schedule = schedule_literal(form.schedule, tables)
        values.append(f".schedule = &(const ng_schedule){schedule}")
    return "{" + ", ".join(values) + "}"


def _declaration(array: controller_facts.Array) -> str:
    return f"ng_{array.name}" + "".join(f"[{n}]" for n in np.shape(array.value))
