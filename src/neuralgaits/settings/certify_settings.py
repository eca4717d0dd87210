"""Settings of the verbs `certify` and `check-proof`."""

from collections.abc import Callable, Mapping
from dataclasses import KW_ONLY, dataclass
from pathlib import Path
from typing import Annotated, Literal

from tyro.conf import Fixed, Positional

from neuralgaits._checks import (
    check_bandwidth,
    check_budget,
    check_disturbance,
    check_error,
    check_state_error,
)
from neuralgaits.errors import InputError
from neuralgaits.records.checked import Arithmetic
from neuralgaits.records.law_proof import Clock
from neuralgaits.records.level_words import (
    DISTURBED_LEVEL,
    FULL_ORDER_LEVEL,
    HIGHEST_OF_MANY,
    WALKING_SET_LEVEL,
    WORDS,
)
from neuralgaits.settings import forms
from neuralgaits.settings.forms import Interval
from neuralgaits.settings.options import Settings, arg, option
from neuralgaits.settings.shared_options import (
    A_PATH,
    AnyName,
    Disturbance,
    Flag,
    Ray,
    Run,
    Seconds,
    Workers,
)

_LEVELS = (
    "What to prove; 3 if not given, which is the most with parameters. "
    f"{' '.join(f'Level {n}: {words.asks}.' for n, words in WORDS.items())}"
)

_Box = Annotated[
    Mapping[str, float] | None, option("NAME=SIZE,...|none", forms.box_or_none, forms.box_word)
]
_StateError = Annotated[
    tuple[float, float] | None,
    option("ANGLE,RATE", forms.state_error, forms.state_error_word),
]
_ModelError = Annotated[
    Mapping[str, float] | None, option("NAME=SIZE,...", forms.model_error, forms.box_word)
]
_Ranges = Annotated[
    Mapping[str, Interval] | None, option("NAME=LOW:HIGH,...", forms.ranges, forms.ranges_word)
]


@dataclass(frozen=True)
class CertifySettings(Settings):
    """Settings of `certify`: what is to be proved of which gait, and how long it may take."""

    run: Run
    """Run folder, or latest."""
    _: KW_ONLY
    level: Annotated[int | None, arg(metavar="N", help=_LEVELS)] = None
    disturbance: Disturbance = None
    """Bounds on the disturbance of dz at level 2 (m/s, N m), none if not given; learned: the
    remaining error of the run's residual."""
    parameters: _Box = None
    """Box of robots to prove levels 1 to 3 for, as in mass=2%,com=5mm,inertia=5%,floor=5mm; that
    of the run if not given; none: the robot of the file alone, on its floor."""
    bandwidth: Annotated[float | None, arg(metavar="RAD/S")] = None
    """Double pole w of the outputs at levels 4 and 5: that of fblin, 30, if not given. If given,
    --level 4 is about the largest set that the search yields, in a norm of its own: 20 suits
    AMBER-3M."""
    controller: Literal["fblin", "scheduled-pd"] = "fblin"
    """Control law that level 5 is about, at the bandwidth given."""
    clock: Clock = "touchdown"
    """At level 5, when torques are set: at each touchdown and then from tick to tick; or free: by
    a clock that knows of no touchdown."""
    error: Annotated[float, arg(metavar="RAD/S^2")] = 0.0
    """At level 5, largest error |S e| of a torque when it is set [rad/s^2], as of
    rounding, beside --state-error: the proved time between ticks gets shorter."""
    state_error: _StateError = None
    """At level 5 with fblin, errors of each measured angle and of each measured rate, as in
    0.005mrad,0.25mrad/s; (rad, rad/s) in Python. The error of torques that these make is proved."""
    model_error: _ModelError = None
    """At level 5 with fblin, errors of the file's masses, centres of mass and inertias, of each
    type of link, as in mass=0.2%,com=0.4mm: proved for every such robot."""
    budget: Seconds = None
    """Stop the search after this time [s]; tracing and compiling before it take some seconds more.
    The result so far is kept."""
    within: _Ranges = None
    """For a gait that takes commands, prove these ranges only, as in speed=0.70:0.72 or
    slope=-1:1 [degrees]; the run as a whole stays undecided."""
    resume: Flag = False
    """Continue with the boxes of the last certificate."""
    workers: Workers = None
    ray: Ray = None
    progress: Fixed[Callable[[float, int], None] | None] = None
    """Called with (proved share, boxes) now and then."""

    def __post_init__(self) -> None:
        super().__post_init__()
        check_budget(self.budget)
        level, disturbance = self.highest, self.disturbance
        if level not in WORDS:
            *below, most = (f"{number} ({words.about})" for number, words in WORDS.items())
            raise InputError(f"expected level {', '.join(below)} or {most}, found {level}")
        if isinstance(disturbance, tuple):
            check_disturbance(disturbance)
        if any(disturbance or ()) and level < WALKING_SET_LEVEL:
            raise InputError("expected level 2 or more with a disturbance, found 1: raise --level")
        if self.clock == "free" and level < DISTURBED_LEVEL:
            raise InputError(
                f"expected level {DISTURBED_LEVEL} with a free clock, found {level}: raise --level"
            )
        if self.controller != "fblin" and level < DISTURBED_LEVEL:
            raise InputError(
                f"expected level {DISTURBED_LEVEL} with {self.controller}, found {level}: raise "
                "--level"
            )
        check_error(self.error)
        if self.error and level < DISTURBED_LEVEL:
            raise InputError(
                f"expected level {DISTURBED_LEVEL} with an error of torques, found {level}: raise "
                "--level"
            )
        if self.state_error is not None:
            self._check_state_error(self.state_error)
        if self.model_error is not None:
            errors_of_model(self.model_error)
            self._check_fblin("an error of the model")
        if self.bandwidth is None:
            return
        check_bandwidth(self.bandwidth)
        if level < FULL_ORDER_LEVEL:
            raise InputError(
                f"expected level {FULL_ORDER_LEVEL} or 5 with a bandwidth, found {level}: raise "
                "--level"
            )

    def _check_state_error(self, error: tuple[float, float]) -> None:
        check_state_error(error)
        self._check_fblin("an error of the state")

    def _check_fblin(self, what: str) -> None:
        if self.highest < DISTURBED_LEVEL or self.controller != "fblin":
            raise InputError(
                f"expected level {DISTURBED_LEVEL} of fblin with {what}, found "
                f"level {self.highest} of {self.controller}: give --level {DISTURBED_LEVEL}, and "
                "leave --controller out"
            )

    @property
    def highest(self) -> int:
        """Highest level that is to be proved, the usual one if none is asked for."""
        return HIGHEST_OF_MANY if self.level is None else self.level


def errors_of_model(box: Mapping[str, float] | None) -> tuple[float, float, float] | None:
    """Return errors of masses, centres of mass [m] and inertias; None for the file's robot.

    Raises: InputError for other kinds of parameters.
    """
    if box is None:
        return None
    from neuralgaits.robots.parameter_box import checked_box

    kinds, checked = ("mass", "com", "inertia"), checked_box(box, "--model-error")
    others = [name for name in checked if name not in kinds]
    if others or not checked:
        found = ", ".join(others) or "none"
        raise InputError(
            f"expected --model-error of mass, com or inertia, found {found}: write "
            "mass=0.2%,com=0.4mm"
        )
    mass, com, inertia = (checked.get(kind, 0.0) for kind in kinds)
    return mass, com, inertia


@dataclass(frozen=True)
class CheckProofSettings(Settings):
    """Settings of `check-proof`: the file, the run that it must be about, and the arithmetic."""

    file: Annotated[Positional[Path], arg(metavar="FILE")]
    """Proof file, or the run folder that has one, or latest."""
    _: KW_ONLY
    run: Annotated[AnyName | None, arg(metavar="RUN"), A_PATH] = None
    """Run folder, or latest, that the proof must be about. Without it only consistency is
    checked, not which robot it is about."""
    arithmetic: Arithmetic = "doubles"
    """How boxes are bounded. doubles: with every rounding bounded, and in Arb's balls where that
    does not decide; balls: all of them in balls, which takes a hundred times as long."""
    progress: Fixed[Callable[[int, int], None] | None] = None
    """Called with (boxes checked, boxes in all) now and then."""
