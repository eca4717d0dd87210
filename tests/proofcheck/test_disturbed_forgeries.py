"""Forged proofs of level 5, of both laws and clocks: no checker takes one, and no header.

The table is tests/support/forgeries/disturbed*.py. Statements that stand in the true files are
taken as checked; of a forgery that is false in a premise, that premise is bounded.
"""

from collections import Counter

import pytest

from proofcheck.test_forgeries import PROGRAM
from support.forgeries import disturbed_base
from support.forgeries.ask import answers, ask_header, ask_python, ask_report, complaints
from support.forgeries.base import YES
from support.forgeries.disturbed_table import LEVEL_5
from support.forgeries.quick import all_but_the_first, statements_taken_as_checked, traced_once

pytestmark = pytest.mark.slow
LEAST_KINDS = 60
KINDS = [kind for kinds in LEVEL_5.values() for kind in kinds]
EVERY = 6
"""The benchmark looks at all of them, and this at every sixth of each proof."""


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
    names = Counter(f"{theme}: {kind.kind}" for theme, kinds in LEVEL_5.items() for kind in kinds)
    words = {name.rpartition(" (")[0] for name in names}
    assert len(words) >= LEAST_KINDS and set(names.values()) == {1}


@pytest.mark.parametrize("about", disturbed_base.LAWS)
def test_forgeries_of_level_5(proofcheck, base, traced, tmp_path, about):
    """Each differs from what it was made from, and gets an answer that is right."""
    wrong = {}
    for kind in [kind for kind in KINDS if kind.about == about][::EVERY]:
        forged = kind.make(base)
        true = base.texts[about].encode()
        assert forged.content != true or forged.run != base.runs[about], kind.kind
        known = all_but_the_first(forged.content, tmp_path) if kind.bounded else None
        with statements_taken_as_checked(known), traced_once(traced):
            heard = answers(kind, forged, tmp_path, PROGRAM, ("cpp", "alone", "report", "header"))
            if "alone" in heard and heard["alone"].word not in ("rejected", "unreadable"):
                heard |= answers(kind, forged, tmp_path, PROGRAM, ("run",))
        if found := complaints(kind, heard):
            wrong[kind.kind] = found
    assert not wrong, "\n".join(f"{kind}: {'; '.join(found)}" for kind, found in wrong.items())
