"""Structures that are read from the headers lie in memory as the compiler lays them."""

import ctypes
import subprocess
from pathlib import Path

import mujoco
import pytest

from neuralgaits._compiler import Compiler
from neuralgaits.analysis.run import open_run
from neuralgaits.control.controlled_gait import ControlledGait
from neuralgaits.simulation.native.struct_layout import layout_of
from neuralgaits.simulation.native_walk import _design, sources
from neuralgaits.simulation.setup.starts import momentum_range
from support.shipped_run import SHIPPED

SPEED = SHIPPED.with_name("demo_speed_run")


def places(structure, prefix=""):
    """Yield the path, offset and size of each field, those of inner structures too."""
    for name, kind in structure._fields_:
        field = getattr(structure, name)
        yield prefix + name, field.offset, field.size
        if issubclass(kind, ctypes.Structure):
            for inner, offset, size in places(kind, f"{prefix}{name}."):
                yield inner, field.offset + offset, size


@pytest.mark.parametrize("folder", [SHIPPED, SPEED], ids=["without commands", "with a command"])
def test_every_field_is_where_the_compiler_puts_it(folder, tmp_path):
    compiler = Compiler.for_c()
    if compiler is None:
        pytest.skip("no C compiler")
    run = open_run(folder)
    gait, robot = run.trained, run.robot
    policy = gait.policy
    layout = layout_of(robot.n // 2, robot.n - 1, len(policy.commands), policy.step_size)
    expected, prints = [], []
    for structure in (layout.scene, layout.walk):
        name = structure.__name__
        for path, *place in places(structure):
            expected.append(place)
            one = f"offsetof({name}, {path}), sizeof((({name} *)0)->{path})"
            prints.append(f'printf("%zu %zu\\n", {one});')
    assert layout.record.fields is not None
    for name, (kind, offset, *_) in layout.record.fields.items():
        expected.append([offset, kind.itemsize])
        one = f"offsetof(ng_record, {name}), sizeof(((ng_record *)0)->{name})"
        prints.append(f'printf("%zu %zu\\n", {one});')
    for name, text in sources(_design(ControlledGait(robot, gait, momentum_range(gait)))).items():
        (tmp_path / name).write_text(text)
    included = '#include <stddef.h>\n#include <stdio.h>\n#include "walk.h"\n'
    (tmp_path / "main.c").write_text(
        f"{included}int main(void) {{\n" + "\n".join(prints) + "\nreturn 0;\n}\n"
    )
    headers = Path(mujoco.__file__).parent / "include"
    program = tmp_path / "main"
    compiler.run(
        [
            "-I",
            str(tmp_path),
            "-isystem",
            str(headers),
            str(tmp_path / "main.c"),
            "-o",
            str(program),
        ]
    )
    printed = subprocess.run([str(program)], capture_output=True, text=True, check=True).stdout
    assert [list(map(int, line.split())) for line in printed.splitlines()] == expected
    assert len(expected) > 100
