"""One case: an input altered by its number, carried through its doors, and looked after."""

import os
import re
import traceback
from dataclasses import dataclass, field

import numpy as np

from neuralgaits.errors import NeuralGaitsError
from support.fuzzing.doors import KINDS, Reader, inputs, readers
from support.fuzzing.formats import altered
from support.fuzzing.paths import PATH_READERS, log_reader, odd_path
from support.fuzzing.place import FILES, Place
from support.fuzzing.words import READERS, word

WORDS, PATHS = "names and settings", "paths"
PROOFS, SMALL_PROOF = "proof files", f"{FILES}/small.json"
SMALL = 0.9
"""Share of proof files that are small, so that their boxes are bounded too."""
ALL = (*KINDS, WORDS, PATHS)
NO_FILES = {WORDS: READERS, PATHS: (*PATH_READERS, log_reader)}
"""Kinds of input that are no file's content, and who takes them."""


@dataclass(frozen=True)
class Case:
    """An altered input. Attributes: name: of the input; content: its bytes."""

    name: str
    content: bytes


@dataclass
class Answer:
    """What became of it.

    Attributes:
        read, refused, told: doors that took it, refused it, or passed on what the system said.
        tracebacks: doors that failed, with where.
        lost: files that are not what they were.
    """

    read: int = 0
    refused: int = 0
    told: int = 0
    tracebacks: list[str] = field(default_factory=list)
    lost: list[str] = field(default_factory=list)


def case_of(place: Place, kind: str, number: int) -> Case:
    """The input of a number, always the same for the same inputs."""
    draw = np.random.default_rng([ALL.index(kind), number])
    if kind == WORDS:
        return Case("word", word(draw).encode("utf-8", "surrogatepass"))
    if kind == PATHS:
        return Case("path", odd_path(draw, number))
    groups: dict[str, list[str]] = {}
    for known in inputs(place, kind):
        # Boxes and rounds are many files of one sort.
        groups.setdefault(re.sub(r"-\d+", "", known), []).append(known)
    sorts = sorted(groups)
    if kind == PROOFS and draw.random() < SMALL:
        chosen = [SMALL_PROOF]
    else:
        chosen = groups[sorts[int(draw.integers(len(sorts)))]]
    name = chosen[int(draw.integers(len(chosen)))]
    return Case(name, altered(name, (place.kept / name).read_bytes(), draw))


def carry(place: Place, kind: str, number: int) -> Answer:
    """Carry a case through its doors and put the inputs back."""
    case, answer = case_of(place, kind, number), Answer()
    file = None if kind in NO_FILES else place.root / case.name
    if file is not None:
        file.write_bytes(case.content)
    before = place.signature()
    coding = "surrogateescape" if kind == PATHS else "surrogatepass"
    given = file or case.content.decode("utf-8", coding)
    os.chdir(place.root)
    for reader in NO_FILES[kind] if file is None else readers(case.name):
        _open(reader, place, given, answer)
    after = place.signature()
    answer.lost = [name for name, what in before.items() if after.get(name) != what]
    place.put_back(None if file is None else case.name)
    return answer


def _open(reader: Reader, place: Place, given, answer: Answer) -> None:
    try:
        reader(place, given)
        answer.read += 1
    except NeuralGaitsError:
        answer.refused += 1
    except OSError:
        answer.told += 1
    except Exception as error:
        where = traceback.extract_tb(error.__traceback__)
        own = [frame for frame in where if "/neuralgaits/" in frame.filename] or where
        last = own[-1]
        file = last.filename.rpartition("neuralgaits/")[2]
        what = f"{type(error).__name__}: {' '.join(str(error).split())[:100]}"
        answer.tracebacks.append(f"{file}:{last.lineno} {last.name}: {what}")
