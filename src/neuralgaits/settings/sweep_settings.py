"""Settings of the verb `sweep`, for command line and Python call alike."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import KW_ONLY, dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from tyro.conf import Fixed, Positional

from neuralgaits._called_with import PythonType
from neuralgaits._checks import check_budget, check_seeds, check_steps, check_walked
from neuralgaits.errors import InputError
from neuralgaits.records.level_words import HIGHEST, WORDS
from neuralgaits.records.swept import SweepRow
from neuralgaits.runs import RUNS_ROOT
from neuralgaits.settings import forms
from neuralgaits.settings.forms import Interval
from neuralgaits.settings.options import Settings, arg, option
from neuralgaits.settings.shared_options import (
    SOME_PATHS,
    AnyName,
    Flag,
    Folder,
    Names,
    Number,
    Ray,
    Root,
    Seconds,
    Seeds,
    Workers,
)

if TYPE_CHECKING:
    from neuralgaits.engine import WorkerPool

    Robots = Sequence[str | Path]
    Disturbances = AnyName | Mapping[str, Any]
else:
    WorkerPool = Any
    Robots = Names
    Disturbances = str

_SOME_DISTURBANCES = PythonType("str | Path | Mapping[str, Any] | None", (str, Path, Mapping))
_Specs = Annotated[Sequence[str] | None, option("S,...", partial(forms.names, "specs"), ",".join)]
_Controllers = Annotated[
    Sequence[str] | None, option("C,...", partial(forms.names, "controllers"), ",".join)
]
_Speeds = Annotated[
    Sequence[float | Interval | None] | None,
    option("V|A:B,...", forms.speeds, forms.speeds_word),
]


@dataclass(frozen=True)
class SweepSettings(Settings):
    """Settings of `sweep`: which combinations are trained, proved and walked, and where."""

    robots: Annotated[Positional[Robots], arg(metavar="[ROBOT...]"), SOME_PATHS] = ()
    """Names of built-in robots, or paths of MJCF files; the sweep's own with --resume."""
    _: KW_ONLY
    specs: _Specs = None
    """Specs, as for train; walking if not given."""
    speeds: _Speeds = None
    """Speeds to walk at [m/s], or ranges of them, as for train --speed."""
    seeds: Seeds = None
    """Seeds A, A+1, ... up to B-1, or one; 0 if not given."""
    steps: Number = None
    """Gradient steps of each training; the spec's own number if not given."""
    certify: Annotated[int | None, arg(metavar="LEVEL")] = None
    """Prove each run up to this level; no proof if not given."""
    budget: Seconds = None
    """With --certify: time for each proof [s]. The result then depends on the machine."""
    controllers: _Controllers = None
    """Control laws to walk with: pd (if not given), fblin, paper, clf-qp, scheduled-pd."""
    disturbances: Annotated[
        Disturbances | None, arg(metavar="FILE|standard|none"), _SOME_DISTURBANCES
    ] = None
    """Disturbances to walk under, besides none: the standard eighteen (if not given), or those
    of a TOML file; see the page 'From a laptop to a cluster'."""
    walks: Number = None
    """Number of walks of 25 steps under each disturbance; 4 if not given."""
    workers: Workers = None
    ray: Ray = None
    out: Folder = None
    """Folder of the sweep; runs/sweeps/<time>-<first seed> if not given."""
    resume: Flag = False
    """Continue the sweep in --out, if there is one; finished rows are kept."""
    engine: Fixed[WorkerPool | None] = None
    """Engine to use instead of processes and Ray."""
    tell: Fixed[Callable[[SweepRow, int, int], None] | None] = None
    """Called with a finished row, the number of finished rows, and that of all rows."""
    begun: Fixed[Callable[[str], None] | None] = None
    """Called with one line on the rows, their folder and the engine, before the first row."""
    root: Root = RUNS_ROOT

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.seeds is not None:
            check_seeds(self.seeds)
        check_steps(self.steps)
        check_budget(self.budget)
        if self.certify is not None and self.certify not in WORDS:
            raise InputError(f"expected --certify 1 to {HIGHEST}, found {self.certify}")
        if self.walks is not None and self.walks < 1:
            raise InputError(f"expected at least 1 walk, found {self.walks}")
        check_walked("walks", self.walks or 1)
