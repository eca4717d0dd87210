"""What tests keep of slow functions is a function of what these are given."""

import functools
from types import FunctionType

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest

from neuralgaits.analysis import poincare_map, point_evaluator
from neuralgaits.analysis.run import open_run
from neuralgaits.certificate.levels import problems
from neuralgaits.errors import SpecError
from neuralgaits.gait import gaits
from neuralgaits.programs.program import Constant, Output, Program
from support import kept_executables, kept_results
from support.kept_results import KeptResults
from support.shipped_run import SHIPPED


@pytest.fixture
def kept():
    with pytest.MonkeyPatch.context() as patch:
        # The session's own notices patches as well, and stays as it is.
        results = KeptResults()
        for name in ("setattr", "setitem", "undo"):
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


def test_what_an_object_has_computed_of_itself_is_no_part_of_it(kept):
    calls, numbered = pair_of(kept)
    program, same = (constant_program(1.0) for _ in range(2))
    numbered(program)
    assert program.hash == same.hash and "hash" in vars(program)
    numbered(program)
    numbered(same)
    assert len(calls) == 1
    numbered(constant_program(2.0))
    assert len(calls) == 2


def constant_program(number):
    array = np.array([number])
    return Program((), (Constant(None, array),), (), (Output("one", (1,), 0),))


def test_code_of_a_test_or_a_user_has_no_key(kept):
    calls, numbered = pair_of(kept)
    for code in (opened, functools.partial(opened), lambda: None, kept_results.KeptResults):
        numbered(code)
        numbered(code)
    assert len(calls) == 8
    numbered(poincare_map.motion_of, gaits.Gait)
    numbered(poincare_map.motion_of, gaits.Gait)
    assert len(calls) == 9


def as_if_the_packages(function, room="made_up"):
    """The same function, made anew, as if it stood in a file of the package."""
    place = {"__name__": f"neuralgaits.{room}.file", "np": np}
    made = FunctionType(
        function.__code__, place, "made", function.__defaults__, function.__closure__
    )
    made.__module__, made.__qualname__ = place["__name__"], "maker.<locals>.made"
    return made


def scaled(factor, offset: object = 0.0):
    return as_if_the_packages(lambda x, y=offset: factor * x + y)


def test_functions_that_are_made_anew_are_equal_if_code_and_values_are(kept):
    calls, numbered = pair_of(kept)
    first = numbered(scaled(np.arange(3.0)))
    assert numbered(scaled(np.arange(3.0))) is first and first == {"call": 1}
    others = (
        scaled(np.arange(3.0) + 1e-16 * np.eye(3)[0]),
        scaled(np.arange(3.0), offset=1.0),
        scaled(scaled(np.arange(3.0))),
        as_if_the_packages(lambda x: x + 1.0),
        as_if_the_packages(lambda x: x + 2.0),
        as_if_the_packages(lambda x: x - 2.0),
        as_if_the_packages(lambda x: np.sin(x)),
        as_if_the_packages(lambda x: np.cos(x)),
    )
    assert [numbered(one)["call"] for one in others] == list(range(2, len(others) + 2))
    assert len(calls) == len(others) + 1


def test_a_function_that_could_note_its_calls_is_called_each_time(kept):
    calls, numbered = pair_of(kept)
    for noted in ([], {}, set()):
        for _ in range(2):
            numbered(scaled(noted))
            numbered(scaled(1.0, noted))
    assert len(calls) == 12


def test_what_is_traced_of_a_gait_is_kept_and_another_gait_is_traced(results_are_kept):
    """One number more or less in its last digit makes another gait."""
    run = open_run(SHIPPED)

    def evaluator(gait):
        before = results_are_kept.computed
        made = point_evaluator.PointEvaluator(
            point_evaluator.quantities(run.zero_dynamics, gait, run.spec)
        )
        assert made._program is not None
        return made._program, results_are_kept.computed - before

    first, _ = evaluator(run.gait)
    again, computed = evaluator(open_run(SHIPPED).gait)
    assert again is first and computed == 0
    unit = np.nextafter(np.asarray(run.gait.tube.unit), np.inf)
    other, computed = evaluator(eqx.tree_at(lambda g: g.tube.unit, run.gait, unit))
    assert computed == 1 and other.hash != first.hash


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


@pytest.mark.parametrize(
    ("target", "changed"),
    [
        ("neuralgaits.workflows.certify.certify", False),
        ("neuralgaits.training.trainer.Trainer.step", False),
        ("neuralgaits.certificate.levels.problems.PLANE", False),
        ("neuralgaits.analysis.poincare_map.motion_of", True),
        ("neuralgaits.gait.gaits.Gait", True),
        ("neuralgaits._blocks.in_blocks", True),
        ("jax.numpy.cos", True),
    ],
)
def test_a_patch_counts_for_the_rooms_that_may_import_what_it_changes(kept, target, changed):
    """A function of the analysis, given data; and given a function of another room."""
    own = kept.of(as_if_the_packages(lambda *_: object(), "analysis"), False)
    given = as_if_the_packages(lambda x: x, "training")
    first, with_a_training = own(1), own(given)
    assert own(1) is first and own(given) is with_a_training
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(target, None)
        assert (own(1) is not first) == changed
        # Rooms on one level do not import each other.
        unseen = target.startswith(("neuralgaits.workflows", "neuralgaits.certificate"))
        assert (own(given) is not with_a_training) == (not unseen)
    assert own(1) is first


def test_a_patch_of_an_object_counts_for_all_rooms(kept):
    own = kept.of(as_if_the_packages(lambda *_: object(), "analysis"), False)
    first = own(1)
    for target in (kept, KeptResults, {}):
        with pytest.MonkeyPatch.context() as patch:
            if isinstance(target, dict):
                patch.setitem(target, "a", 1)
            else:
                patch.setattr(target, "made_up", 1, raising=False)
            assert own(1) is not first
    assert own(1) is first


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


def test_workers_share_programs_and_nobody_changes_one(tmp_path):
    workers = KeptResults(tmp_path), KeptResults(tmp_path)
    made = [one.of(constant_program, False, program=True) for one in workers]
    first, second = (one(1 / 3) for one in made)
    assert first == second == constant_program(1 / 3) and made[0](1 / 3) is first
    assert [one.computed for one in workers] == [1, 0]
    with pytest.raises(ValueError, match="read-only"):
        second.constants[0].array[0] = 1.0
    assert made[1](2 / 3) == constant_program(2 / 3) != first


def test_in_single_precision_nothing_is_kept(kept):
    calls, numbered = pair_of(kept)
    numbered(1)
    with jax.enable_x64(False):
        numbered(1)
    assert len(calls) == 2


def test_the_package_and_its_helpers_call_what_keeps(results_are_kept):
    """Test files have the functions themselves."""
    run, found, computed = open_run(SHIPPED), [], []
    for _ in range(2):
        found.append(poincare_map.poincare(run.zero_dynamics, jnp.array([0.0, 12.0])))
        computed.append(results_are_kept.computed)
    assert computed[0] == computed[1]
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
