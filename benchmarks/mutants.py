"""Mutants of the package that its tests kill: one operator, sign or number changed at a time.

    mutants.py [--count 200] [--seed 0] [--tree .] [--limit 300]

Sites are drawn at random over seven rooms of a tree's sources, the same number of each room. A
mutant is written into a copy of the tree; then the test files run that import the changed file, or
those of its room if none does, the one of its name and the shortest first, until a test fails. A
mutant that outlives them is shown with its line: it is worth a look, and may change nothing that
anyone can see. What takes longer than the limit counts as killed, since a test run would not end.
"""

import argparse
import ast
import os
import random
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path

ROOMS = ("gait", "barriers", "control", "certificate", "programs", "export", "simulation")
SWAPPED: dict[type, type] = {
    ast.Add: ast.Sub,
    ast.Sub: ast.Add,
    ast.Mult: ast.Div,
    ast.Div: ast.Mult,
    ast.Lt: ast.LtE,
    ast.LtE: ast.Lt,
    ast.Gt: ast.GtE,
    ast.GtE: ast.Gt,
    ast.Eq: ast.NotEq,
    ast.NotEq: ast.Eq,
    ast.And: ast.Or,
    ast.Or: ast.And,
    ast.USub: ast.UAdd,
}
FILES = 4
"""Most test files that a mutant meets."""


def sites(path: Path) -> Iterator[tuple[int, str]]:
    """Yield the mutants of a file: the number of a node in `ast.walk`, and what is done to it."""
    for number, node in enumerate(ast.walk(ast.parse(path.read_text()))):
        match node:
            case ast.BinOp(op=op) | ast.BoolOp(op=op) | ast.UnaryOp(op=op):
                if type(op) in SWAPPED:
                    yield number, "operator"
            case ast.Compare(ops=[op]) if type(op) in SWAPPED:
                yield number, "comparison"
            case ast.Constant(value=int() | float() as value) if not isinstance(value, bool):
                yield number, "off by one" if isinstance(value, int) else "constant"


def mutated(path: Path, number: int) -> tuple[int, str, str]:
    """Return the line of a mutant, that line in words, and the file's new text."""
    tree = ast.parse(path.read_text())
    node = list(ast.walk(tree))[number]
    before = ast.unparse(node)
    match node:
        case ast.BinOp() | ast.BoolOp() | ast.UnaryOp():
            node.op = SWAPPED[type(node.op)]()
        case ast.Compare():
            node.ops = [SWAPPED[type(node.ops[0])]()]
        case ast.Constant(value=int() as value):
            node.value = value + 1
        case ast.Constant(value=float() as value):
            node.value = 1.1 * value + 0.01
        case _:
            raise TypeError(f"no mutant of {node}")
    line = getattr(node, "lineno", 0)
    return line, f"{before}  ->  {ast.unparse(node)}", ast.unparse(tree)


def tests_of(tree: Path, path: Path) -> list[str]:
    """Return the test files that import a file, else those of its room; the shortest first."""
    module = ".".join(path.relative_to(tree / "src").with_suffix("").parts)
    package, _, name = module.rpartition(".")
    told = re.compile(
        rf"(from|import) {re.escape(module)}\b|from {re.escape(package)} import .*\b{name}\b"
    )
    own = f"test_{path.stem}.py"
    every = sorted(
        (tree / "tests").rglob("test_*.py"), key=lambda one: (one.name != own, one.stat().st_size)
    )
    found = [one for one in every if told.search(one.read_text())]
    room = path.relative_to(tree / "src" / "neuralgaits").parts[0]
    found += [one for one in every if one not in found and one.parent.name == room]
    return [str(one.relative_to(tree)) for one in found[:FILES]]


def killed(tree: Path, files: list[str], limit: float) -> bool:
    """Run test files on a tree until a test fails. Returns: whether one did."""
    line = [sys.executable, "-m", "pytest", "-x", "-q", "-p", "no:cacheprovider", *files]
    environment = os.environ | {"PYTHONPATH": os.pathsep.join((f"{tree}/src", f"{tree}/tests"))}
    try:
        done = subprocess.run(
            line, cwd=tree, env=environment, capture_output=True, timeout=limit, check=False
        )
    except subprocess.TimeoutExpired:
        return True
    return done.returncode != 0


def left_out(source: Path) -> Callable[[str, list[str]], set[str]]:
    """Return what `copytree` leaves out of a tree: what is made there, and not in its history."""
    made = {".git", ".venv", ".cache", "runs", "build", "dist"}
    return lambda folder, names: {
        name for name in names if name == "__pycache__" or (name in made and Path(folder) == source)
    }


def main() -> None:
    """Draw mutants, run the tests on each, print the share that is killed."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=200)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--tree", type=Path, default=Path(__file__).parents[1])
    parser.add_argument("--limit", type=float, default=300.0)
    asked = parser.parse_args()
    draw = random.Random(asked.seed)
    source = asked.tree.resolve()
    dead, every = 0, 0
    with tempfile.TemporaryDirectory() as place:
        tree = Path(place) / "tree"
        shutil.copytree(source, tree, ignore=left_out(source), symlinks=True)
        sound: set[str] = set()
        for k in range(asked.count):
            room = tree / "src" / "neuralgaits" / ROOMS[k % len(ROOMS)]
            found = [(one, *site) for one in sorted(room.rglob("*.py")) for site in sites(one)]
            path, number, kind = draw.choice(found)
            line, words, text = mutated(path, number)
            before = path.read_text()
            path.write_text(text)
            files = tests_of(tree, path)
            died = killed(tree, files, asked.limit)
            path.write_text(before)
            if died and not sound.issuperset(files):
                # What fails without a mutant as well kills none.
                if killed(tree, files, 10.0 * asked.limit):
                    raise SystemExit(
                        f"expected tests that pass on {source}, found failures: {files}"
                    )
                sound.update(files)
            dead, every = dead + died, every + 1
            place_of = f"{path.relative_to(tree / 'src' / 'neuralgaits')}:{line}"
            fate = "killed" if died else "ALIVE"
            print(f"{fate:6} {place_of} {kind}: {words:.100}", flush=True)
    print(f"{dead} of {every} killed, {dead / max(every, 1):.0%}")


if __name__ == "__main__":
    main()
