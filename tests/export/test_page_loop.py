"""The main.c of docs/export.md: it compiles as the page says, and the shipped gait runs in it."""

import re
import shlex
import subprocess

import pytest

from neuralgaits.analysis.run import open_run
from neuralgaits.export import output_folder
from neuralgaits.export.source import gait_files
from neuralgaits.workflows import demo
from neuralgaits.workflows.export import design_of
from support import pages

PAGE = pages.ROOT / "docs" / "export.md"
STRICT = ("-Wall", "-Wextra", "-Werror", "-pedantic")
PERIOD = 1e-3
"""Time between two ticks [s]."""


@pytest.fixture(scope="module")
def beside(tmp_path_factory):
    """The exported files of the shipped run, and the page's main.c among them."""
    folder = tmp_path_factory.mktemp("loop")
    files = output_folder.shipped() | gait_files(design_of(open_run(demo.FOLDER)))
    (loop,) = [block.text for block in pages.blocks(PAGE, "c") if "int main" in block.text]
    for name, text in (files | {"main.c": loop}).items():
        (folder / name).write_text(text)
    return folder


@pytest.mark.parametrize("more", [(), ("-DNG_FLOAT",)], ids=["double", "single"])
def test_the_loop_of_the_page_compiles_as_it_says_and_runs(beside, more):
    (build,) = re.findall(r"`(gcc [^`]*main\.c[^`]*)`", pages.read(PAGE))
    subprocess.run([*shlex.split(build), *STRICT, *more], cwd=beside, check=True)
    answer = subprocess.run(["./a.out"], cwd=beside, check=True, capture_output=True, text=True)
    ticks = [line.split(" ", 1) for line in answer.stdout.splitlines()]
    assert [fault for _, fault in ticks] == ["no fault"] * 3
    # What the page says of the first call: a tick of the limit of torque rates, from zero.
    design = design_of(open_run(demo.FOLDER))
    (limit,) = set(design.controller.torque_limit.tolist())
    tick = 2.0 * limit * PERIOD / design.safeguard.torque_swing_s
    assert abs(float(ticks[0][0])) == pytest.approx(tick, rel=1e-5)
