"""Compile the controller and inspect the result."""

import re
import subprocess
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from neuralgaits._compiler import Compiler, CompilerError, run_tool
from neuralgaits.errors import MismatchError

COMPILERS = ("gcc", "clang")
STRICT = ("-Wall", "-Wextra", "-Werror", "-std=c99", "-pedantic")
PLAIN = ("-O2",)
NATIVE = ("-O3", "-march=native", "-ffp-contract=fast")
"""Flags that fuse products and sums where the machine can; gcc does not do so for standard C."""
PRECISIONS = {"double": (), "float": ("-DNG_FLOAT",)}
CORE = ("gait.c", "controller.c", "estimator.c")
"""Files that run on the robot, without the self-test."""
CHECKED = (*CORE, "supervisor.c", "selftest.c", "check.c")


@dataclass(frozen=True)
class Inspection:
    """Contents of the compiled files.

    Attributes:
        flash_bytes: code and constants.
        static_bytes: memory that outlives a call; must be 0.
        foreign: functions called that are neither ours nor freestanding; must be empty.
        stack_bytes: stack of the deepest chain of calls; None where the compiler does not report
            it.
    """

    flash_bytes: int
    static_bytes: int
    foreign: tuple[str, ...]
    stack_bytes: int | None


def compilers() -> list[str]:
    """Return those of COMPILERS that this machine has."""
    return [name for name in COMPILERS if Compiler((name,)).path]


def build(
    compiler: str, folder: Path, name: str, sources: tuple[str, ...], flags: tuple[str, ...]
) -> Path:
    """Compile the sources of a folder into a program. Returns: its path.

    Raises: MismatchError with the compiler's first complaint.
    """
    program = folder / name
    files = [str(folder / source) for source in sources]
    _run([compiler, *STRICT, *flags, *files, "-I", str(folder), "-o", str(program)])
    return program


def inspect(
    compiler: str, folder: Path, flags: tuple[str, ...], sources: tuple[str, ...] = CORE
) -> Inspection:
    """Compile the files that run on the robot alone and inspect their objects.

    Raises: MismatchError if it does not compile.
    """
    deep = ("-fcallgraph-info=su",) if compiler == "gcc" else ()
    flash = static = 0
    undefined, defined = set(), set()
    for source in sources:
        target = folder / f"{Path(source).stem}.o"
        # Without -fno-pie, constants that hold addresses count as memory that is written.
        options = [*STRICT, *flags, *deep, "-fno-pie", "-c"]
        _run([compiler, *options, str(folder / source), "-o", str(target)])
        text, data, bss = (int(word) for word in _run(["size", str(target)]).split()[6:9])
        flash, static = flash + text, static + data + bss
        for line in _run(["nm", str(target)]).splitlines():
            *_, kind, symbol = line.split()
            (undefined if kind == "U" else defined).add(symbol)
    graphs = [(folder / f"{Path(source).stem}.ci") for source in sources]
    complete = all(graph.is_file() for graph in graphs)
    stack = (
        deepest("\n".join(graph.read_text(encoding="utf-8", errors="replace") for graph in graphs))
        if complete
        else None
    )
    # Functions that a C compiler may call by itself, even without a library.
    freestanding = frozenset(("memcpy", "memset", "memmove"))
    foreign = undefined - defined - freestanding
    return Inspection(flash, static, tuple(sorted(foreign)), stack)


def deepest(graph: str) -> int:
    """Return the stack of the deepest chain of calls (bytes), from files of -fcallgraph-info=su."""
    own: dict[str, int] = {}
    for title, label in re.findall(r'node: \{ title: "([^"]+)" label: "([^"]*)"', graph):
        size = re.search(r"(\d+) bytes", label)
        own[title] = max(own.get(title, 0), int(size.group(1)) if size else 0)
    calls: dict[str, set[str]] = {}
    for source, target in re.findall(r'sourcename: "([^"]+)" targetname: "([^"]+)"', graph):
        calls.setdefault(source, set()).add(target)
    depths: dict[str, int] = {}

    def total(name: str) -> int:
        if name not in depths:
            depths[name] = own.get(name, 0) + max(map(total, calls.get(name, ())), default=0)
        return depths[name]

    return max((total(name) for name in own), default=0)


def run(program: Path, *arguments: str) -> bytes:
    """Run a compiled program and return its output. Raises: MismatchError if it fails."""
    process = subprocess.run(
        [str(program), *arguments], capture_output=True, timeout=300.0, check=False
    )
    if process.returncode != 0:
        lines = (process.stderr or process.stdout).decode(errors="replace").strip().splitlines()
        raise MismatchError(
            f"{program.name} {arguments[0]}: expected exit 0, found {process.returncode}"
            f" ({lines[-1][:200] if lines else 'silent'}): do not use this controller, report it"
        )
    return process.stdout


def _run(command: Sequence[str]) -> str:
    """Run a compiler, or a tool that reads what it made. Raises: MismatchError if it fails."""
    try:
        return run_tool(command)
    except CompilerError as error:
        raise MismatchError(
            f"{command[0]}: expected C that compiles without warnings, found "
            f"{error.complaint[:300]}: report it"
        ) from None
