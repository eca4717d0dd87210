"""The command that repeats a simulation has every setting that its walks depend on."""

import shlex
import shutil
from dataclasses import dataclass, fields
from typing import Annotated

import pytest

from neuralgaits.analysis.run import open_run
from neuralgaits.cli.argv_parser import read
from neuralgaits.records.simulated import SimulationSummary
from neuralgaits.report.page import repeat_commands
from neuralgaits.report.page.repeat_commands import IN_DISTURB, NOT_REPEATED, simulating
from neuralgaits.settings import SimulateSettings
from neuralgaits.settings.options import arg
from neuralgaits.workflows.simulate import simulate
from support.shipped_run import SHIPPED


@dataclass(frozen=True)
class ShadedSettings(SimulateSettings):
    """Settings of `simulate` with one more."""

    shade: Annotated[int | None, arg(metavar="N")] = None
    """Darkness of the robot."""


@dataclass(frozen=True, eq=False, kw_only=True)
class ShadedSummary(SimulationSummary):
    """Summary that records it."""

    shade: int | None = None


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    return open_run(shutil.copytree(SHIPPED, tmp_path_factory.mktemp("walked") / "run"))


@pytest.fixture(scope="module")
def walked(run):
    drives = {"gains": (300.0, 5.0), "drive_rate": 4000.0}
    return simulate(run, steps=1, push=2.0, sensing="encoders,bits=12", **drives).summary


def test_a_new_setting_is_repeated_if_it_is_recorded(run, walked, monkeypatch):
    monkeypatch.setattr(repeat_commands, "SimulateSettings", ShadedSettings)
    values = {one.name: getattr(walked, one.name) for one in fields(SimulationSummary)}
    line = simulating(run.folder, ShadedSummary(**values, shade=3), run.path)
    assert line is not None and "--shade 3" in line
    line = simulating(run.folder, ShadedSummary(**values), run.path)
    assert line is not None and "--shade" not in line
    with pytest.raises(AttributeError, match="shade"):
        simulating(run.folder, walked, run.path)


def test_what_is_left_out_are_settings():
    assert {one.name for one in fields(SimulateSettings)} >= NOT_REPEATED | IN_DISTURB


def test_the_repeated_walk_has_the_same_drives_and_sensors(run, walked):
    line = simulating(run.folder, walked, run.path)
    assert line is not None and not any(f"--{name}" in line for name in IN_DISTURB)
    again = read(shlex.split(line)[1:])
    assert isinstance(again, SimulateSettings) and again.push == 2.0 and again.steps == 1
    repeated = simulate(run, steps=again.steps, push=again.push, disturb=again.disturb).summary
    assert repeated.disturb == walked.disturb and repeated.sensing == walked.sensing
    assert repeated.max_output_error_rad == walked.max_output_error_rad
