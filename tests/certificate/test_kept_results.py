"""What tests keep of slow functions is a function of what these are given."""

import functools

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest

from neuralgaits.analysis import poincare_map
from neuralgaits.analysis.run import open_run
from neuralgaits.certificate.levels import problems
from neuralgaits.errors import SpecError
from neuralgaits.gait import gaits
from support import kept_executables, kept_results
from support.kept_results import KeptResults
from support.shipped_run import SHIPPED


@pytest.fixture
def kept():
    with pytest.MonkeyPatch.context() as patch:
        # The session's own notices patches as well, and stays as it is.
        results = KeptResults()
        for name in ("setattr", "undo"):
            watched = results._undone() if name == "undo" else results._noticed(name)
            patch.setattr(pytest.MonkeyPatch, name, watched)
        results._patching.clear()
        yield results


def pair_of(kept, **how):
    """A function that numbers its calls, and the same with its results kept."""
    calls = []

    def numbered(*given):
        calls.append(given)
        return {"call": len(calls)}

    return calls, kept.of(numbered, **{"copied": False} | how)


def opened():
    run = open_run(SHIPPED)
    return run.spec, run.robot, run.gait, run.residuals


def test_equal_arguments_have_one_result_and_others_their_own(kept):
    calls, numbered = pair_of(kept)
    assert numbered(*opened()) is numbered(*opened()) and len(calls) == 1
    spec, robot, gait, residuals = opened()
    unit = np.nextafter(np.asarray(gait.tube.unit), np.inf)
    other = eqx.tree_at(lambda g: g.tube.unit, gait, unit)
    assert numbered(spec, robot, other, residuals) == {"call": 2}
    assert numbered(spec.with_conditions(*spec.conditions[:0]), robot, gait, residuals) is not None
    assert numbered(1.0) == {"call": len(calls)} != numbered(1)
    assert kept.computed == len(calls)


def test_code_of_a_test_or_a_user_has_no_key(kept):
    calls, numbered = pair_of(kept)
    for code in (opened, functools.partial(opened), lambda: None, kept_results.KeptResults):
        numbered(code)
        numbered(code)
    assert len(calls) == 8
    numbered(poincare_map.motion_of, gaits.Gait)
    numbered(poincare_map.motion_of, gaits.Gait)
    assert len(calls) == 9


def test_while_the_package_is_patched_everything_is_computed(kept, monkeypatch):
    calls, numbered = pair_of(kept)
    numbered(1)
    monkeypatch.setattr("os.sep", "/")
    assert numbered(1) == {"call": 1}
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(problems, "PLANE", 2)
        assert numbered(1) == {"call": 2}
    assert numbered(1) == {"call": 1} and len(calls) == 2
    monkeypatch.setattr("neuralgaits.systems.hopper.hop_episodes.HOPS", 2)
    assert numbered(1) == {"call": 1}
    monkeypatch.setattr("neuralgaits.systems.hopper.hop_episodes.LATEST_S", 2.0)
    assert numbered(1) == {"call": 3}


def test_copies_are_the_callers_and_errors_are_not_kept(kept):
    _, numbered = pair_of(kept, copied=True)
    numbered(1)["call"] = 7
    assert numbered(1) == {"call": 1}
    raised = []

    def raising(given):
        raised.append(given)
        raise SpecError("no")

    for _ in range(2):
        with pytest.raises(SpecError):
            kept.of(raising, False)(1)
    assert len(raised) == 2


def test_workers_share_what_can_be_copied(tmp_path):
    workers = KeptResults(tmp_path), KeptResults(tmp_path)
    for copied, expected in ((True, 1), (False, 2)):
        made = [pair_of(one, copied=copied)[1] for one in workers]
        assert [one(copied) for one in made] == [{"call": 1}] * 2
        assert sum(one.computed for one in workers) == expected + (not copied)
    assert pair_of(workers[1], copied=True)[1](3) == {"call": 1}
    assert workers[1].computed == 2 and not list(tmp_path.glob("*.[0-9]*"))


def test_in_single_precision_nothing_is_kept(kept):
    calls, numbered = pair_of(kept)
    numbered(1)
    with jax.enable_x64(False):
        numbered(1)
    assert len(calls) == 2


def test_the_package_and_its_helpers_call_what_keeps(results_are_kept):
    """Test files have the functions themselves."""
    run = open_run(SHIPPED)
    before = results_are_kept.computed
    found = [poincare_map.poincare(run.zero_dynamics, jnp.array([0.0, 12.0])) for _ in range(2)]
    assert results_are_kept.computed <= before + 1
    np.testing.assert_array_equal(found[0].fixed_point, found[1].fixed_point)
    assert found[0].fixed_point is not found[1].fixed_point


def test_a_program_is_compiled_once_for_functions_that_are_made_anew(monkeypatch):
    """And again for another shape, and where nothing is kept."""
    compiler = pytest.importorskip("jax._src.compiler")
    compiled = []

    def counted(backend, module, *given):
        compiled.append(module)
        return make(backend, module, *given)

    make = compiler.backend_compile_and_load
    monkeypatch.setattr(compiler, "backend_compile_and_load", counted)
    monkeypatch.setattr(compiler, "_cache_read", lambda *_: (None, None))
    monkeypatch.setattr(compiler, "_cache_write", lambda *_: None)

    def called(size):
        before = len(compiled)
        found = jax.jit(lambda x: jnp.cos(x) * 3.25)(np.zeros(size))
        assert np.all(np.asarray(found) == 3.25)
        return len(compiled) - before

    kept_executables.keep(monkeypatch)
    assert [called(size) for size in (3, 3, 4)] == [1, 0, 1]
