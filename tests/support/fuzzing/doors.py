"""The doors of the program: what each verb does with the files that are given to it."""

import contextlib
import fnmatch
import functools
import hashlib
import zlib
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib import pyplot

from neuralgaits import logs
from neuralgaits.analysis import gait_data, residual_data
from neuralgaits.analysis import run as runs
from neuralgaits.analysis.learned import LearnedResiduals
from neuralgaits.analysis.run import config_of, open_run
from neuralgaits.barriers import specs
from neuralgaits.certificate.chart import Chart
from neuralgaits.certificate.proof_file.check import check, in_words
from neuralgaits.certificate.proof_file.reader import InconsistentError, read_claims
from neuralgaits.certificate.proof_file.run_match import differences
from neuralgaits.certificate.proof_file.theorem_tables import Theorems
from neuralgaits.certificate.run_certificate import retrace, verified_summary
from neuralgaits.certificate.run_certificate.verified_summary import read_certificate
from neuralgaits.certificate.search.checkpoint import load, open_boxes
from neuralgaits.episode_rounds.episode_folder import EpisodeFolder
from neuralgaits.errors import InputError
from neuralgaits.report import run_figures, shown_walk
from neuralgaits.report.certificate import certificate_of
from neuralgaits.report.page.closing import missing_parts
from neuralgaits.report.page.document import document
from neuralgaits.report.page.saved import Contents
from neuralgaits.robots import load_robot
from neuralgaits.robots.mjcf.loader import robot_from_text
from neuralgaits.runs import read_arrays, resolve, to_json
from neuralgaits.runs.names import ROBOT, STATE
from neuralgaits.settings import TrainSettings
from neuralgaits.viewer.sureness import how_sure
from neuralgaits.workflows import episodes as rounds
from neuralgaits.workflows import (
    fit,
    report,
    train,
)
from neuralgaits.workflows.check_proof import check_proof
from neuralgaits.workflows.export import _origin
from neuralgaits.workflows.inspect import inspect
from neuralgaits.workflows.report import saved_of
from support.fuzzing.place import EPISODES, FILES, RUN, Place

RARELY = 20
"""One input in so many is drawn where drawing takes long."""
Reader = Callable[[Place, Path], Any]
_COMPUTE = gait_data.compute
LEAVES = 200
"""Proofs of more boxes are read and compared, and their boxes not bounded again: that takes s."""


def check_file(place: Place, path: Path) -> None:
    """`check-proof FILE`."""
    claims = read_claims(path)
    try:
        leaves = sum(len(one.leaves()[0]) for one in claims.statements)
    except InconsistentError:
        leaves = 0
    if leaves <= LEAVES:
        to_json(check_proof(path)).encode()
        return
    to_json([line for one in claims.statements for line in in_words(one, claims)]).encode()
    check(replace(claims, program_hash="another"))
    differences(claims, place.root / RUN)


def inspect_file(place: Place, path: Path) -> None:
    """`inspect FILE`."""
    to_json(inspect(load_robot(path))).encode()


def fit_file(place: Place, path: Path) -> None:
    """`fit RUN LOG`, up to where it learns."""
    read, _ = logs.read_all([path], place.robot)
    cut = logs.cut(read, place.robot)
    long, _ = fit._long_enough(cut.strides)
    parts = fit._dealt(long, 0, cut.left_out, sum(map(len, read)))
    fit._windows(parts.train)
    fit._scale(place.run, long)


def use_spec(place: Place, path: Path) -> None:
    """`train --spec FILE.py:NAME`, up to where it trains."""
    spec = specs.load(f"{path}:brief", place.robot)
    to_json(spec.describe()).encode()


def open_whole(place: Place, path: Path) -> None:
    """What `simulate`, `certify`, `export`, `view` and others begin with."""
    run = open_run(place.root / RUN)
    to_json([run.summary, run.learned is None, run.zero_dynamics.robot.name]).encode()


def page_of(name: str) -> Reader:
    """`report RUN`, apart from pictures and a new walk."""

    def write(place: Place, path: Path) -> None:
        folder = resolve(place.root / name, finished=False)
        config_of(folder)
        saved = saved_of(folder)
        robot = inspect(robot_from_text(folder.copy(ROBOT), folder.config["robot"]))
        walk, why = _kept_walk(place.root / name) if folder.finished else (None, "none")
        contents = Contents(saved, robot, walk, why, [], ("one",))
        document(contents).encode()
        to_json([list(missing_parts(contents)), saved.damaged]).encode()

    return write


page = page_of(RUN)
page_of_round = page_of(f"{EPISODES}/round-1")


def _kept_walk(path: Path) -> tuple[Any, str | None]:
    run = open_run(path)
    kept = shown_walk.kept_walk(run, shown_walk.request_of(run))
    return kept, "walked anew" if kept is None else None


def pictures(*names: str, rare: bool = False) -> Reader:
    """Figures of `report RUN`; if `rare`, drawn of some inputs, and their data read of all."""
    chosen = [make for name, _, make in run_figures.MAKERS if name in names]

    def draw(place: Place, path: Path) -> None:
        run = open_run(place.root / RUN)
        source = run_figures.RunFigures(run, certificate_of(run))
        if rare:
            _ = source.walk
        if "residual-field" in names:
            with _instead(gait_data, compute=lambda run: _computed(place)):
                residual_data.residual_data(source.run)
        if rare and zlib.crc32(path.read_bytes()) % RARELY:
            return
        with _instead(gait_data, compute=lambda run: _computed(place)):
            for make in chosen:
                with contextlib.suppress(run_figures.Absent):
                    make(source)
        pyplot.close("all")

    return draw


def _computed(place: Place) -> dict[str, np.ndarray]:
    """What would take seconds to compute again, and depends on no altered file's form."""
    kept = place.kept / RUN / gait_data.FILE
    return read_arrays(kept)[0] if kept.is_file() else _COMPUTE(place.run)


@contextlib.contextmanager
def _instead(module: Any, **functions: Callable[..., Any]) -> Iterator[None]:
    """Put functions in the places of others for a while."""
    kept = {name: getattr(module, name) for name in functions}
    try:
        for name, function in functions.items():
            setattr(module, name, function)
        yield
    finally:
        for name, function in kept.items():
            setattr(module, name, function)


def remember() -> None:
    """Read robots and proofs of the same bytes once, and trace runs: of each case one file is new.

    For processes that do nothing else, since it holds to their end.
    """
    robot = functools.lru_cache(64)(robot_from_text)
    claims = functools.lru_cache(64)(lambda path, content: read_claims(path))
    runs.robot_from_text = report.robot_from_text = robot
    verified_summary.read_claims = lambda path: claims(path, path.read_bytes())
    traced, trace = dict[str, retrace.RunDescription](), retrace.describe_run

    def traced_once(run: Path, theorems: Theorems, chart: Chart) -> retrace.RunDescription:
        files = [one for one in sorted(run.iterdir()) if one.is_file()]
        contents = [(one.name, hashlib.sha256(one.read_bytes()).hexdigest()) for one in files]
        key = to_json([contents, theorems.tables(), chart.table()])
        if key not in traced:
            traced[key] = trace(run, theorems, chart)
        return traced[key]

    retrace.describe_run = traced_once


def resume_training(place: Place, path: Path) -> None:
    """`train ROBOT --resume RUN`, up to where it goes on: the run counts as unfinished."""
    summary = place.root / RUN / "summary.json"
    away = summary.rename(summary.with_suffix(".away"))
    try:
        settings = TrainSettings(place.robot, resume=place.root / RUN, root=place.root)
        train._resumed(settings, place.root / RUN).folder.read_metrics()
    finally:
        away.rename(summary)


def read_state(place: Place, path: Path) -> None:
    """The checkpoint that `train --resume` goes on from."""
    resolve(place.root / RUN).read_tree(STATE, place.state)


def resume_proof(place: Place, path: Path) -> None:
    """`certify RUN --resume`, up to where it goes on."""
    number = int(path.stem.rpartition("-")[2])
    search = load(path, place.problems[number])
    open_boxes(path)
    search.tree.is_leaf.sum()


def read_residual(place: Place, path: Path) -> None:
    """`refine RUN`, up to where it trains."""
    LearnedResiduals.read(path, place.robot.n - 1)


def sure(place: Place, path: Path) -> None:
    """What a live page says of the proof."""
    how_sure(open_run(place.root / RUN)).words.encode()


def design(place: Place, path: Path) -> None:
    """`export RUN`, up to where it writes."""
    run = open_run(place.root / RUN)
    _origin(run, read_certificate(run.folder))


def latest(place: Place, path: Path) -> None:
    """`latest` in place of a run."""
    resolve("latest", place.root)


def go_on_with_episodes(place: Place, path: Path) -> None:
    """`episodes ROBOT --resume DIR`; what would train, walk or learn anew counts as refused."""

    def stop(*_: Any, **__: Any) -> Any:
        raise InputError("done anew")

    anew: dict[str, Callable[..., Any]] = dict.fromkeys(
        ("train", "refine", "fit", "walk_round"), stop
    )
    # These take half a second each, and read no file but the summary.
    anew["nominal_momentum"] = lambda run: 18.0
    if zlib.crc32(path.read_bytes()) % RARELY:
        anew["draw_file"] = lambda summary, figure: to_json(summary)
    with _instead(rounds, **anew):
        done = rounds.episodes(place.robot, resume=place.root / EPISODES, root=place.root)
    to_json(done.summary).encode()


def find_episodes(place: Place, path: Path) -> None:
    """Which robot a run's own round walked on."""
    EpisodeFolder.find(place.root / EPISODES, place.root)


_CERTIFICATE = (
    page,
    sure,
    design,
    pictures("return-map", "full-order-set", "margins-orbit", rare=True),
)
_DOORS: dict[str, tuple[Reader, ...]] = {
    f"{FILES}/*.json": (check_file,),
    f"{FILES}/*.xml": (inspect_file,),
    f"{FILES}/*.csv": (fit_file,),
    f"{FILES}/*.py": (use_spec,),
    f"{RUN}/config.json": (open_whole, page, resume_training),
    f"{RUN}/summary.json": (open_whole, page, design),
    f"{RUN}/metrics.csv": (page, pictures("loss"), resume_training),
    f"{RUN}/policy.safetensors": (open_whole, page),
    f"{RUN}/robot.xml": (open_whole, page, resume_training),
    f"{RUN}/spec.py": (open_whole, page),
    f"{RUN}/state.safetensors": (read_state,),
    f"{RUN}/certificate/summary.json": _CERTIFICATE,
    f"{RUN}/certificate/proof.json": (check_file, *_CERTIFICATE),
    f"{RUN}/certificate/map.safetensors": (pictures("certificate-map"),),
    f"{RUN}/certificate/boxes-*.safetensors": (resume_proof,),
    f"{RUN}/simulation/summary.json": (page, pictures("walk-tiles", rare=True)),
    f"{RUN}/simulation/walk.csv": (pictures("walk-tiles", "stride", rare=True),),
    f"{RUN}/residual/summary.json": (page, pictures("residual-field", rare=True)),
    f"{RUN}/residual/residual.safetensors": (
        read_residual,
        page,
        pictures("residual-field", rare=True),
    ),
    f"{RUN}/figures/data.safetensors": (pictures("phase-portrait", "return-map", rare=True),),
    f"{RUN}/figures/residual.safetensors": (pictures("residual-field", rare=True),),
    f"{RUN}/report/walk.json": (page,),
    f"{EPISODES}/episodes.json": (go_on_with_episodes, find_episodes, page_of_round),
    f"{EPISODES}/summary.json": (go_on_with_episodes, page_of_round),
    f"{EPISODES}/*.xml": (go_on_with_episodes, find_episodes),
    f"{EPISODES}/round-?/walks/summary.json": (go_on_with_episodes, page_of_round),
    f"{EPISODES}/round-?/residual/summary.json": (go_on_with_episodes,),
    f"{EPISODES}/round-?/config.json": (go_on_with_episodes, page_of_round),
    f"{EPISODES}/round-?/summary.json": (go_on_with_episodes,),
    f"{EPISODES}/round-?/*.safetensors": (go_on_with_episodes,),
    "latest": (latest,),
}
KINDS = {
    "proof files": (f"{FILES}/*.json", f"{RUN}/certificate/*.json"),
    "run folders": (f"{RUN}/*", "latest", f"{EPISODES}/*"),
    "robot files": (f"{FILES}/*.xml",),
    "logs": (f"{FILES}/*.csv",),
    "spec files": (f"{FILES}/*.py",),
}
"""What is altered, by the kind of input."""


def readers(name: str) -> tuple[Reader, ...]:
    """Who reads an input."""
    for pattern, found in _DOORS.items():
        if fnmatch.fnmatch(name, pattern) and name.count("/") == pattern.count("/"):
            return found
    return ()


def inputs(place: Place, kind: str) -> Iterator[str]:
    """Inputs of a kind that somebody reads."""
    for name in place.names:
        if any(fnmatch.fnmatch(name, pattern) for pattern in KINDS[kind]) and readers(name):
            yield name
