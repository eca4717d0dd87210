"""Every kind of structural forgery, and what each checker answers.

The table is tests/support/forgeries/: names that shadow premises, regions cut down, Programs
that say 1, theorems with other parameters, other robots, parts of other runs, hostile spec files,
and, of level 5, other holds, clocks, laws, gains and kicks than those that were proved.
A checker may accept a file only where what it then says is true; how many it accepts otherwise
stands in the last line.

Premises of levels 2 to 4 are taken as checked where a forgery is one of structure; `--boxes`
bounds them all, which takes an hour, and hours for level 5. Words restrict the themes:
`forgeries.py regions trees`, `forgeries.py level-5-laws`.
"""

import contextlib
import os
import subprocess
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

from common import show

# What is forged is the tests'.
from support.forgeries import disturbed_base
from support.forgeries.ask import Heard, answers, complaints
from support.forgeries.base import EXIT, YES, Base, Forgery
from support.forgeries.disturbed_table import LEVEL_5
from support.forgeries.quick import statements_taken_as_checked, traced_once
from support.forgeries.runs import make
from support.forgeries.table import THEMES

REPOSITORY = Path(__file__).parents[1]
PROGRAM = REPOSITORY / "build" / "proofcheck"
CHECKERS = ("cpp", "alone", "run", "report", "header")
TABLES = (THEMES, make), (LEVEL_5, disturbed_base.make)
"""Themes, and what makes the true proofs that they start from."""
WIDTH = 66


def main(themes: list[str], *, boxes: bool) -> None:
    """Print the table, theme by theme, and the counts."""
    subprocess.run(["make", "--silent", "proofcheck"], cwd=REPOSITORY, check=True)
    start_time, counts = time.perf_counter(), Counter[str]()
    head = ("C++", "Python", "with run", "report", "header")
    print(f"{'kind':{WIDTH}} " + " ".join(f"{name:12}" for name in head))
    for table, maker in TABLES:
        chosen = {name: table[name] for name in table if not themes or name in themes}
        if not chosen:
            continue
        with tempfile.TemporaryDirectory() as folder, traced_once({}):
            base = maker(Path(folder), boxes=boxes)
            for theme, kinds in chosen.items():
                print(f"-- {theme}")
                for kind in kinds:
                    print(line(kind, base, boxes, counts), flush=True)
    show("kinds of forgery", str(counts["kinds"]), "45 or more")
    show("accepted because what is said is true", str(counts["true"]))
    show("answered otherwise than they should be", str(counts["wrong"]), "0")
    show("seconds", f"{time.perf_counter() - start_time:.0f}")
    show("accepted as proved", str(counts["deceived"]), "0")


def line(kind: Forgery, base: Base, boxes: bool, counts: Counter[str]) -> str:
    """One row of the table."""
    with contextlib.ExitStack() as stack:
        folder = stack.enter_context(tempfile.TemporaryDirectory(dir=base.scratch))
        if not (boxes or kind.bounded):
            stack.enter_context(statements_taken_as_checked())
        heard = answers(kind, kind.make(base), folder, PROGRAM, CHECKERS)
    wrong = complaints(kind, heard)
    accepted = [name for name, answer in heard.items() if _accepts(name, answer)]
    counts["kinds"] += 1
    counts["wrong"] += bool(wrong)
    deceived = {name for name in accepted if any(text.startswith(f"{name} ") for text in wrong)}
    counts["deceived"] += bool(deceived)
    counts["true"] += bool(set(accepted) - deceived)
    row = " ".join(f"{_shown(heard.get(name)):12}" for name in CHECKERS)
    return f"{kind.kind[:WIDTH]:{WIDTH}} {row}" + "".join(f"\n   ! {text}" for text in wrong)


def _accepts(checker: str, answer: Heard) -> bool:
    """Whether an answer is taken for `proved`; a report's is judged by its level."""
    return answer.word in (YES[checker], "proved")


def _shown(answer: Heard | None) -> str:
    if answer is None:
        return "-"
    code = EXIT.get(answer.word)
    return answer.word if code is None else f"{code} {answer.word}"


if __name__ == "__main__":
    os.environ.setdefault("JAX_PLATFORMS", "cpu")
    chosen = [word for word in sys.argv[1:] if not word.startswith("-")]
    main(chosen, boxes="--boxes" in sys.argv)
