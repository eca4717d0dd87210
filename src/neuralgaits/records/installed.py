"""What comes with the package, and whether this machine is ready for it: `robots` and `doctor`."""

from collections.abc import Mapping
from dataclasses import dataclass

from neuralgaits.records.record import Record


@dataclass(frozen=True)
class CatalogueEntry:
    """A built-in robot or spec, and a line about it."""

    name: str
    about: str


@dataclass(frozen=True, eq=False)
class BuiltIn(Record):
    """Everything that exists by name.

    Attributes: written: the file that a robot was written to; None if none was asked for.
    """

    robots: tuple[CatalogueEntry, ...]
    specs: tuple[CatalogueEntry, ...]
    written: str | None = None


@dataclass(frozen=True)
class Finding:
    """One thing that was looked at.

    Attributes:
        ok: whether it is as it should be.
        needed: False if only a part of the program wants it; `found` or `fix` says which.
        found: what is there.
        fix: what to do, or None if nothing.
    """

    ok: bool
    needed: bool
    found: str
    fix: str | None


@dataclass(frozen=True, eq=False)
class Machine(Record):
    """A machine. Attributes: ok: everything needed is there; neuralgaits: version."""

    ok: bool
    neuralgaits: str
    python: Finding
    device: Finding
    x64: Finding
    opengl: Finding
    video: Finding
    compiler: Finding
    hzd: Finding
    drake: Finding
    onnx: Finding
    gym: Finding
    ray: Finding

    @property
    def findings(self) -> Mapping[str, Finding]:
        """By what was looked at."""
        return {name: one for name, one in vars(self).items() if isinstance(one, Finding)}
