"""Contents of the package, and readiness of this machine: results of `robots` and `doctor`."""

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
    """Built-in robots and specs by name.

    Attributes: written: file that a robot was written to; None if none was.
    """

    robots: tuple[CatalogueEntry, ...]
    specs: tuple[CatalogueEntry, ...]
    written: str | None = None


@dataclass(frozen=True)
class Finding:
    """Finding about one item of the machine.

    Attributes:
        ok: whether it works.
        needed: False if only a part of the program needs it; `found` or `fix` says which.
        found: state of the machine.
        fix: line that fixes it, or None if nothing is wrong.
    """

    ok: bool
    needed: bool
    found: str
    fix: str | None


@dataclass(frozen=True, eq=False)
class Machine(Record):
    """A machine. Attributes: ok: whether everything needed works; neuralgaits: version."""

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
    mcap: Finding
    deploy: Finding
    gym: Finding
    ray: Finding

    @property
    def findings(self) -> Mapping[str, Finding]:
        """Findings by the name of the item."""
        return {name: one for name, one in vars(self).items() if isinstance(one, Finding)}
