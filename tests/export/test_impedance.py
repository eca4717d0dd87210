"""Targets of drives in exported C: at the reading they give the torques of the tick."""

import subprocess
from pathlib import Path

import pytest

from neuralgaits.export import build
from neuralgaits.export.source import gait_files
from support.compiled import folder_with
from support.designs import LAWS, design_for

MAIN = Path(__file__).with_name("impedance_main.c")


@pytest.mark.parametrize("robot", ["amber3m", "rabbit", "amber3m-feet"])
def test_a_drive_gives_the_torque_of_its_tick(robot, tmp_path):
    laws = {name: law for name, law in LAWS.items() if name != "paper"}
    files = gait_files(design_for(robot, laws)) | {MAIN.name: MAIN.read_text()}
    folder = folder_with(tmp_path / "c", files)
    program = build.build("gcc", folder, "impedance", (*build.CORE, MAIN.name), ("-O1",))
    done = subprocess.run([str(program)], capture_output=True, check=True, text=True)
    walked, at, beside, outputs, fault = map(float, done.stdout.split())
    assert 1000 < walked < 2000
    assert max(at, beside) < 1e-9
    assert outputs < 1e-12
    assert fault == 0.0
