"""Runs are traced once for all tests of a process that read the same bytes."""

import functools
import hashlib
import importlib
import json
import os
import sys
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

from neuralgaits._families import FAMILIES, verbs_module
from neuralgaits.certificate.chart import PLANE_ONLY, Chart
from neuralgaits.certificate.proof_file.theorem_tables import Theorems
from neuralgaits.certificate.run_certificate import retrace
from neuralgaits.errors import InputError, NeuralGaitsError
from neuralgaits.records.training_config import config_of
from neuralgaits.runs import RunFolder
from neuralgaits.runs.names import CONFIG, GAIT, RESIDUAL, ROBOT, SPEC, START, WEIGHTS
from support.kept_results import is_a_size

READ = frozenset((CONFIG, GAIT, RESIDUAL, ROBOT, SPEC, START, WEIGHTS))
"""Files of a run that it is opened from, if its spec is built in."""
UNINVOLVED = tuple(
    f"neuralgaits.{room}."
    for room in ("cli", "export", "report", "simulation", "training", "viewer", "workflows")
)
"""Rooms whose modules no trace of a built-in spec imports."""
_WRITES = frozenset(("fsync", "replace"))
"""Functions of `os` that only those call who write files, which no trace does."""
_PROBLEMS = "neuralgaits.certificate.levels.problems"
Key = tuple[str, ...]


class TracedOnce:
    """What a proof is compared with, as `retrace` finds it, kept by content.

    A result is a function of the files in the run's folder that tracing reads (not those of the
    certificate, which is compared with it), of the theorems and of the chart. Where a byte of any
    of these is changed, the run is traced again. A result is kept as JSON, and each caller reads it
    anew. Errors are not kept.

    A built-in spec, and a family's run, is traced in this process, whoever asks: tests compare that
    with what a process of its own finds.

    Attributes:
        trusted: whether the program is as it was written. If not, each run is traced.
        traced: count of runs that were traced.
    """

    def __init__(self, shared: Path | None = None) -> None:
        """Start with no result of this process, and those that others keep in a shared folder."""
        self.trusted = True
        self.traced = 0
        self._known: dict[Key, str] = {}
        self._shared = shared

    def retrace_in_subprocess(
        self, run: Path, theorems: Theorems, chart: Chart = PLANE_ONLY
    ) -> dict[str, Any]:
        """Return what the function of this name in `retrace` does."""
        return self._once("retrace_in_subprocess", run, theorems, chart)

    def here_if_built_in(
        self, run: Path, theorems: Theorems, chart: Chart = PLANE_ONLY
    ) -> dict[str, Any]:
        """Return what the function of this name in `retrace` does."""
        return self._once("here_if_built_in", run, theorems, chart)

    def distrusting(self, name: str) -> Callable[..., None]:
        """Return the method of `pytest.MonkeyPatch` of this name, after which no run is trusted.

        A patch of what no trace of a built-in spec calls changes no result.
        """
        change = getattr(pytest.MonkeyPatch, name)

        @functools.wraps(change)
        def changed(patch: pytest.MonkeyPatch, *given: Any, **how: Any) -> None:
            if not _uninvolved(*given):
                self.trusted = False
            change(patch, *given, **how)

        return changed

    def _once(self, name: str, run: Path, theorems: Theorems, chart: Chart) -> dict[str, Any]:
        trace = getattr(retrace, name)
        if not self.trusted or _replaced():
            self.traced += 1
            return trace(run, theorems, chart)
        if (describe := _description_of(run)) is not None:
            name, trace = "describe_run", describe
        key = name, json.dumps([theorems.tables(), chart.table()]), *_contents(run)
        if key not in self._known:
            self._known[key] = self._read_or_traced(key, lambda: trace(run, theorems, chart))
        return json.loads(self._known[key])

    def _read_or_traced(self, key: Key, trace: Callable[[], Any]) -> str:
        """Return a result as JSON: that of another process, or a new one that others may read."""
        digest = hashlib.sha256(json.dumps(key).encode()).hexdigest()
        kept = None if self._shared is None else self._shared / f"traced-{digest}.json"
        if kept is not None and kept.exists():
            return kept.read_text(encoding="utf-8")
        self.traced += 1
        text = json.dumps(trace())
        if kept is not None:
            # Whole or not there, whoever else writes the same.
            written = kept.with_suffix(f".{os.getpid()}")
            written.write_text(text, encoding="utf-8")
            written.rename(kept)
        return text


def _uninvolved(target: Any, *given: Any) -> bool:
    """Return whether a patch, by the arguments of `setattr`, changes what no trace calls."""
    if isinstance(target, str):
        target, _, name = target.rpartition(".")
        target = sys.modules.get(target)
    else:
        name = given[0] if given else None
    if not isinstance(target, ModuleType):
        return False
    place = target.__name__
    return (
        place.startswith(UNINVOLVED) or is_a_size(place, name) or (target is os and name in _WRITES)
    )


def _contents(run: Path) -> Key:
    """Return all of a run that tracing it may read: names, and sha256 of contents.

    Code of a user's spec may read any file but those of the certificate. A built-in spec is opened
    from the files of READ, and from whether there are others beside them.
    """
    own_code = not _is_built_in(run)
    found = []
    for path in sorted(run.rglob("*") if own_code else run.iterdir()):
        if not path.is_file() or path.parent == run / "certificate":
            continue
        read = own_code or path.name in READ
        digest = hashlib.sha256(path.read_bytes()).hexdigest() if read else ""
        found.append(f"{path.relative_to(run)} {digest}")
    return tuple(found)


def _is_built_in(run: Path) -> bool:
    """Return whether a run's spec is the package's; not where the run cannot tell."""
    from neuralgaits.barriers import specs  # Brings JAX.

    try:
        return specs.is_built_in(config_of(RunFolder.open(run)).spec)
    except NeuralGaitsError:
        return False


def _description_of(run: Path) -> Callable[..., retrace.RunDescription] | None:
    """Return what `retrace_in_subprocess` has another process call; None if a user's code is."""
    try:
        family = RunFolder.open(run).config.get("family")
    except NeuralGaitsError:
        return None
    if family not in FAMILIES:
        return retrace.describe_run if _is_built_in(run) else None
    from neuralgaits.systems.family_retrace import describe_family_run  # Brings JAX.

    system = importlib.import_module(verbs_module(family)).SYSTEM

    def describe(run: Path, theorems: Theorems, chart: Chart) -> retrace.RunDescription:
        del theorems, chart
        try:
            return describe_family_run(system, run)
        except NeuralGaitsError as error:
            raise InputError(str(error)) from None  # As from another process.

    return describe


def _replaced() -> bool:
    """Whether a test has put a function of its own in place of one that traces."""
    places = [(retrace, name) for name in ("retrace_in_subprocess", "here_if_built_in")]
    if _PROBLEMS in sys.modules:  # It brings JAX: until it is imported, nobody has replaced it.
        places.append((sys.modules[_PROBLEMS], "trace_certificate"))
    found = [(module, name, getattr(module, name)) for module, name in places]
    return any((one.__module__, one.__name__) != (module.__name__, n) for module, n, one in found)
