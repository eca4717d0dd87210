"""The output folder: all files of one export, or fewer, and never files of two."""

import os

import pytest

from neuralgaits.export import output_folder

OLD = {"a.h": "old a", "b.c": "old b"}
NEW = {"a.h": "new a", "b.c": "new b", "c.c": "new c"}


@pytest.mark.parametrize("moment", range(len(NEW)))
def test_an_export_that_is_killed_leaves_no_mixture(tmp_path, monkeypatch, moment):
    out = tmp_path / "c"
    output_folder.publish(out, OLD)
    (out / "mine.c").write_text("of the user")
    moved, replace = [], os.replace

    def killed(source, target):
        if len(moved) == moment:
            raise KeyboardInterrupt
        moved.append(target)
        replace(source, target)

    monkeypatch.setattr(os, "replace", killed)
    with pytest.raises(KeyboardInterrupt):
        output_folder.publish(out, NEW)
    left = {path.name: path.read_text() for path in out.iterdir()}
    assert left.pop("mine.c") == "of the user"
    assert left == dict(list(NEW.items())[:moment])
    monkeypatch.undo()
    output_folder.publish(out, NEW)
    left = {path.name: path.read_text() for path in out.iterdir()}
    assert left == NEW | {"mine.c": "of the user"}
    assert sorted(path.name for path in tmp_path.iterdir()) == ["c"]


def test_a_new_folder_appears_whole(tmp_path, monkeypatch):
    def killed(source, target):
        raise KeyboardInterrupt

    monkeypatch.setattr(os, "replace", killed)
    with pytest.raises(KeyboardInterrupt):
        output_folder.publish(tmp_path / "c", NEW)
    assert list(tmp_path.iterdir()) == []
