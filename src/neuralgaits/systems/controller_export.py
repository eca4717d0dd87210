"""A family's controller in C99: one function of the measured state, without a heap."""

import ctypes
import math
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from neuralgaits._compiler import Compiler, SharedLibrary
from neuralgaits._printable import printable
from neuralgaits.errors import MismatchError
from neuralgaits.export.output_folder import publish, refuse_used, shipped
from neuralgaits.programs import POINT, evaluate
from neuralgaits.programs.c99.constant_arrays import Tables
from neuralgaits.programs.c99.function import emit
from neuralgaits.programs.program import Program
from neuralgaits.programs.tracing.tracer import trace
from neuralgaits.records.record import Count, Record, Texts
from neuralgaits.systems.controller_header import ControllerHeader
from neuralgaits.systems.controller_selftest import TESTED, selftest_file, selftest_name
from neuralgaits.systems.family_run import FamilyRun
from neuralgaits.systems.proved_system import ExportedSystem
from neuralgaits.systems.run_statements import stated_bounds

STATES = 1000
"""States of the set at which C and Python are compared."""


@dataclass(frozen=True, eq=False, kw_only=True)
class FamilyExport(Record):
    """Result of `export`.

    Attributes:
        run, robot: path of the run, and name of its robot.
        files: what was written.
        checked: whether a C compiler was there, so that C could be compared with Python.
        states: how many states were compared.
        max_abs_error: largest difference of `ControllerHeader.output`; None if not compared.
    """

    run: str
    robot: str
    files: Texts
    checked: bool
    states: Count
    max_abs_error: float | None


def export_family(
    system: ExportedSystem, run: FamilyRun, out: Path, *, force: bool = False
) -> FamilyExport:
    """Write the controller as C, and compare it with Python if there is a compiler.

    Args:
        system: system of the run's family.
        run: the run.
        out: folder of the files.
        force: whether files there are replaced.

    Raises: InputError if the folder cannot be used; MismatchError if C differs from Python.
    """
    refuse_used(out, force=force)
    header, states = system.header(run), system.states(run, STATES, seed=1)
    program = controller_program(system, run)
    expected = {
        name: value.reshape(len(states), -1)
        for name, value in evaluate(program, {"state": states}, POINT).items()
    }
    files = c_files(run, program, header)
    files |= selftest_file(header, program, states[:TESTED], expected[header.output][:TESTED])
    error = _largest_difference(program, states, expected, files, header)
    written = publish(out, files)
    return FamilyExport(
        run=str(run.path),
        robot=run.config.robot,
        files=tuple(written),
        checked=error is not None,
        states=0 if error is None else STATES,
        max_abs_error=error,
    )


def controller_program(system: ExportedSystem, run: FamilyRun) -> Program:
    """Return the outputs of the exported controller as a Program of the state."""
    inputs = {"state": (system.state_size_of(run.config),)}
    return trace(system.law(run), inputs, parameters=run.controller)


def c_files(run: FamilyRun, program: Program, header: ControllerHeader) -> dict[str, str]:
    """Return the text of header file, source file and `ng_math.h`."""
    tables = Tables("ng")
    function = emit(program, header.function, header.about, tables)
    title = printable(header.title).replace("*/", "* /").replace("/*", "/ *")
    guard = f"NG_{header.file.upper()}_H"
    text = "\n".join(
        [
            f"/* Controller of {title}. Written by neuralgaits.",
            f" * {header.advice}.",
            f" * {header.about}.",
            f" * {_proof_in_words(run, header)} */",
            f"#ifndef {guard}",
            f"#define {guard}",
            '#include "ng_math.h"',
            *(
                f"#define NG_{name} {value!r} /* {about} */"
                for name, (value, about) in header.constants.items()
            ),
            f"{function.prototype};",
            f"/* Returns: 0, or the line of {header.file}_selftest.c that C computes otherwise. */",
            f"int {selftest_name(header)}(void);",
            "#endif",
            "",
        ]
    )
    code = [f'#include "{header.file}.h"', *tables.texts.values(), function.body]
    return {
        f"{header.file}.h": text,
        f"{header.file}.c": "\n\n".join(code) + "\n",
        **header.more,
        "ng_math.h": shipped()["ng_math.h"],
    }


def _proof_in_words(run: FamilyRun, header: ControllerHeader) -> str:
    """Return what the run's proof file states, which nobody has checked here."""
    system, bounds = run.system, stated_bounds(run) or {}
    levels = system.conclude(bounds, run.config, system.highest)
    proved = [one.level for one in levels if one.proved]
    if not proved:
        return "Nothing is proved of the set"
    return (
        f"The proof file of this run states level {max(proved)} of {header.proved}. Verify it\n"
        " * with check-proof or build/proofcheck"
    )


def _largest_difference(
    program: Program,
    states: np.ndarray,
    expected: dict[str, np.ndarray],
    files: dict[str, str],
    header: ControllerHeader,
) -> float | None:
    """Compile the files and compare all outputs.

    Returns: the largest difference of the header's output; None without a compiler.
    Raises: MismatchError.
    """
    compiler = Compiler.for_c()
    if compiler is None:
        return None
    sources = tuple(sorted(name for name in files if name.endswith(".c")))
    flags = ("-std=c99", "-O2", "-Wall", "-Wextra", "-Werror", "-pedantic", "-fPIC", "-shared")
    library = SharedLibrary(header.file, files, sources, flags)
    with tempfile.TemporaryDirectory(prefix="neuralgaits-") as folder:
        compiled = ctypes.CDLL(str(compiler.compile(library, Path(folder))))
        function = getattr(compiled, header.function)
        answers = [_called(function, program, state) for state in states]
        wrong = getattr(compiled, selftest_name(header))()
    # Largest difference that is rounding, as a share of the largest value or of the limit.
    rounding = 1e-9
    errors = {}
    for name, values in expected.items():
        errors[name] = float(np.abs(np.array([one[name] for one in answers]) - values).max())
        limit = header.limit if name == header.output else 0.0
        if not errors[name] <= rounding * max(limit, float(np.abs(values).max())):
            raise MismatchError(
                f"expected {name} of Python from C, found a difference of {errors[name]:.3g}: "
                "report it"
            )
    if wrong:
        raise MismatchError(
            f"expected the table of {header.file}_selftest.c from C, found another line {wrong}: "
            "report it"
        )
    return errors[header.output]


def _called(function: Any, program: Program, state: np.ndarray) -> dict[str, list[float]]:
    """Call the C function at one state. Returns: its outputs by name."""
    doubles = ctypes.c_double * len(state)
    answers = {
        output.name: (ctypes.c_double * math.prod(output.shape))() for output in program.outputs
    }
    function.restype = None
    function(doubles(*state), *answers.values())
    return {name: list(answer) for name, answer in answers.items()}
