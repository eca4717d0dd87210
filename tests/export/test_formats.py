"""A format is one entry: what a new one takes, with a format that says next to nothing."""

from functools import partial

import pytest

from neuralgaits.errors import InputError
from neuralgaits.records.exported import UncheckedExport
from neuralgaits.workflows import demo
from neuralgaits.workflows import export_formats as workflow
from neuralgaits.workflows.export import export_controller


def _joints(design, states):
    """The joints' number as a text, compared with nothing."""
    del states
    files = {"joints.txt": f"{design.controller.robot.n}\n"}
    return files, partial(UncheckedExport, reason="nothing to compare with")


def test_an_entry_is_all_that_a_format_needs(monkeypatch, tmp_path):
    monkeypatch.setitem(workflow.WRITERS, "joints", _joints)
    done = export_controller(demo.FOLDER, tmp_path / "out", format="joints")
    assert not done.checked
    assert (done.summary["format"], done.summary["reason"]) == ("joints", "nothing to compare with")
    assert (tmp_path / "out" / "joints.txt").read_text() == "5\n"


def test_without_its_entry_it_is_refused(tmp_path):
    with pytest.raises(InputError, match="unknown format 'joints': expected one of c, onnx"):
        export_controller(demo.FOLDER, tmp_path / "out", format="joints")
    assert not (tmp_path / "out").exists()


def test_the_command_line_offers_every_format():
    from typing import get_args, get_type_hints

    from neuralgaits.cli import arguments

    assert get_args(get_type_hints(arguments.ExportOptions)["format"]) == tuple(workflow.WRITERS)
