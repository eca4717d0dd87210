"""Names and settings as words of a command line, altered, and what reads each."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

from neuralgaits import logs
from neuralgaits.analysis.learned import LearnedResiduals
from neuralgaits.barriers import specs
from neuralgaits.certificate.proof_file.reader import read_claims
from neuralgaits.episode_rounds.episode_folder import EpisodeFolder
from neuralgaits.robots import load_robot
from neuralgaits.runs import resolve, resolve_unfinished
from neuralgaits.settings import forms
from neuralgaits.simulation.linked.config import parse_link
from neuralgaits.simulation.setup.disturbance import parse
from neuralgaits.workflows.check_proof import proof_file_at
from support.fuzzing.alter import ODD, Draw, altered_bytes
from support.fuzzing.doors import Reader
from support.fuzzing.place import Place

WORDS = (
    *("amber3m", "rabbit", "walking", "paper", "latest", "files/amber3m.xml", "files/brief.py"),
    *("files/brief.py:brief", "files/brief.py:KEPT", "files/small.json", "files/walk.csv", "run"),
    *(
        "run/config.json",
        "run/robot.xml",
        "episodes",
        "32,32",
        "0.01,0.3",
        "learned",
        "~",
        "..",
        "/",
    ),
    *("friction=0.4,delay_ms=4", "law=fblin,lockstep=1,loss=0.01", "torso_shift_m=-0.02", ".py:x"),
)
"""Whole ones: each is right somewhere and wrong elsewhere."""


def word(draw: Draw) -> str:
    """A word as somebody might type, paste or generate it."""
    texts = [value for value in ODD if isinstance(value, str)]
    kind = draw.random()
    if kind < 0.1:
        return str(draw.choice(WORDS))
    if kind < 0.25:
        return texts[int(draw.integers(len(texts)))] + str(draw.choice(["", ".py:a", ".xml", "/x"]))
    if kind < 0.4:
        return str(draw.choice(WORDS)) + str(draw.choice([",", "=", ":", "/", " "])) + word(draw)
    changed = altered_bytes(str(draw.choice(WORDS)).encode(), draw)
    # As Python reads the words of a command line.
    return changed.decode("utf-8", "surrogateescape")


def _reads(read: Callable[[Place, str], Any]) -> Reader:
    return lambda place, text: read(place, str(text))


READERS: tuple[Reader, ...] = (
    _reads(lambda place, text: load_robot(text)),
    _reads(lambda place, text: load_robot(Path(text))),
    _reads(lambda place, text: specs.load(text, place.robot)),
    _reads(lambda place, text: resolve(text, place.root)),
    _reads(lambda place, text: resolve_unfinished(text, place.root)),
    _reads(lambda place, text: EpisodeFolder.find(text, place.root)),
    _reads(lambda place, text: LearnedResiduals.read(Path(text), place.robot.n - 1)),
    _reads(lambda place, text: parse(text)),
    _reads(lambda place, text: parse_link(text)),
    _reads(lambda place, text: forms.disturbance(text)),
    # The path and the text only: a run's whole proof takes its ten seconds, rightly.
    _reads(lambda place, text: read_claims(proof_file_at(text))),
    _reads(lambda place, text: logs.read(text, place.robot)),
    _reads(lambda place, text: forms.widths(text)),
)
