"""Boxes bounded by workers: the tree of a search is the same, bit for bit, whoever bounds them."""

from collections.abc import Generator, Iterable
from dataclasses import fields, replace

import jax.numpy as jnp
import numpy as np
import pytest

from neuralgaits.certificate.search import root_turns
from neuralgaits.certificate.search.problem import Problem
from neuralgaits.certificate.search.root_turns import explore
from neuralgaits.certificate.search.shared_bounds import SharedBounds, from_json, to_json
from neuralgaits.engine import Failure, Files, Job, Processes, Serial, TaskResult, WorkerPool
from neuralgaits.engine.task import Task
from neuralgaits.programs.tracing.tracer import trace


def _problem(axes: int = 2) -> Problem:
    def margins(u):
        curve = jnp.tanh(3.0 * (u[0] - 0.4 * jnp.tanh(u[1])))
        return {"ripple": 2e-4 + curve**2, "rest": jnp.sum(u) + 0.01}

    low, high = (0.0,) * axes, (1.0,) + (0.9,) * (axes - 1)
    program = trace(margins, {"u": (axes,)})
    return Problem("square", low, high, ("ripple", "rest"), (1.0, 0.1), program, degree=1)


class Backwards(WorkerPool):
    """Gives what it has done in the opposite order, and loses every third job."""

    name = "backwards"

    @property
    def workers(self) -> int:
        return 3

    def map(
        self, task: Task, jobs: Iterable[Job], *, common: Files | None = None
    ) -> Generator[TaskResult, None, None]:
        done = list(Serial().map(task, jobs, common=common))
        for number, one in enumerate(reversed(done)):
            lost = number % 3 == 2
            yield one._replace(files={}, failure=Failure("lost", "gone")) if lost else one

    def close(self) -> None:
        """Nothing to close."""


def _tree(problem: Problem, engine: WorkerPool | None):
    bound_all = None if engine is None else SharedBounds(engine)
    (state,) = explore([problem], [None], lambda name, u: None, bound_all=bound_all)
    return state.tree


@pytest.mark.parametrize("kind", ["serial", "backwards", "processes"])
def test_the_tree_is_the_same_whoever_bounds_its_boxes(kind: str) -> None:
    problem = _problem()
    alone = _tree(problem, None)
    # Rounds of several batches, or there is nothing to share.
    assert len(alone.first) > 8 * problem.batch
    makers = {"serial": Serial, "backwards": Backwards, "processes": lambda: Processes(2)}
    with makers[kind]() as engine:
        shared = _tree(problem, engine)
    for one, other in ((shared, alone), (shared.pending, alone.pending)):
        for item in fields(one):
            if item.name != "pending":
                np.testing.assert_array_equal(getattr(one, item.name), getattr(other, item.name))


def test_turns_do_not_depend_on_the_clock(monkeypatch: pytest.MonkeyPatch) -> None:
    problem = _problem()
    whole = _tree(problem, None)
    monkeypatch.setattr(root_turns, "TURN_BOXES", 64)
    slow = _tree(problem, None)
    share = whole.share(np.all(whole.lower >= 0.0, axis=1))
    assert slow.share(np.all(slow.lower >= 0.0, axis=1)) == share == 1.0


def test_a_problem_is_the_same_after_its_journey() -> None:
    problem = replace(_problem(3), least=(0.0, 1e-17), tight=0.1 + 0.2)
    there = from_json(to_json(problem))
    for item in fields(problem):
        if item.name != "program":
            assert getattr(there, item.name) == getattr(problem, item.name)
    assert there.program.hash == problem.program.hash
