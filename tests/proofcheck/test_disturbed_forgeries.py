"""Forged proofs of level 5, of both laws and clocks: no checker takes one, and no header.

The table is tests/support/forgeries/disturbed*.py. Statements that stand in the true files are
taken as checked; of a forgery that is false in a premise, that premise is bounded.
"""

import contextlib
from collections import Counter

import pytest

from proofcheck.test_forgeries import PROGRAM
from support.forgeries import (
    disturbed,
    disturbed_base,
    disturbed_files,
    disturbed_runs,
)
from support.forgeries.ask import answers, ask_header, ask_python, ask_report, complaints
from support.forgeries.base import YES
from support.forgeries.quick import all_but_the_first, statements_taken_as_checked, traced_once

pytestmark = pytest.mark.slow
LEAST_KINDS = 60
THEMES = {
    "numbers": disturbed.THEME,
    "files": disturbed_files.THEME,
    "laws": disturbed_laws.THEME,
    "runs": disturbed_runs.THEME,
}
KINDS = [kind for theme in THEMES.values() for kind in theme.kinds]
EVERY = 4
"""With a run or a page a forgery takes seconds: the benchmark asks all, and this every fourth."""


@pytest.fixture(scope="module")
def traced():
    return {}


@pytest.fixture(scope="module")
def base(traced, tmp_path_factory):
    with traced_once(traced):
        return disturbed_base.make(tmp_path_factory.mktemp("disturbed"))


def test_what_is_forged_is_true(base, traced, tmp_path):
    for about, text in base.texts.items():
        file, run = tmp_path / f"{about}.json", base.runs[about]
        file.write_text(text)
        with statements_taken_as_checked(), traced_once(traced):
            alone, known = ask_python(file), ask_python(file, run)
            header, page = ask_header(run), ask_report(run)
        assert (alone.word, known.word) == (YES["alone"], YES["run"]), (about, alone, known)
        assert (header.word, page.word) == (YES["header"], "5"), (about, header, page)


def test_there_are_enough_kinds_and_none_twice():
    names = Counter(f"{theme}: {kind.kind}" for theme in THEMES for kind in THEMES[theme].kinds)
    words = {name.rpartition(" (")[0] for name in names}
    assert len(words) >= LEAST_KINDS and set(names.values()) == {1}


@pytest.mark.parametrize("about", disturbed_base.LAWS)
def test_forgeries_of_level_5(proofcheck, base, traced, tmp_path, about):
    """Each differs from what it was made from, and gets an answer that is right."""
    wrong = {}
    for number, kind in enumerate(kind for kind in KINDS if kind.about == about):
        forged = kind.make(base)
        true = base.texts[about].encode()
        assert forged.content != true or forged.run != base.runs[about], kind.kind
        known = all_but_the_first(forged.content, tmp_path) if kind.bounded else None
        with contextlib.ExitStack() as stack:
            stack.enter_context(statements_taken_as_checked(known))
            stack.enter_context(traced_once(traced))
            heard = answers(kind, forged, tmp_path, PROGRAM, ("cpp", "alone"))
            refused = "alone" in heard and heard["alone"].word in ("rejected", "unreadable")
            if not refused and (number % EVERY == 0 or "alone" not in heard):
                heard |= answers(kind, forged, tmp_path, PROGRAM, ("run", "report", "header"))
        if found := complaints(kind, heard):
            wrong[kind.kind] = found
    assert not wrong, "\n".join(f"{kind}: {'; '.join(found)}" for kind, found in wrong.items())
