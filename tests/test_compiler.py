"""Compilers are found and run, and a library is compiled once for all that it depends on."""

import ctypes
import sys
from dataclasses import replace

import pytest

from neuralgaits import _compiler
from neuralgaits._compiler import Compiler, CompilerError, SharedLibrary, run_tool

TWICE = SharedLibrary(
    "twice",
    {"twice.c": '#include "factor.h"\nint twice(int x) { return FACTOR * x; }\n'},
    ("twice.c",),
    ("-std=c99", "-fPIC", "-shared"),
)
HEADER = {"factor.h": "#define FACTOR 2\n"}


@pytest.fixture
def compiler():
    found = Compiler.for_c()
    if found is None:
        pytest.skip("no C compiler")
    return found


@pytest.fixture
def made_once(compiler, twice, tmp_path_factory):
    """Name and content of the library, which this process has not loaded from its place."""
    path = compiler.cached(twice, tmp_path_factory.mktemp("made"))
    return path.name, path.read_bytes()


@pytest.fixture
def twice():
    return replace(TWICE, files={**TWICE.files, **HEADER})


def test_the_compiler_of_the_user_comes_before_that_of_the_machine(monkeypatch):
    monkeypatch.setenv("CC", "ccache gcc-of-mine -m64")
    assert Compiler.for_c() == Compiler(("ccache", "gcc-of-mine", "-m64"))
    monkeypatch.setenv("CC", "")
    monkeypatch.setattr(_compiler.shutil, "which", {"gcc": "/bin/gcc", "clang": "/bin/clang"}.get)
    assert Compiler.for_c() == Compiler(("gcc",))
    assert Compiler.first_of(("clang", "gcc")) == Compiler(("clang",))
    assert Compiler.first_of(("tcc",)) is None


@pytest.mark.parametrize("there", [True, False])
def test_without_one_the_extra_is_taken_if_it_is_there(monkeypatch, there):
    monkeypatch.setenv("CC", "")
    monkeypatch.setenv("PATH", "")
    monkeypatch.setattr(_compiler.importlib.util, "find_spec", lambda name: there or None)
    expected = Compiler((sys.executable, "-m", "ziglang", "cc")) if there else None
    assert Compiler.for_c() == expected


def test_a_library_is_compiled_once(compiler, twice, tmp_path):
    path = compiler.cached(twice, tmp_path / "new")
    made = path.stat().st_mtime_ns
    assert ctypes.CDLL(str(path)).twice(21) == 42
    assert compiler.cached(twice, tmp_path / "new") == path
    assert path.stat().st_mtime_ns == made
    assert list(path.parent.iterdir()) == [path]


DAMAGES = {
    "no library": lambda content: b"no library",
    # The system still maps this one, and ends the process that reads a page of the missing half.
    "cut off": lambda content: content[: len(content) // 2],
    "one byte": lambda content: content[:-1] + bytes([content[-1] ^ 1]),
}


@pytest.mark.parametrize("damage", DAMAGES)
def test_a_damaged_library_is_compiled_again(
    compiler, twice, tmp_path, monkeypatch, damage, made_once
):
    [name, content] = made_once
    path = tmp_path / name
    path.write_bytes(DAMAGES[damage](content))
    loaded = []
    monkeypatch.setattr(_compiler, "_loads", loaded.append)
    found = compiler.cached(twice, tmp_path)
    # It was not even loaded.
    assert not loaded and ctypes.CDLL(str(found)).twice(4) == 8


def test_a_library_that_does_not_load_is_compiled_again(compiler, twice, tmp_path, monkeypatch):
    path = compiler.cached(twice, tmp_path)
    made = path.stat().st_ino
    monkeypatch.setattr(_compiler, "_loads", lambda library: False)
    compiler.cached(twice, tmp_path)
    assert path.stat().st_ino != made


@pytest.mark.parametrize(
    "change",
    [
        {"files": {**TWICE.files, "factor.h": "#define FACTOR 3\n"}},
        {"flags": (*TWICE.flags, "-DNAME")},
        {"links": ("-lm",)},
        {"depends_on": ("version 2",)},
    ],
)
def test_whatever_a_library_depends_on_is_in_its_name(compiler, twice, tmp_path, change):
    paths = {compiler.cached(one, tmp_path) for one in (twice, replace(twice, **change))}
    assert len(paths) == 2


def test_a_compilation_that_fails_leaves_no_file_and_says_why(compiler, tmp_path):
    with pytest.raises(CompilerError, match=r"fails \(.*factor.h") as found:
        compiler.cached(TWICE, tmp_path)
    assert "error" in found.value.complaint and "\n" not in str(found.value)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("command", "why"),
    [
        ("no-such-compiler", "no-such-compiler does not run"),
        ("true", r"true fails \(it makes no file\)"),
        ("false", r"false fails \(exit 1\)"),
    ],
)
def test_a_compiler_that_does_not_work_says_so(twice, tmp_path, command, why):
    broken = Compiler((command,))
    with pytest.raises(CompilerError, match=why):
        broken.compile(twice, tmp_path)


def test_a_compiler_that_does_not_exist_has_neither_path_nor_version():
    missing = Compiler(("no-such-compiler",))
    assert (missing.path, missing.version()) == (None, "")


def test_a_compiler_that_is_too_slow_is_stopped(monkeypatch):
    monkeypatch.setattr(_compiler, "COMPILE_S", 0.1)
    with pytest.raises(CompilerError, match=r"does not run .*timed out after 0\.1"):
        run_tool(["sleep", "60"])
