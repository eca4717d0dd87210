"""A robot file is data: names stand in the C that is compiled, and none becomes code."""

import re
import subprocess

import pytest

from neuralgaits.export import output_folder
from neuralgaits.export.source import gait_files, quoted
from neuralgaits.robots import load_robot
from support.designs import LAWS, design_for

EVIL = "m */ int evil(void){return 0;} /*"


def test_names_end_no_comment(tmp_path):
    xml = load_robot("amber3m").layout.xml
    first = re.findall(r'<(?:motor|general)[^>]*name="([^"]*)"', xml)[0]
    (tmp_path / "robot.xml").write_text(xml.replace(f'"{first}"', f'"{EVIL}"'))
    files = gait_files(design_for(str(tmp_path / "robot.xml"), LAWS))
    assert "evil" in files["gait.h"]
    outside = re.sub(r"/\*.*?\*/", "", files["gait.h"], flags=re.DOTALL)
    assert "evil" not in outside
    for name, text in (output_folder.shipped() | files).items():
        (tmp_path / name).write_text(text)
    command = ["gcc", "-std=c99", "-pedantic", "-Wall", "-Werror", "-c", "gait.c", "-o", "gait.o"]
    subprocess.run(command, cwd=tmp_path, check=True)
    symbols = subprocess.run(["nm", "gait.o"], cwd=tmp_path, capture_output=True, text=True)
    assert "ng_policy_rate" in symbols.stdout and "evil" not in symbols.stdout


@pytest.mark.parametrize(
    "name", ['x"; int y', "back\\", "line\nline", "??/", "%s", "Größe", "0123", "a?b"]
)
def test_a_string_of_c_is_the_name_to_the_last_byte(tmp_path, name):
    program = f"#include <stdio.h>\nint main(void) {{ fputs({quoted(name)}, stdout); return 0; }}\n"
    (tmp_path / "say.c").write_text(program)
    subprocess.run(
        ["gcc", "-std=c99", "-Wall", "-Werror", "say.c", "-o", "say"], cwd=tmp_path, check=True
    )
    said = subprocess.run([tmp_path / "say"], capture_output=True, check=True).stdout
    assert said == name.encode()
