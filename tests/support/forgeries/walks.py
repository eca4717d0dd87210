"""Run folders whose kept walk, `report/walk.json`, is not one of the run."""

import json
from dataclasses import replace
from typing import Any

from neuralgaits.analysis.run import open_run
from neuralgaits.records.report_walk import FILE, ShownWalk
from neuralgaits.report import shown_walk
from neuralgaits.runs import plain
from support.forgeries.base import Case, Theme, refused

THEME = Theme("walk")
NOT_SHOWN = replace(refused("3"), never="keeps a walk")
"""The proof is true; the walk has to be walked again."""


def _kept(what: str, *, hashed: bool = True, **changed: Any) -> None:
    """Register a walk that agrees with its run but for some fields; if hashed, so does its hash."""

    @THEME.forgery(what, cpp=None, alone=None, run=None, report=NOT_SHOWN)
    def _(case: Case) -> None:
        folder = case.folder()
        run = open_run(folder)
        asked = shown_walk.request_of(run)
        walk = ShownWalk(
            **plain(shown_walk._settings(run, asked)),
            key=shown_walk._key(run, asked),
            steps_walked=asked.steps,
            fell=False,
            fall_reason=None,
            frame_s=0.02,
            force_n=None,
        )
        walk = replace(walk, content=shown_walk._content(walk))
        run.folder.write_json(FILE, walk)
        assert shown_walk.kept_walk(run, asked) is not None
        forged = replace(walk, **changed)
        forged = replace(forged, content=shown_walk._content(forged)) if hashed else forged
        (folder / FILE).write_text(json.dumps(plain(forged)))


_kept("a kept walk with another reason", origin="repeats the flight to the moon")
_kept("a kept walk of another robot", plant="anything")
_kept("a kept walk of more steps than asked", steps_walked=987)
_kept("a kept walk of fewer steps without a fall", steps_walked=1)
_kept("a kept walk that fell for a reason that is none", fell=True, fall_reason="it was tired")
_kept("a kept walk of other settings", key="")
_kept("a kept walk whose frames are others", hashed=False, weight_n=1e9)
