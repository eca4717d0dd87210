"""Engines: the same answers from all of them, and what becomes of tasks that fail or die."""

import importlib.util
import itertools
import os
import sys
from contextlib import closing
from pathlib import Path
from types import SimpleNamespace

import pytest

from neuralgaits.engine import Job, Processes, Serial, WorkerPool, worker_pool_for
from neuralgaits.engine.carry import differing, versions
from neuralgaits.engine.on_ray import OnRay
from neuralgaits.errors import InputError
from support import engine_tasks as tasks

NO_RAY = importlib.util.find_spec("ray") is None


@pytest.fixture(scope="module", params=["serial", "processes", "ray"])
def engine(request: pytest.FixtureRequest):
    if request.param == "ray" and NO_RAY:
        pytest.skip("the extra `ray` is not installed")
    makers = {
        "serial": Serial,
        "processes": lambda: Processes(2),
        "ray": lambda: worker_pool_for(2, "local"),
    }
    with pytest.MonkeyPatch.context() as patch:
        # Ray's workers have their own path, and the tasks of these tests are in no package.
        patch.setenv("PYTHONPATH", os.pathsep.join(sys.path))
        with makers[request.param]() as one:
            yield one


def _jobs(count: int):
    return (Job(str(n), {"n": n}, {"b": b"own"}) for n in range(count))


def test_every_job_is_done_once_with_its_own_files_and_those_of_all(engine: WorkerPool) -> None:
    done = list(engine.map(tasks.echo, _jobs(7), common={"a": b"all "}))
    assert {one.name: one.files for one in done} == {
        str(n): {"out": b"all own" + str(n).encode()} for n in range(7)
    }
    assert all(one.failure is None and one.tries == 1 for one in done)
    # What one map was given, the next has not.
    (alone,) = engine.map(tasks.echo, _jobs(1))
    assert alone.files == {"out": b"own0"}


def test_a_task_that_fails_says_why_in_one_line_and_the_others_go_on(engine: WorkerPool) -> None:
    done = {one.name: one for one in engine.map(tasks.refuses_odd, _jobs(6))}
    assert [done[str(n)].files.get("n") for n in (0, 2)] == [b"0", b"2"]
    refused = done["3"].failure
    assert refused == ("refused", "expected an even number, found 3")
    defect = done["4"].failure
    assert defect is not None and defect.kind == "defect"
    assert defect.reason.startswith("ZeroDivisionError: of four (engine_tasks.py:")


def test_a_task_whose_worker_dies_is_tried_again_and_given_up_at_last(
    engine: WorkerPool, tmp_path: Path
) -> None:
    if isinstance(engine, Serial):
        pytest.skip("it has no worker but this process")
    jobs = [
        Job(str(n), {"n": n, "times": times, "folder": str(tmp_path)})
        for n, times in enumerate((0, 2, 9, 0))
    ]
    done = {one.name: one for one in engine.map(tasks.dies, jobs)}
    assert [done[name].files for name in "013"] == [{"n": n} for n in (b"0", b"1", b"3")]
    assert done["1"].tries == 3
    lost = done["2"].failure
    assert lost is not None and lost.kind == "lost" and "died" in lost.reason


def test_jobs_are_taken_as_workers_become_free(engine: WorkerPool) -> None:
    taken = itertools.count()

    def endless():
        for n in taken:
            yield Job(str(n), {"n": n})

    with closing(engine.map(tasks.echo, endless())) as done:
        for _ in range(20):
            next(done)
    assert next(taken) <= 20 + 4 * engine.workers


def test_a_worker_has_one_thread() -> None:
    with Processes(1) as one:
        (done,) = one.map(tasks.about_itself, [Job("itself", {})])
    assert done.files["cores"] == b"1"


def test_a_task_that_wants_more_memory_than_its_worker_may_have_says_so() -> None:
    with Processes(1, memory_bytes=2**29) as one:
        done = list(one.map(tasks.hungry, [Job(str(n), {"bytes": n}) for n in (2**30, 2**20)]))
    lost = done[0].failure
    assert lost is not None and lost.kind == "lost" and "memory" in lost.reason
    assert done[1].files == {"bytes": str(2**20).encode()}


def test_a_full_disk_is_the_fault_of_a_worker_and_not_of_the_task(engine: WorkerPool) -> None:
    for done in engine.map(tasks.fills_disk, _jobs(2)):
        assert done.failure is not None and done.failure.kind == "lost"
        assert "a worker found its disk full" in done.failure.reason


def test_a_map_that_is_closed_early_ends_what_is_under_way(tmp_path: Path) -> None:
    jobs = [Job("quick", {"began": str(tmp_path / "a"), "seconds": 0.0})]
    jobs += [Job("for ever", {"began": str(tmp_path / "b"), "seconds": 1e6})]
    with Processes(2) as two, closing(two.map(tasks.sleeps, jobs)) as done:
        assert next(done).name == "quick"


def test_other_versions_are_named() -> None:
    mine = versions()
    assert differing(mine) is None
    found = differing(mine | {"numpy": "1.0"})
    assert found == f"numpy {mine['numpy']} in place of 1.0"


@pytest.mark.parametrize(
    ("workers", "ray", "line"),
    [
        (0, None, "expected at least 1 worker, found 0"),
        (2, "127.0.0.1:6379", "expected --workers or --ray 127.0.0.1:6379, found both"),
        pytest.param(
            None,
            "127.0.0.1:1",
            "expected a Ray cluster at 127.0.0.1:1, found none",
            marks=pytest.mark.skipif(NO_RAY, reason="the extra `ray` is not installed"),
        ),
        pytest.param(
            None,
            "nonsense",
            "expected --ray local, auto or HOST:PORT, found 'nonsense'",
            marks=pytest.mark.skipif(NO_RAY, reason="the extra `ray` is not installed"),
        ),
        pytest.param(
            None,
            "local",
            "expected Ray for --ray, found none",
            marks=pytest.mark.skipif(not NO_RAY, reason="Ray is installed"),
        ),
    ],
)
def test_engines_that_cannot_be_had_are_refused_in_one_line(
    workers: int | None, ray: str | None, line: str
) -> None:
    with pytest.raises(InputError, match="^" + line.replace(".", r"\.")) as refused:
        worker_pool_for(workers, ray)
    assert "\n" not in str(refused.value)


def test_a_local_ray_is_a_new_one_whatever_runs_here(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: dict[str, object] = {}
    monkeypatch.setitem(sys.modules, "ray", SimpleNamespace(init=lambda **how: asked.update(how)))
    OnRay("local", 2)
    assert (asked["address"], asked["num_cpus"]) == ("local", 2)


def test_a_local_ray_that_does_not_start_is_not_told_to_try_another_address(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def init(**how: object) -> None:
        raise RuntimeError("The current node timed out\nduring startup")

    monkeypatch.setitem(sys.modules, "ray", SimpleNamespace(init=init))
    line = (
        r"^expected a Ray of this machine to start, found .*timed out during startup\): try again"
    )
    with pytest.raises(InputError, match=line):
        OnRay("local", 2)


def test_what_ray_says_of_its_nodes_stays_off_stdout(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    ray, worker = (pytest.importorskip(name) for name in ("ray", "ray._private.worker"))

    def a_node_dies() -> str:
        # As Ray's listener tells it.
        said = {"lines": ["a node is gone"], "pid": "raylet", "is_err": False}
        worker.print_to_stdstream(said, ignore_prefix=False)
        return capsys.readouterr().out

    monkeypatch.setattr(worker, "print_to_stdstream", worker.print_to_stdstream)
    monkeypatch.setattr(ray, "init", lambda **how: None)
    assert "a node is gone" in a_node_dies()
    OnRay("local", 1)
    assert not a_node_dies()
