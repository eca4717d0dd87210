"""Two thousand altered proof files through the C++ checker, a hundred through the one in balls.

The default policy's proof is altered: made unreadable, made to contradict itself, made false (with
other weights, bounds, regions, robots) or barely so, its trees flipped, cut, exchanged and grown;
of levels 3 and 4, premises are made false and conclusions are claimed without what they need.
Evidence that a statement is false comes from values at points, that a tree is none from taking its
splits back; never from a checker.
Planted policies break one condition by a little; their forged proofs go through both checkers.

Asked: no altered file is accepted. A false one must be rejected; one that is barely false may be
left undecided. 20 planted policies: every forged proof is rejected, or left undecided by a checker
that is too coarse for it.
"""

import itertools
import json
import shutil
import subprocess
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path

from common import show, trained

from neuralgaits.analysis.run import open_run
from neuralgaits.errors import InputError
from neuralgaits.records.certified import PROOF
from neuralgaits.workflows.certify import certify
from neuralgaits.workflows.check_proof import check_proof

# What alters the files is that of the tests.
from support.mutations.base import Base, Mutation, Reader
from support.mutations.generate import (
    CONCLUSIONS,
    FULL_ORDER,
    FULL_ORDER_PREMISES,
    ONLY_TREES,
    PREMISES,
    Groups,
    mutations,
)
from support.mutations.planted import planted

REPOSITORY = Path(__file__).parents[1]
LEVEL_1, FALSE_PREMISES, NOT_FOLLOWING, TREES, POLICIES = 900, 300, 400, 400, 20
SEED = 10**6
"""Of the first mutation: others than in the tests."""
BALLS_1, BALLS_3, BALLS_4, BALLS_4_CONSTANTS, BALLS_TREES = 40, 15, 15, 10, 20
"""Files for the checker in balls: levels 1, 3 and 4, constants of level 4, trees of all."""
HARD = ("full/reset-slope", "full/coupling", "full/gain", "full/landing-slope", "full/drift")
"""Derivatives along the guard: of these a box takes the checker in balls half a second."""
CODES = {"proved": 0, "consistent": 0, "rejected": 1, "undecided": 3}
EVERYTHING = 10**9
"""Bits of the largest tree kept: all statements stay in the file."""


def main() -> None:
    """Print how many files of each kind got which answer, and how long the checker took."""
    subprocess.run(["make", "--silent", "proofcheck"], cwd=REPOSITORY, check=True)
    with tempfile.TemporaryDirectory() as folder:
        first = certified(1, Path(folder) / "1")
        third, fourth = (certified(k, Path(folder) / str(k)) for k in (3, 4))
    whole, all_levels = (Base(one.table, one.run, most=EVERYTHING) for one in (third, fourth))
    easy = easily_bounded(fourth)
    suites = {
        "level 1": mutations(first, "model", LEVEL_1),
        "level 3, premises": altered(third.premises(), FALSE_PREMISES, PREMISES),
        "level 3, conclusions": altered(whole, NOT_FOLLOWING, CONCLUSIONS),
        "level 4, conclusions": altered(all_levels, NOT_FOLLOWING, CONCLUSIONS),
        "levels 1 to 3, trees": mixed(first, third.premises(), TREES),
    }
    for name, suite in suites.items():
        report(name, suite, cpp)
    in_balls = {
        "balls, level 1": mutations(first, "program", BALLS_1, seed=SEED),
        "balls, level 3, premises": altered(third.premises(), BALLS_3, PREMISES, "program"),
        "balls, level 4, premises": altered(easy, BALLS_4, FULL_ORDER_PREMISES, "program"),
        "balls, level 4, constants": altered(fourth, BALLS_4_CONSTANTS, FULL_ORDER, "program"),
        "balls, trees": mixed(third.premises(), easy, BALLS_TREES, "program"),
    }
    for name, suite in in_balls.items():
        report(name, suite, balls)
    report_planted(first)


def certified(level: int, folder: Path) -> Base:
    """The default policy's proof of a level; the run is copied to the folder."""
    run = open_run(shutil.copytree(trained("amber3m", 0).path, folder))
    certify(run, level=level)
    return Base(json.loads((run.path / PROOF).read_text()), run)


def easily_bounded(base: Base) -> Base:
    """The statements of level 4 that take no minutes, none of them concluded from."""
    table = base.premises().table
    names = [s["conditions"][0] for s in table["statements"]]
    easy = [name.startswith("full/") and not name.startswith(HARD) for name in names]
    table["statements"] = list(itertools.compress(table["statements"], easy))
    return Base(table, base.run)


def altered(base: Base, count: int, groups: Groups, reader: Reader = "model") -> Iterator[Mutation]:
    """Mutations of some kinds, from another seed than those of the tests."""
    return mutations(base, reader, count, seed=SEED, groups=groups)


def mixed(one: Base, two: Base, count: int, reader: Reader = "model") -> Iterator[Mutation]:
    """Trees of two proofs, half of each."""
    return itertools.chain(*(altered(base, count // 2, ONLY_TREES, reader) for base in (one, two)))


def cpp(file: Path) -> int:
    """Exit code of the C++ checker."""
    return subprocess.run(
        [REPOSITORY / "build" / "proofcheck", file], capture_output=True
    ).returncode


def balls(file: Path) -> int:
    """Exit code of the checker in balls."""
    try:
        return CODES[check_proof(file)["verdict"]]
    except InputError:
        return 2


def report(name: str, suite: Iterable[Mutation], checker: Callable[[Path], int]) -> None:
    """Print answers by kind of alteration."""
    seen: Counter[tuple[str, int]] = Counter()
    seconds, wrong = [], []
    with tempfile.TemporaryDirectory() as folder:
        for mutation in suite:
            file = Path(folder) / "proof.json"
            file.write_bytes(mutation.text)
            start = time.perf_counter()
            code = checker(file)
            seconds.append(time.perf_counter() - start)
            seen[mutation.kind, code] += 1
            if code not in mutation.allowed:
                wrong.append(f"{mutation.name}: exit {code}")
    for kind, rows in itertools.groupby(sorted(seen.items()), key=lambda row: row[0][0]):
        codes = ", ".join(f"{count} x exit {code}" for (_, code), count in rows)
        show(f"{name}: {kind}", codes, "1 rejected, 2 no proof file, 3 undecided")
    show(f"{name}: files, answered wrongly", f"{len(seconds)}, {len(wrong)}", "0 wrong")
    for line in wrong:
        print("  ", line)
    show(f"{name}: seconds in all, slowest", f"{sum(seconds):.1f}, {max(seconds):.2f}")


def report_planted(base: Base) -> None:
    """Forged proofs of policies that break a condition by a little, through both checkers."""
    seen: Counter[str] = Counter()
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "proof.json"
        for gait in planted(base, POLICIES):
            file.write_bytes(gait.forged(base).text)
            seen[f"C++ {cpp(file)}, balls {balls(file)}"] += 1
    show("planted violations: exit codes", "; ".join(f"{n} x {k}" for k, n in seen.items()), "no 0")


if __name__ == "__main__":
    main()
