"""The table's words: a forgery, what it is made from, and which answers are right.

A forgery is a file that no checker may take for what it pretends to be. Its maker spoils a true
proof, or a copy of the run folder beside it. Three checkers are asked: the C++ one, the Python
one with the file alone, and the Python one with the run. Only the last may say `proved` of a run.
"""

import json
import re
import shutil
import tempfile
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any, Literal

Table = dict[str, Any]
About = Literal[
    "small", "walk", "full", "feet", "belief", "speeds", "cartpole", "hopper", "space",
    "held", "free", "law", "lawfree", "robots",
]  # fmt: skip
Content = Table | str | bytes
EXIT = {
    "proved": 0,
    "consistent": 0,
    "rejected": 1,
    "unreadable": 2,
    "undecided": 3,
    "crashed": 70,
}
"""Exit code of each answer."""
YES = {
    "cpp": "proved",
    "alone": "consistent",
    "run": "proved",
    "report": "proved",
    "header": "proved",
}
"""The word with which a checker accepts. Without a run nothing is ever proved."""


@dataclass(frozen=True)
class Answer:
    """Answers that are right.

    Attributes:
        words: how a checker may refuse.
        accepts: whether it may accept, because what it then says is true.
        says: patterns of which each must be in its output if it accepts.
        never: a pattern that must not be in its output, whatever it answers.
    """

    words: frozenset[str]
    accepts: bool = False
    says: tuple[str, ...] = ()
    never: str | None = None

    def wrong(self, checker: str, word: str, text: str) -> str | None:
        """Why an answer is not one of these; None if it is."""
        if self.never is not None and re.search(self.never, text):
            return f"answered {word} with words like {self.never!r}"
        if word in self.words:
            return None
        if word == YES[checker] and self.accepts:
            silent = [pattern for pattern in self.says if not re.search(pattern, text)]
            return f"accepted without a word like {silent[0]!r}" if silent else None
        return f"answered {word}"


def refused(words: str) -> Answer:
    """One of these, and never accepted."""
    return Answer(frozenset(words.split()))


UNREADABLE = refused("unreadable")
REJECTED = refused("rejected")
OPEN = refused("undecided")
NO = refused("unreadable rejected undecided")
UNTRUE = refused("rejected undecided")
LOOSE = Answer(NO.words, accepts=True)
"""Nothing is wrong with the file by itself: it may be accepted, or not."""


def true(*says: str) -> Answer:
    """May be accepted where the output says this: what is accepted is true of what is printed."""
    return Answer(NO.words, True, says)


ACCEPTED = Answer(frozenset(), accepts=True)
"""A true proof."""


@dataclass
class Case:
    """What a maker spoils: a copy of the true proof's table, and on demand one of its run.

    Attributes:
        base: what there is to forge from.
        about: which of the proofs.
        table: to be changed in place.
        run: the folder that `--run` will name.
    """

    base: "Base"
    about: About
    table: Table
    run: Path

    def folder(self) -> Path:
        """A copy of the run folder to spoil; `run` from here on."""
        if self.run in self.base.runs.values():
            place = Path(tempfile.mkdtemp(dir=self.base.scratch)) / self.run.name
            self.run = Path(shutil.copytree(self.run, place))
        return self.run


@dataclass(frozen=True)
class Base:
    """True proofs, and the runs they are about.

    Attributes:
        proofs: "small" is level 1 of two conditions, the region of one in two boxes; "walk" is
            levels 1 to 3 of the default gait; "full" is all four. The others are those of
            `system_bases` and `disturbed_base`.
        runs: folder of each.
        scratch: where spoilt copies go.
    """

    proofs: dict[About, Table]
    runs: dict[About, Path]
    scratch: Path

    def case(self, about: About) -> Case:
        """Something to spoil."""
        return Case(self, about, json.loads(self.texts[about]), self.runs[about])

    @cached_property
    def texts(self) -> dict[About, str]:
        """The proofs as files."""
        return {about: json.dumps(table) for about, table in self.proofs.items()}


@dataclass(frozen=True)
class Forged:
    """A forged file, and the run folder it pretends to be about."""

    content: bytes
    run: Path


Maker = Callable[[Case], Content | None]


@dataclass(frozen=True)
class Forgery:
    """One kind of forgery.

    Attributes:
        kind: in words.
        about: the true proof that it starts from.
        maker: spoils it; what it returns, if anything, is the content.
        answers: by checker: cpp, alone, run; report where a run's page must not believe it, header
            where the C that is exported must not.
        bounded: whether Python has to bound boxes to find out; else statements may be taken as
            checked, which costs nothing.
        process: whether the run's code attacks the process that opens it.
    """

    kind: str
    about: About
    maker: Maker
    answers: dict[str, Answer] = field(default_factory=dict)
    bounded: bool = False
    process: bool = False

    def make(self, base: Base) -> Forged:
        """The forged file, and its run."""
        case = base.case(self.about)
        made = self.maker(case)
        content = case.table if made is None else made
        text = json.dumps(content) if isinstance(content, dict) else content
        return Forged(text if isinstance(text, bytes) else text.encode(), case.run)


class Theme:
    """Collects the kinds of one file.

    Attributes:
        kinds: in the order of the file.
    """

    def __init__(self, about: About):
        self.about: About = about
        self.kinds: list[Forgery] = []

    def forgery(
        self,
        kind: str,
        *,
        cpp: Answer | None = NO,
        alone: Answer | None = NO,
        run: Answer | None = NO,
        report: Answer | None = None,
        header: Answer | None = None,
        about: About | None = None,
        bounded: bool = False,
        process: bool = False,
    ) -> Callable[[Maker], Maker]:
        """Register a maker with the answers that are right; a checker without one is not asked."""
        asked = {"cpp": cpp, "alone": alone, "run": run, "report": report, "header": header}
        answers = {checker: answer for checker, answer in asked.items() if answer is not None}

        def register(maker: Maker) -> Maker:
            chosen = about or self.about
            self.kinds.append(Forgery(kind, chosen, maker, answers, bounded, process))
            return maker

        return register
