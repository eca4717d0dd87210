"""A table of states and what Python makes of them, with the C function that compares it."""

import math

import numpy as np

from neuralgaits._types import Float
from neuralgaits.programs.c99.constant_arrays import braces, wrapped
from neuralgaits.programs.program import Program
from neuralgaits.systems.controller_header import ControllerHeader

TESTED = 8
"""States of the table."""


def selftest_name(header: ControllerHeader) -> str:
    """Return the name of the C function, which returns 0 or the first line that differs."""
    return f"{header.function}_selftest"


def selftest_file(
    header: ControllerHeader,
    program: Program,
    states: Float[np.ndarray, "k n"],
    expected: Float[np.ndarray, "k m"],
) -> dict[str, str]:
    """Return the C file by name; `expected` is the header's output at the states."""
    compared = header.output
    outputs = [(item.name, math.prod(item.shape)) for item in program.outputs]
    scale = max(header.limit, float(np.abs(expected).max()))
    # Largest differences, as shares of the limit.
    in_double, in_float = 1e-9 * scale, 1e-3 * scale
    table = [
        wrapped(f"static const ng_real {name}[{len(rows)}][{rows.shape[1]}] = {braces(rows)};")
        for name, rows in (("states", states), ("expected", expected))
    ]
    arrays = ", ".join(f"{name}[{size}]" for name, size in outputs)
    text = "\n".join(
        [
            "/* States and what Python makes of them. Written by neuralgaits. */",
            f'#include "{header.file}.h"',
            "",
            *table,
            "",
            "#ifdef NG_FLOAT",
            f"#define LARGEST NG({in_float!r})",
            "#else",
            f"#define LARGEST NG({in_double!r})",
            "#endif",
            "",
            f"int {selftest_name(header)}(void) {{",
            f"  for (int line = 0; line < {len(states)}; ++line) {{",
            f"    ng_real {arrays};",
            f"    {header.function}(states[line], {', '.join(name for name, _ in outputs)});",
            f"    for (int i = 0; i < {expected.shape[1]}; ++i)",
            f"      if (!(ng_abs({compared}[i] - expected[line][i]) <= LARGEST)) return line + 1;",
            "  }",
            "  return 0;",
            "}",
            "",
        ]
    )
    return {f"{header.file}_selftest.c": text}
