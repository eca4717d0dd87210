"""Forged proofs of flat feet, beliefs, speeds, cart-poles and hoppers: no checker takes one.

The table is tests/support/forgeries/systems.py. Boxes of statements that stand in the true proof
are taken as bounded, but in C++, where they are quick.
"""

import contextlib
from collections import Counter

import pytest

from proofcheck.test_forgeries import PROGRAM
from support.forgeries import system_bases
from support.forgeries.ask import answers, ask_cpp, ask_python, complaints
from support.forgeries.base import YES
from support.forgeries.quick import stated, statements_taken_as_checked
from support.forgeries.runs import PROOF
from support.forgeries.systems import SUBJECTS, THEME

pytestmark = pytest.mark.slow
LEAST_KINDS = 60


@pytest.fixture(scope="module")
def traced():
    return {}


@pytest.fixture(scope="module")
def base(feet_run, small_cartpole, small_hopper, tmp_path_factory):
    folder = tmp_path_factory.mktemp("systems")
    return system_bases.systems(folder, feet_run.path, small_cartpole, small_hopper)


def test_what_is_forged_is_true(proofcheck, base, traced, tmp_path):
    """Every proof that a forgery starts from is accepted."""
    for about, text in base.texts.items():
        file = tmp_path / f"{about}.json"
        file.write_text(text)
        assert ask_cpp(PROGRAM, file).word == YES["cpp"], about
        with statements_taken_as_checked(), system_bases.systems_traced_once(traced):
            alone, known = ask_python(file), ask_python(file, base.runs[about])
        assert (alone.word, known.word) == (YES["alone"], YES["run"]), (about, alone, known)


def test_there_are_enough_kinds_and_none_twice():
    names = Counter(kind.kind for kind in THEME.kinds)
    assert len(names) >= LEAST_KINDS and set(names.values()) == {1}


@pytest.mark.parametrize("about", [one.about for one in SUBJECTS])
def test_forgeries_of_systems(proofcheck, base, traced, tmp_path, about):
    """Each differs from what it was made from, and gets an answer that is right."""
    known, wrong = stated(base.runs[about] / PROOF), {}
    for kind in [kind for kind in THEME.kinds if kind.about == about]:
        forged = kind.make(base)
        assert forged.content != base.texts[about].encode(), kind.kind
        with contextlib.ExitStack() as stack:
            stack.enter_context(statements_taken_as_checked(known if kind.bounded else None))
            stack.enter_context(system_bases.systems_traced_once(traced))
            heard = answers(kind, forged, tmp_path, PROGRAM, ("cpp", "alone"))
            if heard["alone"].word not in ("rejected", "unreadable"):
                heard |= answers(kind, forged, tmp_path, PROGRAM, ("run",))
        if found := complaints(kind, heard):
            wrong[kind.kind] = found
    assert not wrong, "\n".join(f"{kind}: {'; '.join(found)}" for kind, found in wrong.items())
