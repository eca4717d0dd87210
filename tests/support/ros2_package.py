"""ROS 2 packages for tests: written, compiled against stubs of the few headers, and run."""

import re
import subprocess
from dataclasses import replace
from pathlib import Path

from neuralgaits.export import build, output_folder
from neuralgaits.export.board_source import board_files
from neuralgaits.export.design import Design
from neuralgaits.export.monitor_source import monitor_files
from neuralgaits.export.reference import Reference
from neuralgaits.export.ros2_source import ros2_files
from neuralgaits.export.selftest import selftest_file
from neuralgaits.export.source import gait_files
from support.deployments import drawn

STRICT = ("-std=c++17", "-O0", "-Wall", "-Wextra", "-Werror", "-pedantic")


def _files(design: Design) -> dict[str, str]:
    controller = output_folder.shipped() | gait_files(design) | board_files(design)
    controller |= monitor_files(design)
    controller["gait_selftest.h"] = selftest_file(design, Reference(design))
    return ros2_files(design, controller)


def package_of(folder: Path, made: Design, seed: int) -> tuple[Design, Path]:
    """Write a package for hardware that differs from the robot file in everything."""
    design = replace(made, deployment=drawn(made.controller.robot, seed))
    for name, text in _files(design).items():
        (folder / name).write_text(text)
    return design, folder


def built(folder: Path, here: Path, *flags: str, main: str = "ros2_main.cpp") -> Path:
    """Compile the plugin and its driver, as the package's own list of sources says."""
    cmake = (folder / "CMakeLists.txt").read_text()
    (listed,) = re.findall(r"add_library\(\S+ SHARED\s(.*?)\)", cmake, re.DOTALL)
    sources = listed.split()
    objects = []
    for name in (one for one in sources if one.endswith(".c")):
        objects.append(folder / f"{name}.o")
        command = ["gcc", *build.STRICT, "-O1", "-c", str(folder / name), "-o", str(objects[-1])]
        subprocess.run(command, check=True)
    plugins = [str(folder / one) for one in sources if one.endswith(".cpp")]
    include = ["-I", str(folder), "-I", str(here / "ros2_stubs"), "-I", str(here)]
    command = ["g++", *STRICT, *flags, *include, *plugins, str(here / main)]
    subprocess.run([*command, *map(str, objects), "-o", str(folder / "driver")], check=True)
    return folder / "driver"


def report_of(driver: Path, word: str) -> tuple[dict[str, str], str]:
    """Run a driver. Returns: what it printed line by line, and all its words."""
    done = subprocess.run([str(driver), word], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    rows = (line.split(" ", 1) for line in done.stdout.splitlines() if " " in line)
    return {key: value for key, value in rows if key != "value"}, done.stdout + done.stderr
