"""The controller in C99: one function from the measured state to the force, without a heap."""

import ctypes
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from neuralgaits._compiler import Compiler, SharedLibrary
from neuralgaits._printable import printable
from neuralgaits._types import Array, Float
from neuralgaits.errors import MismatchError
from neuralgaits.export.output_folder import publish, refuse_used, shipped
from neuralgaits.programs import POINT, evaluate
from neuralgaits.programs.c99.constant_arrays import Tables
from neuralgaits.programs.c99.function import emit
from neuralgaits.programs.program import Program
from neuralgaits.programs.tracing.tracer import trace
from neuralgaits.records.record import Count, Record, Texts
from neuralgaits.systems.cartpole.cartpole_certify import trace_conditions
from neuralgaits.systems.cartpole.cartpole_run import CartPoleRun
from neuralgaits.systems.cartpole.cartpole_simulate import law_of, starts
from neuralgaits.systems.cartpole.cartpole_theorem import conclude
from neuralgaits.systems.cartpole.stated import stated_bounds

STATES = 1000
"""States on the set's face at which C and Python are compared."""
AGREES = 1e-9
"""Largest difference that is rounding, as a share of the force limit."""
ABOUT = (
    "The force on the cart at a measured state (x, theta, x', theta') in m, rad, m/s, rad/s: x\n"
    " * from the middle of the rail, theta from the upright, positive where the pole leans to +x.\n"
    " * barrier is 1 - r^2, not negative in the set"
)


@dataclass(frozen=True, eq=False, kw_only=True)
class CartPoleExport(Record):
    """Result of `export`.

    Attributes:
        run, robot: of the run.
        files: what was written.
        checked: whether a C compiler was there, so that C could be compared with Python.
        states: how many states were compared.
        max_abs_error: largest difference of the force [N]; None if it was not compared.
    """

    run: str
    robot: str
    files: Texts
    checked: bool
    states: Count
    max_abs_error: float | None


def export_cartpole(run: CartPoleRun, out: Path, *, force: bool = False) -> CartPoleExport:
    """Write the controller as C, and compare it with Python if there is a compiler.

    Raises: InputError if the folder cannot be used; MismatchError if C differs from Python.
    """
    refuse_used(out, force=force)
    program = controller_program(run)
    files = c_files(run, program)
    error = _largest_difference(run, program, files)
    written = publish(out, files)
    return CartPoleExport(
        run=str(run.path),
        robot=run.config.robot,
        files=tuple(written),
        checked=error is not None,
        states=0 if error is None else STATES,
        max_abs_error=error,
    )


def controller_program(run: CartPoleRun) -> Program:
    """Return force and barrier as a Program of the state (x, theta, x', theta')."""
    law = law_of(run)

    def outputs(state: Float[Array, "4"]) -> dict[str, Array]:
        force, radius_squared = law(state)
        return {"force": force, "barrier": 1.0 - radius_squared}

    return trace(outputs, {"state": (4,)}, parameters=run.controller)


def c_files(run: CartPoleRun, program: Program) -> dict[str, str]:
    """Return the text of `cartpole.h`, `cartpole.c` and `ng_math.h`."""
    tables = Tables("ng")
    function = emit(program, "ng_cartpole_force", ABOUT, tables)
    name = printable(run.config.robot).replace("*/", "* /").replace("/*", "/ *")
    header = "\n".join(
        [
            f"/* Controller of the cart-pole {name}. Written by neuralgaits.",
            " * Clamp the force at NG_FORCE_LIMIT.",
            f" * {ABOUT}.",
            f" * {_proof_in_words(run)} */",
            "#ifndef NG_CARTPOLE_H",
            "#define NG_CARTPOLE_H",
            '#include "ng_math.h"',
            f"#define NG_FORCE_LIMIT {run.robot.force_limit!r} /* N */",
            f"#define NG_RAIL {run.robot.rail!r} /* m, from the middle of the rail to its end */",
            f"{function.prototype};",
            "#endif",
            "",
        ]
    )
    code = ['#include "cartpole.h"', *tables.texts.values(), function.body]
    return {
        "cartpole.h": header,
        "cartpole.c": "\n\n".join(code) + "\n",
        "ng_math.h": shipped()["ng_math.h"],
    }


def _proof_in_words(run: CartPoleRun) -> str:
    """Return what the run's proof file states, which nobody has checked here."""
    bounds = stated_bounds(run, trace_conditions(run))
    proved = [one.level for one in conclude(bounds or {}, run.config.rate) if one.proved]
    if not proved:
        return "Nothing is proved of the set"
    return (
        f"The proof file of this run states level {max(proved)} of states in the set, in\n"
        " * continuous time and exact arithmetic: there the force is within the limit. Verify it\n"
        " * with check-proof or build/proofcheck"
    )


def _largest_difference(run: CartPoleRun, program: Program, files: dict[str, str]) -> float | None:
    """Compile the files and return the largest difference of the force [N]; None if none can.

    Raises: MismatchError.
    """
    compiler = Compiler.for_c()
    if compiler is None:
        return None
    flags = ("-std=c99", "-O2", "-Wall", "-Wextra", "-Werror", "-pedantic", "-fPIC", "-shared")
    library = SharedLibrary("cartpole", files, ("cartpole.c",), flags)
    states = starts(run, STATES, seed=1)
    expected = evaluate(program, {"state": states}, POINT)["force"].reshape(-1)
    with tempfile.TemporaryDirectory(prefix="neuralgaits-") as folder:
        function = ctypes.CDLL(str(compiler.compile(library, Path(folder)))).ng_cartpole_force
        found = [_called(function, program, state)["force"] for state in states]
    error = float(np.abs(np.array(found) - expected).max())
    # Rounding grows with the largest of the forces, limits aside.
    if not error <= AGREES * max(run.robot.force_limit, float(np.abs(expected).max())):
        raise MismatchError(
            f"expected the forces of Python from C, found a difference of {error:.3g} N: report it"
        )
    return error


def _called(function: Any, program: Program, state: np.ndarray) -> dict[str, float]:
    """Call the C function at one state. Returns: its outputs by name."""
    doubles = ctypes.c_double * 4
    answers = {output.name: ctypes.c_double() for output in program.outputs}
    function.restype = None
    function(doubles(*state), *(ctypes.byref(answer) for answer in answers.values()))
    return {name: answer.value for name, answer in answers.items()}
