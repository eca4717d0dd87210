"""What goes wrong in a user's spec file is told by its file and line, with what there is."""

import re

import pytest

from neuralgaits.barriers import specs
from neuralgaits.barriers.spec_file_errors import blamed, mistake
from neuralgaits.errors import SpecError

WRONG = {
    "import nowhere": (1, "ModuleNotFoundError: No module named 'nowhere'"),
    "own = 1 / 0": (1, "ZeroDivisionError: division by zero"),
    "x = 1\ndef own(robot:\n    pass": (2, "SyntaxError"),
    "def own(robot):\n  return robot\n wrong": (3, "IndentationError"),
    "def own(robot):\n    return robot.masss": (2, "a PlanarBiped has no 'masss', did you mean 'm"),
    "def own(robot):\n    return walking(robot)": (2, "NameError: name 'walking' is not defined"),
    "from neuralgaits.barriers import specs\nown = specs.runing": (2, "specs has no 'runing'"),
    "from neuralgaits.barriers import Pointwise\nown = Pointwise('a', 'tube')": (2, "TypeError: "),
    "import sys\nsys.exit(0)": (2, "SystemExit: 0; mend"),
    "def own(robot):\n    raise SystemExit(3)": (2, "SystemExit: 3; mend"),
    "def own(robot):\n    raise GeneratorExit": (2, "GeneratorExit; mend"),
    "def own(robot):\n    raise BaseExceptionGroup('two', [SystemExit()])": (2, "BaseExceptionGro"),
    "def __getattr__(name):\n    raise SystemExit": (2, "SystemExit; mend"),
}


@pytest.mark.parametrize("text", WRONG)
def test_a_file_that_raises_is_told_by_its_line(amber, tmp_path, text):
    """While it is imported, and while it builds the spec."""
    line, said = WRONG[text]
    file = tmp_path / "own.py"
    file.write_text(text + "\n")
    with pytest.raises(SpecError, match=rf"^{re.escape(str(file))}:{line}: .*{said}") as refusal:
        specs.load(f"{file}:own", amber)
    assert "\n" not in str(refusal.value)


def test_only_ctrl_c_passes_through(amber, tmp_path):
    (tmp_path / "own.py").write_text("def own(robot):\n    raise KeyboardInterrupt\n")
    with pytest.raises(KeyboardInterrupt):
        specs.load(f"{tmp_path / 'own.py'}:own", amber)


def test_a_name_that_stands_for_nothing_is_not_said_to_be_missing(amber, tmp_path):
    (tmp_path / "own.py").write_text("own = None\n")
    with pytest.raises(SpecError, match="expected a GaitSpec, found NoneType"):
        specs.load(f"{tmp_path / 'own.py'}:own", amber)


def test_what_cannot_be_called_with_a_robot_is_said_to(amber, tmp_path):
    (tmp_path / "own.py").write_text("def own():\n    pass\n")
    with pytest.raises(SpecError, match="expected a function of one robot, found TypeError: own"):
        specs.load(f"{tmp_path / 'own.py'}:own", amber)


def test_what_no_line_of_a_user_raised_stays_as_it_is():
    with pytest.raises(ZeroDivisionError) as found, blamed():
        _ = 1 / 0
    assert mistake(found.value) is None
