"""The search proves what holds, refutes what does not, and never proves NaN."""

import itertools
from dataclasses import fields, replace
from types import SimpleNamespace

import jax.numpy as jnp
import numpy as np
import pytest

from neuralgaits.certificate.chart import CoupledAxes
from neuralgaits.certificate.levels.conditions.verdicts import verdict_on
from neuralgaits.certificate.proof_file.writer import prove
from neuralgaits.certificate.search import (
    axis_costs,
    branch_and_bound,
    checkpoint,
    halved_axis,
    root_turns,
)
from neuralgaits.certificate.search.box_tree import BoxTree
from neuralgaits.certificate.search.branch_and_bound import (
    MOST_AT_START,
    Search,
    bound_here,
    missing,
    search,
    start,
    to_split,
)
from neuralgaits.certificate.search.checkpoint import load, save
from neuralgaits.certificate.search.halving import boxes_of, halves, to_text
from neuralgaits.certificate.search.problem import Problem
from neuralgaits.certificate.search.root_turns import SearchInterrupted, explore
from neuralgaits.errors import RunError
from neuralgaits.programs.native.bounder import Bounder
from neuralgaits.programs.tracing.tracer import trace
from neuralgaits.records.certified import Counterexample

SQUARE = ((0.0, 0.0), (1.0, 1.0))


def _problem(low=SQUARE[0], high=SQUARE[1], scale=1.0, degree=2, **functions) -> Problem:
    program = trace(lambda u: {name: f(u) for name, f in functions.items()}, {"u": (len(low),)})
    names = tuple(functions)
    return Problem("square", low, high, names, (scale,) * len(names), program, degree)


def _confirm(problem: Problem):
    def confirm(name, u):
        margin = problem.values(u[None])[0, problem.names.index(name)]
        point = (float(u[0]), float(u[1]))
        return Counterexample(point, point, float(margin)) if margin < 0 else None

    return confirm


def _run(problem: Problem, state=None, **options):
    return explore([problem], [state], _confirm(problem), **options)[0]


def _cuts(state):
    tree = state.tree
    return boxes_of(tree.first, tree.axis, tree.low_corner, tree.high_corner)[2]


def _verdict(problem, state, name):
    claims = [s.bounds[name] for s in prove(problem, state) if name in s.conditions]
    return verdict_on(name, [(problem, state)], min(claims) if claims else None)


def bowl(u):
    """Least value 0.1, at (0.3, 0.6)."""
    return 0.1 + (u[0] - 0.3) ** 2 + jnp.tanh(u[1] - 0.6) ** 2


def ripple(u):
    """Least value 0.02 on a curve."""
    return 1.02 + jnp.sin(9.0 * u[0] + 4.0 * u[1])


@pytest.mark.parametrize("degree", [1, 2])
def test_margins_are_proved_and_nearly_sharp(degree):
    problem = _problem(bowl=bowl, ripple=ripple, degree=degree, scale=2.0)
    state = _run(problem)
    for name, least in (("bowl", 0.1), ("ripple", 0.02)):
        verdict = _verdict(problem, state, name)
        assert verdict.verdict == "proved"
        assert verdict.proved_fraction == 1.0
        assert verdict.counterexample is None
        assert verdict.margin is not None
        assert 0.6 * least / 2.0 < verdict.margin <= least / 2.0


def test_a_planted_violation_is_refuted_with_its_point():
    def dented(u):
        return bowl(u) - 0.11 * jnp.exp(-4e3 * ((u[0] - 0.301) ** 2 + (u[1] - 0.603) ** 2))

    problem = _problem(bowl=bowl, dented=dented)
    state = _run(problem)
    assert _verdict(problem, state, "bowl").verdict == "proved"
    found = _verdict(problem, state, "dented")
    assert found.verdict == "refuted"
    assert found.margin is None
    assert 0.5 < found.proved_fraction < 1.0
    point = found.counterexample
    assert point is not None
    assert dented(np.array(point.u)) == pytest.approx(point.margin)
    assert point.margin < 0.0
    assert np.hypot(point.u[0] - 0.301, point.u[1] - 0.603) < 0.05
    assert all("dented" not in s.conditions for s in prove(problem, state))


def test_a_violation_everywhere_needs_no_search():
    problem = _problem(never=lambda u: -1.0 - u[0])
    state = _run(problem)
    verdict = _verdict(problem, state, "never")
    assert (verdict.verdict, verdict.proved_fraction) == ("refuted", 0.0)
    assert verdict.undecided_boxes == 0


@pytest.mark.parametrize(
    "function",
    [
        lambda u: 1.0 + jnp.sqrt(u[0] - 0.5),
        lambda u: 2.0 + 1.0 / (u[0] - u[1]),
        lambda u: 5.0 + jnp.log1p(-u[0]),
        lambda u: jnp.exp(1e3 * u[0]),
    ],
)
def test_nan_and_infinity_are_not_proved(function):
    problem = _problem(bad=function, good=bowl)
    # No confirmation: what is not proved must not become so by any other way.
    state = explore([problem], [None], lambda name, u: None, deadline=np.inf)[0]
    assert _verdict(problem, state, "bad").verdict == "undecided"
    assert _verdict(problem, state, "bad").proved_fraction < 1.0
    assert _verdict(problem, state, "bad").undecided_boxes > 0
    assert _verdict(problem, state, "good").verdict == "proved"
    assert all(s.conditions == ("good",) for s in prove(problem, state))


def test_bounds_hold_at_random_points():
    problem = _problem(bowl=bowl, ripple=ripple, both=lambda u: jnp.stack([bowl(u), ripple(u)]))
    tree = _run(problem).tree
    draw = np.random.default_rng(1)
    known = np.flatnonzero(np.isfinite(tree.lower[:, 0]))
    for _ in range(20):
        share = draw.uniform(size=(len(known), 2))
        low, high = (corner[known] for corner in tree.corners)
        u = low + share * (high - low)
        values = problem.values(u)
        assert np.all(tree.lower[known] <= values)
        assert np.all(values <= tree.upper[known])


def test_the_budget_ends_the_search_and_a_later_one_goes_on(tmp_path):
    problem = _problem(ripple=lambda u: ripple(u) - 0.0199, degree=1)
    first = search(
        problem, start(problem, _confirm(problem)), _confirm(problem), phase="decide", most=2000
    )
    unfinished = _verdict(problem, first, "ripple")
    assert unfinished.verdict == "undecided"
    assert 0.5 < unfinished.proved_fraction < 1.0
    save(tmp_path / "boxes", problem, first)
    second = _run(problem, load(tmp_path / "boxes", problem))
    assert _verdict(problem, second, "ripple").verdict == "proved"
    assert len(second.tree.first) > len(first.tree.first)
    whole = _run(problem)
    assert {s.tree for s in prove(problem, whole)} == {s.tree for s in prove(problem, second)}
    late = _run(problem, deadline=0.0)
    assert np.all(late.tree.depth <= MOST_AT_START)


def test_no_time_means_no_work():
    problem = _problem(bowl=bowl)
    state = _run(problem, deadline=0.0)
    assert not state.begun
    assert _verdict(problem, state, "bowl").proved_fraction == 0.0
    whole, later = _run(problem), _run(problem, state)
    assert [s.tree for s in prove(problem, later)] == [s.tree for s in prove(problem, whole)]


@pytest.mark.parametrize("calls", [1, 2, 6])
def test_an_interrupt_carries_what_was_found(calls, monkeypatch):
    bounds, count = Problem.bounds, []

    def interrupted(self, low, high):
        count.append(len(low))
        if len(count) == calls:
            raise KeyboardInterrupt
        return bounds(self, low, high)

    monkeypatch.setattr(Problem, "bounds", interrupted)
    problem = _problem(ripple=lambda u: ripple(u) - 0.0199, degree=1)
    with pytest.raises(SearchInterrupted) as stop:
        _run(problem)
    (state,) = stop.value.states
    assert state.begun == (calls > 1)
    whole, later = _run(problem), _run(problem, state)
    assert {s.tree for s in prove(problem, later)} == {s.tree for s in prove(problem, whole)}


def test_boxes_have_an_end_and_a_budget_lifts_it(monkeypatch):
    def zero(u):
        return jnp.tanh(u[0] - u[1]) ** 2

    problem = _problem(zero=zero, degree=1)
    monkeypatch.setattr(root_turns, "MAX_BOXES", 300)
    capped = _run(problem)
    assert 300 <= len(capped.tree.first) <= 2**6 - 1 + 300
    assert _verdict(problem, capped, "zero").verdict == "undecided"
    assert len(_run(problem, capped).tree.first) > len(capped.tree.first)
    # A clock that goes on by a second whenever the search looks at it: no test rests on a time.
    seconds = itertools.count()
    clock = SimpleNamespace(monotonic=lambda: float(next(seconds)))
    for searching in (branch_and_bound, axis_costs, halved_axis, root_turns):
        monkeypatch.setattr(searching, "time", clock)
    assert len(_run(problem, deadline=40.0).tree.first) > 1000
    assert next(seconds) < 80
    one = Search.untouched(problem).tree.nbytes
    monkeypatch.setattr(root_turns, "MEMORY_BYTES", 700 * one)
    held = _run(problem, deadline=1e6)
    assert next(seconds) < 1e3
    assert 600 < len(held.tree.first) <= 720


def test_without_a_compiler_a_wide_network_is_bounded_in_smaller_batches(monkeypatch):
    monkeypatch.setattr(Bounder, "of", lambda *program: None)
    narrow, wide = np.ones((8, 2)), np.ones((2048, 2))

    def batch(weights):
        problem = _problem(f=lambda u: 1.0 + jnp.sum(jnp.square(weights @ u)))
        return problem.batch

    assert batch(narrow) == 512
    assert batch(wide) == 64


def test_running_out_of_memory_keeps_what_was_proved(monkeypatch):
    bounds, calls = Problem.bounds, []

    def exhausted(self, low, high):
        calls.append(len(low))
        if sum(calls) > 500:
            raise MemoryError
        return bounds(self, low, high)

    monkeypatch.setattr(Problem, "bounds", exhausted)
    problem = _problem(ripple=lambda u: ripple(u) - 0.0199, degree=1)
    verdict = _verdict(problem, _run(problem), "ripple")
    assert verdict.verdict == "undecided"
    assert verdict.proved_fraction > 0.5


def test_saved_boxes_of_another_problem_are_refused(tmp_path):
    problem = _problem(bowl=bowl)
    save(tmp_path / "boxes", problem, _run(problem))
    with pytest.raises(RunError, match="without --resume"):
        load(tmp_path / "boxes", _problem(bowl=lambda u: bowl(u) + 0.1))


def test_boxes_of_another_layout_are_refused(tmp_path, monkeypatch):
    problem = _problem(bowl=bowl)
    with monkeypatch.context() as older:
        older.setattr(checkpoint, "_KEPT", ("first", "axis", "lower", "alone"))
        save(tmp_path / "boxes", problem, _run(problem))
    with pytest.raises(RunError, match="without --resume"):
        load(tmp_path / "boxes", problem)


def test_refutations_are_saved(tmp_path):
    problem = _problem(sunken=lambda u: bowl(u) - 0.2)
    state = _run(problem)
    save(tmp_path / "boxes", problem, state)
    assert load(tmp_path / "boxes", problem).refuted == state.refuted


@pytest.mark.parametrize(
    ("low", "high"),
    [SQUARE, ((0.0, 0.15), (1.0, 0.15)), ((1.0, 0.0), (1.0, 0.7)), ((0.0,) * 3, (1.0, 0.5, 2.0))],
)
def test_the_leaves_of_a_statement_cover_its_root(low, high):
    problem = _problem(low, high, bowl=lambda u: bowl(u) - 0.0999)
    state = _run(problem)
    wide = list(state.tree.axes)
    assert wide == [k for k, (a, b) in enumerate(zip(low, high, strict=True)) if a < b]
    (statement,) = prove(problem, state)
    lows, highs = [], []
    stack = [(np.array([low]), np.array([high]))]
    for sign in statement.tree:
        box = stack.pop()
        if sign == "-":
            lows.append(box[0][0])
            highs.append(box[1][0])
        else:
            parts = halves(*box, np.array([int(sign)]))
            stack += [(parts[0][k : k + 1], parts[1][k : k + 1]) for k in (1, 0)]
    assert not stack
    sizes = (np.array(highs) - np.array(lows))[:, wide].prod(axis=1)
    assert sizes.sum() == pytest.approx((np.array(high) - np.array(low))[wide].prod())
    lower, _ = problem.bounds(np.array(lows), np.array(highs))
    assert np.all(lower[:, 0] >= statement.bounds["bowl"])
    assert statement.boxes == len(lows)


def test_halves_stand_in_the_order_of_the_format():
    low, high = halves(np.zeros((2, 2)), np.array([[1.0, 2.0], [3.0, 4.0]]), np.array([1, 0]))
    assert low.tolist() == [[0, 0], [0, 1], [0, 0], [1.5, 0]]
    assert high.tolist() == [[1, 1], [1, 2], [1.5, 4], [3, 4]]
    first, axis = np.array([1, 3, -1, -1, -1]), np.array([2, 0, -1, -1, -1])
    assert to_text(first, axis, first < 0) == "20---"
    with pytest.raises(ValueError, match="node 2 open"):
        to_text(first, axis, (first < 0) & (np.arange(5) != 2))


def test_a_half_keeps_what_its_box_knows():
    tree, root = BoxTree.root(*SQUARE, 2), np.zeros(1, int)
    tree = tree.with_bounds(root, np.array([[0.5, np.nan]]), np.array([[0.9, np.nan]]))
    unknown = np.array([[0.2, np.nan]] * 2)
    axis = tree.best_axis(root)
    boxes = tree.halves_of(root, axis)
    tree = tree.with_halves(root, axis, boxes, unknown, unknown + 1.0)
    assert np.all(tree.lower[-2:, 0] == 0.5)
    assert np.all(tree.lower[-2:, 1] == -np.inf)
    assert np.all(tree.upper[-2:, 0] == 0.9)
    assert tree.share(np.ones(len(tree.first), bool)) == 1.0


def test_boxes_that_are_done_take_little_memory():
    """Where the sign alone is asked for; the same search keeps corners of all to raise margins."""
    low, high = (0.0,) * 4, (1.0,) * 4
    problem = replace(_problem(low, high, ripple=ripple), tight=0.0)
    tree = _run(problem).tree
    assert len(tree.first) > 400
    assert np.all(tree.lower[tree.is_leaf] >= 0.0)
    first = np.flatnonzero(tree.is_leaf & (tree.depth <= MOST_AT_START))
    assert set(tree.pending.number) <= set(first)
    assert (tree.nbytes - 32 * 4 * 33) / len(tree.first) < 32
    loose = _run(replace(problem, tight=1e-9)).tree
    assert np.array_equal(loose.first, tree.first) and np.array_equal(loose.lower, tree.lower)
    assert loose.nbytes > 2 * tree.nbytes
    with pytest.raises(KeyError, match="done"):
        tree.halves_of(np.array([len(tree.first) - 1]), np.zeros(1, int))


def test_a_saved_search_has_the_pending_boxes_it_had(tmp_path):
    problem = _problem((0.0,) * 3, (1.0,) * 3, ripple=lambda u: ripple(u) - 0.0199)
    problem = replace(problem, tight=0.0)
    state = start(problem, _confirm(problem))
    state = search(problem, state, _confirm(problem), phase="decide", most=400)
    save(tmp_path / "boxes", problem, state)
    tree, again = state.tree, load(tmp_path / "boxes", problem).tree
    done = np.flatnonzero(tree.is_leaf & ~problem.unfinished(tree.lower))
    ours = tree.pending.take(~np.isin(tree.pending.number, done))
    assert len(ours.number) > 10
    for item in fields(ours):
        np.testing.assert_array_equal(getattr(again.pending, item.name), getattr(ours, item.name))
    every = [np.array(c) for c in zip(*(t.corners for t in (tree, again)), strict=True)]
    for corners in every:
        np.testing.assert_array_equal(corners[0], corners[1])
    both = [
        search(problem, one, _confirm(problem), phase="decide", most=700)
        for one in (state, load(tmp_path / "boxes", problem))
    ]
    np.testing.assert_array_equal(both[0].tree.lower, both[1].tree.lower)


@pytest.mark.parametrize("steep", [0, 1, 2])
def test_the_axis_whose_halving_raises_the_bound_is_halved(steep):
    """A ripple along one axis, a slope along another: the slope costs no box, however steep."""
    flat = (steep + 1) % 3

    def function(u):
        return jnp.cos(25.0 * u[steep]) + 1.001 + 1e3 * (1.0 + u[flat])

    problem = _problem((0.0,) * 3, (1.0,) * 3, rough=lambda u: function(u) - 1e3 * (1.0 + u[flat]))
    cuts = _cuts(_run(problem)).max(axis=0)
    others = [k for k in range(3) if k != steep]
    assert cuts[steep] > max(cuts[others]) + 1
    tilted = _problem((0.0,) * 3, (1.0,) * 3, tilted=function)
    assert len(_run(tilted).tree.first) <= len(_run(problem).tree.first)


def test_a_condition_of_one_point_cannot_be_split():
    problem = _problem((0.3, 0.6), (0.3, 0.6), bowl=bowl, zero=lambda u: 0.1 - bowl(u))
    state = _run(problem)
    assert not missing(problem, state, "decide").any()
    assert _verdict(problem, state, "bowl").verdict == "proved"
    assert _verdict(problem, state, "zero").verdict != "proved"  # Zero to rounding: no margin.


def test_easy_and_hard_conditions_are_stated_apart():
    problem = _problem(easy=lambda u: 1.0 + u[0], hard=lambda u: ripple(u) - 0.015)
    state = _run(problem)
    easy, hard = prove(problem, state)
    assert (easy.conditions, hard.conditions) == (("easy",), ("hard",))
    assert easy.boxes == 1
    assert hard.boxes > 64 * easy.boxes
    assert easy.bounds["easy"] == problem.claimed * state.tree.lower[state.tree.is_leaf, 0].min()


@pytest.mark.parametrize("floor", [0.0, 0.0999, 0.2])
def test_a_file_of_boxes_says_what_the_search_knew(tmp_path, floor):
    """Corners and cuts follow from the halvings; of what is proved only what counts is kept."""
    problem = _problem(bowl=lambda u: bowl(u) - floor)
    state = _run(problem)
    save(tmp_path / "boxes", problem, state)
    tree = load(tmp_path / "boxes", problem).tree
    decided = floor < 0.1
    for name in ("low_corner", "high_corner", "first", "axis", "depth", "lower"):
        np.testing.assert_array_equal(getattr(tree, name), getattr(state.tree, name))
    for name in ("number", "low", "high", "cuts", *(("costs",) * (not decided))):
        ours, theirs = (getattr(one.pending, name) for one in (tree, state.tree))
        np.testing.assert_array_equal(ours, theirs)
    assert prove(problem, load(tmp_path / "boxes", problem)) == prove(problem, state)
    with pytest.raises(RunError, match="another gait"):
        load(tmp_path / "boxes", replace(problem, coupled_axes=(CoupledAxes(0, 1, 0.5),)))


def test_nothing_is_asked_where_axes_are_not_near():
    """A margin that is negative off the diagonal holds where the axes are near each other."""
    problem = _problem(near=lambda u: 0.3 - (u[0] - u[1]) ** 2)
    assert _run(problem).refuted
    near = replace(problem, coupled_axes=(CoupledAxes(0, 1, 0.5),))
    state = _run(near)
    (statement,) = prove(near, state)
    assert not state.refuted and 0.0 <= statement.bounds["near"] <= 0.05
    assert float(state.smallest[0]) >= 0.05 - 1e-12


@pytest.mark.parametrize(("weak", "ended"), [(1, False), (2, True)])
def test_boxes_have_an_end_where_most_axes_are_weak(weak, ended, monkeypatch):
    """One weak axis among others, as of a belief, does not end a search that goes on."""

    def margin(u):
        return 1e-3 + jnp.tanh(u[0] - u[1]) ** 2 + 0.0 * jnp.sum(u)

    low, high = ((0.0,) * 3, (1.0,) * 3)
    problem = replace(_problem(low, high, margin=margin, degree=1), weak_axes=weak, tight=0.0)
    monkeypatch.setattr(root_turns, "WEAK_BOXES", 100)
    state = _run(problem)
    assert bool(to_split(problem, state, "decide", 10**6).size) == ended


@pytest.mark.parametrize(("weak", "one_by_one"), [(1e-4, False), (0.3, True)])
def test_weak_axes_are_measured_one_by_one_only_where_together_they_cost_much(weak, one_by_one):
    def margin(u):
        curve = jnp.sin(6.0 * u[0]) + weak * (jnp.sin(6.0 * u[2]) + jnp.sin(6.0 * u[3]))
        return 1.01 + 2.0 * weak + curve + 1e-3 * u[1]

    problem = replace(_problem((0.0,) * 4, (1.0,) * 4, margin=margin), weak_axes=2)
    widths = []

    def bound_all(asked, batches):
        widths.extend(high - low for low, high in batches)
        yield from bound_here(asked, batches)

    search(
        problem,
        Search.untouched(problem),
        _confirm(problem),
        phase="decide",
        most=10**5,
        bound_all=bound_all,
    )
    wide = np.concatenate(widths) > 0.0
    alone = (wide.sum(axis=1) == 1) & wide[:, 2:].any(axis=1)
    assert alone.any() == one_by_one


@pytest.mark.parametrize("late", [0, 2])
@pytest.mark.parametrize(("weak", "halved"), [(1e-4, {0}), (0.3, {0, 2, 3})])
def test_what_costs_bounds_is_halved(late, weak, halved):
    """Along the curved axis; along others only where they cost about as much."""

    def margin(u):
        curve = jnp.sin(6.0 * u[0]) + weak * (jnp.sin(6.0 * u[2]) + jnp.sin(6.0 * u[3]))
        return 1.01 + 2.0 * weak + curve + 1e-3 * u[1]

    problem = replace(_problem((0.0,) * 4, (1.0,) * 4, margin=margin), weak_axes=late)
    # What every search begins with is left out: it halves axes in turn.
    state = search(
        problem, Search.untouched(problem), _confirm(problem), phase="decide", most=10**5
    )
    assert prove(problem, state)
    assert {int(axis) for axis in state.tree.axis[state.tree.axis >= 0]} == halved
