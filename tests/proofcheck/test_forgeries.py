"""Every kind of forgery through the checkers that it is for.

The table is tests/support/forgeries/; `benchmarks/forgeries.py` prints it with every answer
and without what is taken on trust here: that boxes were bounded where a forgery is one of
structure, or where they stand in the true proof as well, and that a file which is refused by
itself is refused with a run as well.
"""

import contextlib
import tempfile
from pathlib import Path

import pytest

from support.forgeries import code, runs
from support.forgeries.ask import answers, ask_cpp, ask_python, ask_report, complaints
from support.forgeries.base import YES
from support.forgeries.quick import stated, statements_taken_as_checked, traced_once
from support.forgeries.table import KINDS, THEMES

PROGRAM = Path(__file__).parents[2] / "build" / "proofcheck"
LEAST_KINDS = 45


@pytest.fixture(scope="module")
def traced():
    return {}


@pytest.fixture(scope="module")
def base(traced, tmp_path_factory):
    with traced_once(traced):
        return runs.make(tmp_path_factory.mktemp("forgeries"))


@pytest.fixture(scope="module")
def stated_truly(base):
    """What test_shipped.py bounds; of the default gait, a forgery's own statements are left."""
    return stated(base.runs["walk"] / runs.PROOF)


def test_what_is_forged_is_true(proofcheck, base, traced, tmp_path):
    """Every proof that a forgery starts from is accepted, by whoever knows its level."""
    for about, text in base.texts.items():
        file, run = tmp_path / f"{about}.json", base.runs[about]
        file.write_text(text)
        assert ask_cpp(PROGRAM, file).word == ("undecided" if about == "full" else "proved")
        boxes = contextlib.nullcontext() if about == "small" else statements_taken_as_checked()
        with boxes, traced_once(traced):
            alone, known = ask_python(file), ask_python(file, run)
        assert (alone.word, known.word) == (YES["alone"], YES["run"]), (about, alone, known)
    assert ask_report(base.runs["walk"]).word == "3"
    assert ask_report(base.runs["full"]).word == "4"


def test_the_table_has_no_kind_twice_and_enough_of_them():
    names = [f"{theme}: {kind.kind}" for theme, kinds in THEMES.items() for kind in kinds]
    assert len(set(names)) == len(names) >= LEAST_KINDS
    assert all(kind.answers for kind in KINDS)


@pytest.mark.slow
@pytest.mark.parametrize("theme", THEMES)
def test_forgeries(proofcheck, base, stated_truly, traced, tmp_path, theme):
    """Each differs from what it was made from, and gets an answer that is right."""
    wrong = {}
    # Each of these is traced: the benchmark looks at all, and this at every third.
    for kind in THEMES[theme][:: 3 if theme == "run_files" else 1]:
        forged = kind.make(base)
        true = base.texts[kind.about].encode()
        assert forged.content != true or forged.run != base.runs[kind.about], kind.kind
        bounds = statements_taken_as_checked(stated_truly if kind.bounded else None)
        with bounds, traced_once(traced), tempfile.TemporaryDirectory(dir=tmp_path) as folder:
            heard = answers(kind, forged, folder, PROGRAM, ("cpp", "alone", "report"))
            refused = "alone" in heard and heard["alone"].word in ("rejected", "unreadable")
            if not (_left_to_the_benchmark(kind) or (refused and not kind.process)):
                heard |= answers(kind, forged, folder, PROGRAM, ("run",))
        found = complaints(kind, heard)
        if found:
            wrong[kind.kind] = found
    assert not wrong, "\n".join(f"{kind}: {'; '.join(found)}" for kind, found in wrong.items())


def _left_to_the_benchmark(kind) -> bool:
    """With a run, seconds each: some of the hostile specs, and level 4 where it may be accepted."""
    if kind.process:
        return not kind.kind.endswith(code.QUICK)
    return kind.about == "full" and "run" in kind.answers and kind.answers["run"].accepts
