"""True proofs of flat feet, beliefs, speeds, cart-poles and hoppers: what forgeries start from."""

import importlib
import json
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any
from unittest import mock

from neuralgaits._families import verbs_module
from neuralgaits.certificate.chart import Chart
from neuralgaits.certificate.proof_file.theorem_tables import Theorems
from neuralgaits.certificate.run_certificate import retrace
from neuralgaits.errors import InputError, NeuralGaitsError
from neuralgaits.gait.commands import Command
from neuralgaits.runs import RunFolder
from neuralgaits.systems.family_certificate import certify_family
from neuralgaits.systems.family_retrace import describe_family_run
from neuralgaits.systems.family_run import open_family_run
from neuralgaits.workflows.certify import certify
from support.commanded_run import LEANS, SPEED, make
from support.forgeries.base import About, Base, Table
from support.forgeries.quick import Traced, programs_read_once
from support.forgeries.runs import PROOF
from support.own_spec import run_with

OWN = """
from dataclasses import replace

from neuralgaits.barriers import Box, Pointwise, functions as f, specs
from neuralgaits.gait.commands import Command


def mine(robot):
    spec = specs.commanded(robot, (Command(COMMAND),))
    inertia = Pointwise("inertia", "guard", 10.0, f.at_least(f.transversal_inertia, 1.0))
    impulse = Pointwise("impulse", "guard", 10.0, f.at_least(f.normal_impulse, 0.5))
    return replace(spec, name="mine", conditions=(inertia, impulse), weights={}, aims=(),
                   regions={"guard": (Box((1.0, 0.0), (1.0, 1.0)),)},
                   recipe=replace(spec.recipe, samples={"guard": 4}))
"""
"""A spec of two conditions that both checkers know."""


def systems(scratch: Path, feet: Path, cartpole: Path, hopper: Path) -> Base:
    """Certify a run of each kind in a new folder.

    Args:
        scratch: the folder.
        feet: a trained run on flat feet.
        cartpole: a run of a cart-pole.
        hopper: one of a hopper.
    """
    runs: dict[About, Path] = {
        "belief": told(scratch / "belief", LEANS),
        "speeds": told(scratch / "speeds", SPEED),
    }
    given: dict[About, Path] = {"feet": feet, "cartpole": cartpole, "hopper": hopper}
    for about, run in given.items():
        runs[about] = Path(shutil.copytree(run, scratch / about))
    assert certify(runs["feet"]).verdict == "proved"
    for name in ("cartpole", "hopper"):
        assert certify_family(open_family_run(_system(name), runs[name])).verdict == "proved"
    proofs: dict[About, Table] = {
        about: json.loads((runs[about] / PROOF).read_text()) for about in runs
    }
    return Base(proofs, runs, scratch)


def told(folder: Path, command: Command) -> Path:
    """A run of the family around the shipped gait that is told a command, proved to level 1."""
    family = make(folder.with_name(f"{folder.name}-family"), command)
    config = json.loads((family.path / "config.json").read_text())
    # A user's own spec brings its commands itself.
    (family.path / "config.json").write_text(json.dumps(config | {"commands": {}}))
    numbers = f"{command.name!r}, {command.low!r}, {command.high!r}, {command.largest_change!r}"
    run = run_with(family, folder, OWN.replace("COMMAND", numbers))
    assert certify(run, level=1).verdict == "proved"
    return run


@contextmanager
def systems_traced_once(known: Traced) -> Iterator[None]:
    """Each run is traced in this process, once for every chart and theorem."""

    def here(run: Path, theorems: Theorems, chart: Chart) -> dict[str, Any]:
        key = (str(run), repr(theorems), repr(chart))
        if key not in known:
            known[key] = _described(run, theorems, chart)
        if "error" in known[key]:
            raise InputError(known[key]["error"])
        return known[key]

    with programs_read_once(known), mock.patch.object(retrace, "retrace_in_subprocess", here):
        yield


def _described(run: Path, theorems: Theorems, chart: Chart) -> dict[str, Any]:
    """What the process that traces a run answers."""
    family = RunFolder.open(run).config.get("family")
    try:
        if family is not None:
            found = describe_family_run(_system(family), run)
        else:
            found = retrace.describe_run(run, theorems, chart)
    except (NeuralGaitsError, OSError) as error:
        return {"error": str(error)}
    return json.loads(json.dumps(found))


def _system(family: str) -> Any:
    return importlib.import_module(verbs_module(family)).SYSTEM
