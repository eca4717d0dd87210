"""Commands on a screen are those that run where the program was called."""

import sys

import pytest

from neuralgaits.cli.invocation import as_called
from neuralgaits.cli.main import main
from neuralgaits.cli.screen_tables import show_facts, show_table


@pytest.fixture
def clone(tmp_path, monkeypatch):
    """A clone whose programs are in `.venv/bin`, and not among those that a shell looks for."""
    folder = tmp_path / ".venv" / "bin"
    folder.mkdir(parents=True)
    for name in ("neuralgaits", "pip"):
        (folder / name).write_text("#!/bin/sh\n")
        (folder / name).chmod(0o755)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("PATH", "/nowhere")
    monkeypatch.setattr(sys, "argv", [".venv/bin/neuralgaits", "certify"])
    return folder


def test_a_program_called_by_its_path_is_named_by_it(clone, capsys):
    said = "go on with `neuralgaits certify latest`; pip install 'neuralgaits[hzd]'"
    own = "go on with `.venv/bin/neuralgaits certify latest`; "
    assert as_called(said) == f"{own}.venv/bin/pip install 'neuralgaits[hzd]'"
    both = "neuralgaits simulate a && neuralgaits fit a"
    assert as_called(both).count(".venv/bin/neuralgaits ") == 2
    # Words and paths that only have the name in them.
    for other in ("neuralgaits: no run", "Made by neuralgaits", "runs/neuralgaits a"):
        assert as_called(other) == other
    show_facts([("next", "neuralgaits simulate latest")])
    show_table(("fix",), [("pip install 'neuralgaits[gym]'",)])
    assert main(["train"]) == 2
    shown = capsys.readouterr()
    assert shown.out.startswith("next  .venv/bin/neuralgaits simulate latest\n")
    assert ".venv/bin/pip install" in shown.out and shown.err.startswith("neuralgaits: ")


def test_a_program_that_the_shell_finds_keeps_its_name(clone, monkeypatch):
    monkeypatch.setenv("PATH", str(clone))
    assert as_called("neuralgaits train") == "neuralgaits train"
    monkeypatch.setattr(sys, "argv", ["-m", "pytest"])
    monkeypatch.setenv("PATH", "/nowhere")
    assert as_called("neuralgaits train") == "neuralgaits train"
