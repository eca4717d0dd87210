"""C and C++ compilers: find one, run it, and keep the libraries that it makes."""

import ctypes
import hashlib
import importlib.util
import os
import platform
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path

COMPILE_S = 300.0
_SHOWN = 200


class CompilerError(Exception):
    """Raised when a compiler does not do its work; the message can follow the word because.

    Attributes:
        complaint: the compiler's first line on an error.
    """

    def __init__(self, message: str, complaint: str):
        super().__init__(message)
        self.complaint = complaint


@dataclass(frozen=True)
class SharedLibrary:
    """A shared library that can be compiled.

    Attributes:
        name: first part of its file's name in the cache.
        files: text of every file that is needed, by name.
        sources: names of the files that are compiled; the others are headers.
        flags: the compiler's flags.
        headers: folders of headers that are not among the files.
        links: libraries to link, such as `-lm`.
        depends_on: whatever else the result depends on, such as the version of the headers.
    """

    name: str
    files: Mapping[str, str]
    sources: tuple[str, ...]
    flags: tuple[str, ...]
    headers: tuple[Path, ...] = ()
    links: tuple[str, ...] = ()
    depends_on: tuple[str, ...] = ()


@dataclass(frozen=True)
class Compiler:
    """A compiler of this machine.

    Attributes:
        command: the words that a command line begins with.
    """

    command: tuple[str, ...]

    @classmethod
    def first_of(cls, names: Sequence[str]) -> "Compiler | None":
        """Return the first of some compilers that this machine has; None without any."""
        return next((cls((name,)) for name in names if shutil.which(name)), None)

    @classmethod
    def for_c(cls) -> "Compiler | None":
        """Return a C compiler: that of CC, the machine's own, or that of the extra `compiler`."""
        words = os.environ.get("CC", "").split()
        if words:
            return cls(tuple(words))
        if compiler := cls.first_of(("cc", "gcc", "clang")):
            return compiler
        if importlib.util.find_spec("ziglang") is not None:
            return cls((sys.executable, "-m", "ziglang", "cc"))
        return None

    @property
    def path(self) -> str | None:
        """Return the path of the program; None if there is no such program."""
        return shutil.which(self.command[0])

    def run(self, arguments: Sequence[str]) -> None:
        """Run the compiler. Raises: CompilerError if it does not run, is too slow or fails."""
        run_tool([*self.command, *arguments])

    def version(self) -> str:
        """Return the compiler's text on its version; empty if it does not run."""
        return _version(self.command)

    def compile(self, library: SharedLibrary, folder: Path) -> Path:
        """Compile a library in a folder of its own, to which its files are written.

        Returns: path of the library.
        Raises: CompilerError, or OSError if the folder cannot be written.
        """
        for name, text in library.files.items():
            (folder / name).write_text(text, encoding="utf-8")
        file = folder / f"{library.name}.so"
        sources = [str(folder / name) for name in library.sources]
        headers = [word for place in library.headers for word in ("-isystem", str(place))]
        own = ["-I", str(folder), *headers]
        self.run([*library.flags, *sources, *own, "-o", str(file), *library.links])
        if not file.is_file():
            raise _failed(self.command[0], "it makes no file")
        return file

    def cached(self, library: SharedLibrary, folder: Path) -> Path:
        """Return the path of a library in a folder of the cache, compiled now or before.

        Its name ends in the hash of its content: a damaged file, which can end the process that
        loads it, is made anew, as is one that does not load. Processes may ask for the same library
        at the same time: each file is moved to its place when it is whole.

        Raises: CompilerError, or OSError if the folder cannot be written.
        """
        stem = f"{library.name}-{self._hash(library)}"
        for file in sorted(folder.glob(f"{stem}-*.so")):
            if file.stem == f"{stem}-{_hash_of(file)}" and _loads(file):
                return file
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(prefix="compiling-", dir=folder) as own:
            file = self.compile(library, Path(own))
            return file.replace(folder / f"{stem}-{_hash_of(file)}.so")

    def _hash(self, library: SharedLibrary) -> str:
        """Return the hash of all that a library depends on."""
        key = hashlib.sha256()
        made_by = (*self.command, self.path or "", self.version(), platform.machine())
        inputs = (*library.flags, *library.sources, *library.links, *library.depends_on)
        files = [word for item in sorted(library.files.items()) for word in item]
        for text in (*made_by, *inputs, *files):
            # With its length before it, no text can be taken for parts of two.
            key.update(f"{len(text)}:{text}".encode())
        return key.hexdigest()[:32]


def run_tool(command: Sequence[str]) -> str:
    """Run a compiler or a tool beside it. Returns: what it prints.

    Raises: CompilerError if it does not run, takes longer than COMPILE_S, or fails.
    """
    try:
        process = _output(command, COMPILE_S)
    except (OSError, subprocess.TimeoutExpired) as error:
        raise CompilerError(f"{command[0]} does not run ({error})"[:_SHOWN], str(error)) from None
    if process.returncode != 0:
        lines = process.stderr.splitlines()
        errors = [line for line in lines if "error" in line]
        first = (errors or lines or [f"exit {process.returncode}"])[0]
        raise _failed(command[0], " ".join(first.split()))
    return process.stdout


def _failed(program: str, complaint: str) -> CompilerError:
    return CompilerError(f"{program} fails ({complaint[:_SHOWN]})", complaint)


def _output(command: Sequence[str], limit_s: float) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        command,
        capture_output=True,
        encoding="utf-8",
        errors="replace",
        timeout=limit_s,
        check=False,
    )


def _hash_of(file: Path) -> str | None:
    """Return the hash of a file's content; None if it cannot be read."""
    try:
        return hashlib.sha256(file.read_bytes()).hexdigest()[:32]
    except OSError:
        return None


def _loads(library: Path) -> bool:
    """Return whether a library can be loaded."""
    try:
        ctypes.CDLL(str(library))
    except OSError:
        return False
    return True


@cache
def _version(command: tuple[str, ...]) -> str:
    try:
        return _output([*command, "--version"], limit_s=60.0).stdout
    except (OSError, subprocess.TimeoutExpired):
        return ""
