"""Entry of the command line: one verb, one result, one exit code.

Exit codes: 0 done and good; 1 the answer is no; 2 bad usage or bad input; 3 undecided or out
of budget; 70 an internal error; 130 interrupted. Every error is one line on stderr; `inspect`
writes one for each problem of a robot file.
"""

import contextlib
import faulthandler
import io
import os
import re
import sys
import threading
import traceback
from collections.abc import Iterator
from pathlib import Path
from typing import NoReturn

from neuralgaits._environment import (
    PAGE_THREADS,
    prepare,
    refuse_settings_without_end,
    variables_of_jax,
    why_jax_failed,
)
from neuralgaits._printable import PRINTABLE, printable, shortened, visible
from neuralgaits.errors import (
    ConvergenceError,
    Interrupted,
    ManyProblems,
    MismatchError,
    NeuralGaitsError,
    NonFiniteError,
    is_full,
    reason,
)

GOOD, NO, BAD_INPUT, UNDECIDED, DEFECT, INTERRUPTED = 0, 1, 2, 3, 70, 130


class ProgressStream(io.TextIOWrapper):
    """Standard error whose reader may leave, as of `2>&1 | head`: the work goes on without it."""

    def write(self, text: str) -> int:
        """Write a text, to nowhere once nobody reads. Returns: its length."""
        try:
            return super().write(text)
        except BrokenPipeError:
            to_nowhere(self.fileno())
            return len(text)

    def flush(self) -> None:
        """Write what is kept back, as `write` does."""
        try:
            super().flush()
        except BrokenPipeError:
            to_nowhere(self.fileno())


def to_nowhere(stream: int) -> None:
    """Let a stream that nobody reads end in the null device."""
    null = os.open(os.devnull, os.O_WRONLY)
    os.dup2(null, stream)
    os.close(null)


def run() -> None:
    """Run the command line; entry point of the console script `neuralgaits VERB ...`."""
    prepare()
    for stream in ("stdout", "stderr"):
        if getattr(sys, stream) is None:  # Closed by the caller, as by 2>&-.
            setattr(sys, stream, open(os.devnull, "w"))
        # A name, or a sign, that the terminal's encoding does not have is no reason to stop.
        getattr(sys, stream).reconfigure(errors=PRINTABLE)
    if isinstance(sys.stderr, io.TextIOWrapper):
        encoding, buffer = sys.stderr.encoding, sys.stderr.detach()
        sys.stderr = ProgressStream(buffer, encoding, PRINTABLE, line_buffering=True)
    # Compiled code runs in this process: if it crashes, its place is said.
    with contextlib.suppress(RuntimeError, ValueError, OSError):
        faulthandler.enable()
    _leave(main(sys.argv[1:]))


def _leave(code: int) -> NoReturn:
    """End the process, at once if a page's thread may be in compiled code: Python would abort."""
    if any(one.daemon and one.name in PAGE_THREADS for one in threading.enumerate()):
        with contextlib.suppress(OSError, ValueError):
            sys.stdout.flush()
            sys.stderr.flush()
        os._exit(code)
    sys.exit(code)


def main(arguments: list[str]) -> int:
    """Carry out one command. Returns: its exit code."""
    verbose = bool({"-v", "--verbose"} & set(arguments))
    try:
        return _answer(arguments)
    except KeyboardInterrupt as error:
        return _fail(f"interrupted{_next(arguments, error)}", error, INTERRUPTED, verbose)
    except BrokenPipeError as error:
        to_nowhere(sys.stdout.fileno())
        if not arguments or {"-h", "--help"} & set(arguments):
            return GOOD
        # Before the answer: that is printed when the work is done, see `_printed`.
        return _fail("nobody reads what this command prints", error, INTERRUPTED, verbose)
    except (NonFiniteError, MismatchError, ConvergenceError) as error:
        return _fail(str(error), error, NO, verbose)
    except NeuralGaitsError as error:
        return _fail(str(error), error, BAD_INPUT, verbose)
    except OSError as error:
        return _fail(shortened(_of_system(error)), error, BAD_INPUT, verbose)
    except BaseException as error:
        # Before SystemExit: a user's file that calls `sys.exit` is no answer to the command.
        if (mistake := _of_user(error)) is not None:
            return _fail(shortened(str(mistake)), error, BAD_INPUT, verbose)
        if isinstance(error, SystemExit):
            return GOOD if error.code is None else int(error.code)
        if (setting := _of_surroundings(error)) is not None:
            return _fail(shortened(setting), error, BAD_INPUT, verbose)
        # The last resort, so that a script never takes a defect for the answer "no".
        what = shortened(f"defect in this program: {type(error).__name__}: {error}")
        return _fail(f"{what}; please report it with what -v prints", error, DEFECT, verbose)


def _answer(arguments: list[str]) -> int:
    # The parser, the workflows and JAX are imported when they are needed: --help is quick.
    from neuralgaits.cli.argv_parser import read
    from neuralgaits.cli.usage import one_line_errors

    verb = one_line_errors(read, arguments)
    refuse_settings_without_end()
    from neuralgaits.cli import verbs

    if not verb.output.json:
        outcome = verbs.carry_out(verb)
        with _printed():
            outcome.show(verbose=verb.output.verbose)
    else:
        with _stdout_to_stderr():
            outcome = verbs.carry_out(verb)
        from neuralgaits.runs.plain import to_json

        unicode = (sys.stdout.encoding or "utf-8").lower().startswith("utf")
        with _printed():
            sys.stdout.write(to_json(outcome.result, ascii_only=not unicode))
    if outcome.then is not None:
        outcome.then()
    if outcome.undecided:
        return UNDECIDED
    return GOOD if outcome.good else NO


@contextlib.contextmanager
def _printed() -> Iterator[None]:
    """Print an answer, or what its reader waits for: the exit code is that of the work."""
    try:
        yield
        sys.stdout.flush()
    except (BrokenPipeError, SystemExit):  # Rich ends the process where a pipe is broken.
        to_nowhere(sys.stdout.fileno())


def _of_system(error: OSError) -> str:
    """Describe in one line what the system refused, and where a path is wrong."""
    if is_full(error):
        where = f" at {error.filename}" if isinstance(error.filename, str) else ""
        return (
            f"expected room to write{where}, found none ({reason(error)}): free some, then give "
            "the command again; what takes --resume goes on from what is there"
        )
    if not isinstance(error.filename, str):
        return str(error)
    path = Path(error.filename)
    if isinstance(error, NotADirectoryError | FileExistsError):
        file = next((place for place in (*reversed(path.parents), path) if place.is_file()), path)
        return f"expected a folder at {file}, found a file: move it away, or name another place"
    return (
        f"expected a file or folder that can be used at {path}: {reason(error)}; mend that, or "
        "name another"
    )


def _of_user(error: BaseException) -> Exception | None:
    """Return the error of a user's spec file, whenever it ran; None if it comes from elsewhere."""
    # Not imported here: without it no such file was read, and the import may be what failed.
    spec_file_errors = sys.modules.get("neuralgaits.barriers.spec_file_errors")
    return None if spec_file_errors is None else spec_file_errors.mistake(error)


def _of_surroundings(error: BaseException) -> str | None:
    """Explain an error by a setting of the user's for a library; None if there is no such one.

    Such are MUJOCO_GL, a `matplotlibrc` that Matplotlib cannot read, and variables of JAX.
    """
    backend = os.environ.get("MUJOCO_GL")
    frames = traceback.walk_tb(error.__traceback__)
    names = [str(frame.f_globals.get("__name__")) for frame, _ in frames]
    if backend is not None and any(re.fullmatch(r"mujoco\..*gl_context", name) for name in names):
        return (
            f"expected MUJOCO_GL to name a way to render that is there, found {backend!r}: unset "
            "it, or see `neuralgaits doctor`"
        )
    if isinstance(error, UnicodeDecodeError) and "matplotlib" in names:
        return (
            "expected text in UTF-8 in matplotlibrc, found other bytes: mend or remove that of "
            "this folder, or your own"
        )
    # Read at the import of JAX and the libraries beside it, each in its own module for that.
    if names and re.fullmatch(r"(jax\._src|equinox|jaxtyping)\._?config", names[-1]):
        settings = variables_of_jax()
        if settings:
            return (
                f"expected values that JAX takes, found {', '.join(settings)}: unset what is wrong"
            )
    return why_jax_failed(error)


def _next(arguments: list[str], error: KeyboardInterrupt) -> str:
    """Return the command to type after Ctrl-C; only what was saved can be resumed."""
    if isinstance(error, Interrupted):
        return f"; go on with `{error.command}`{error.more}"
    resumable = ("train", "refine", "episodes", "certify", "sweep")
    if not any(verb in arguments[:2] for verb in resumable):
        return ""
    from neuralgaits.runs.shell_words import command

    again = f"`{command(*arguments)}`"
    if any(word.partition("=")[0] == "--resume" for word in arguments):
        return f"; go on with {again}"
    return f"; nothing is kept yet, begin again with {again}"


@contextlib.contextmanager
def _stdout_to_stderr() -> Iterator[None]:
    """Keep stdout for the answer: all other output, of C libraries, too, goes to stderr."""
    sys.stdout.flush()
    stdout = os.dup(1)
    os.dup2(2, 1)
    try:
        with contextlib.redirect_stdout(sys.stderr):
            yield
    finally:
        os.dup2(stdout, 1)
        os.close(stdout)


def _fail(message: str, error: BaseException, code: int, verbose: bool) -> int:
    messages = [message]
    if isinstance(error, ManyProblems):
        messages = [shortened(problem) for problem in error.problems]
    # Lines of one message are joined; blanks within one may be those of a quoted path.
    lines = [" ".join(p.strip() for p in one.splitlines() if p.strip()) for one in messages]
    from neuralgaits.cli.invocation import as_called

    # An error that cannot be written, to a full disk or to nobody, still has its exit code.
    with contextlib.suppress(OSError, ValueError):
        if verbose:
            traceback.print_exception(error, file=sys.stderr)
        for line in lines:
            print(f"neuralgaits: {visible(printable(as_called(line)))}", file=sys.stderr)
    return code
