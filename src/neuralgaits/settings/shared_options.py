"""Settings that several verbs have, and the types of Python callers.

The command line reads words, a Python caller may also pass objects: each type stands here twice, as
the caller's for a type checker, and as the word's at run time.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from tyro.conf import Fixed, Positional

from neuralgaits._called_with import PythonType
from neuralgaits._control_laws import CONTROL_LAWS
from neuralgaits.records.trained import ProofRound
from neuralgaits.settings import forms
from neuralgaits.settings.forms import Interval
from neuralgaits.settings.options import arg, option

if TYPE_CHECKING:
    from neuralgaits.analysis.run import Run as OpenRun
    from neuralgaits.barriers import GaitSpec
    from neuralgaits.control import AbstractLaw
    from neuralgaits.robots.robot_source import RobotSource
    from neuralgaits.simulation.linked.config import LinkConfig
    from neuralgaits.simulation.setup.disturbance import PlantChanges

    AnyRun = OpenRun | str | Path
    AnyRobot = RobotSource
    AnySpec = GaitSpec | str
    AnyPath = str | Path
    AnyName = str | Path
    Paths = Sequence[str | Path]
    Names = Sequence[str]
    Controller = str | AbstractLaw
    Disturb = str | Mapping[str, float] | PlantChanges
    Link = str | Mapping[str, Any] | LinkConfig
    Command = str | Mapping[str, float]
else:
    AnyRun = AnyRobot = AnySpec = AnyName = Disturb = Link = Command = str
    AnyPath = Path
    Paths = tuple[Path, ...]
    Names = tuple[str, ...]
    Controller = Literal[(*CONTROL_LAWS, "c")]

A_PATH = PythonType("str | Path | None", (str, Path))
ONE_PATH = PythonType("str | Path", (str, Path))
SOME_PATHS = PythonType("Sequence[str | Path]", (list, tuple), (str, Path))
Flag = Annotated[bool, arg()]
Run = Annotated[Positional[AnyRun], arg(metavar="RUN"), PythonType("Run | str | Path")]
A_ROBOT = PythonType("PlanarBiped | str | Path")
Robot = Annotated[Positional[AnyRobot], arg(metavar="ROBOT"), A_ROBOT]
OwnRobot = Annotated[
    Positional[AnyRobot | None],
    arg(metavar="[ROBOT]"),
    PythonType("PlanarBiped | str | Path | None"),
]
"""Optional robot; a resumed run has its own."""
Spec = Annotated[AnySpec | None, arg(metavar="SPEC"), PythonType("GaitSpec | str | None")]
Feet = Annotated[Literal["point", "flat"] | None, arg(metavar="{point,flat}")]
Init = Annotated[Literal["posture", "random"] | None, arg(metavar="{posture,random}")]
Widths = Annotated[tuple[int, ...] | None, option("N,N", forms.widths, forms.numbers_word)]
Number = Annotated[int | None, arg(metavar="N")]
Seconds = Annotated[float | None, arg(metavar="SECONDS")]
Seeds = Annotated[tuple[int, int] | None, option("A:B", forms.seeds, forms.seeds_word)]
Speed = Annotated[float | Interval | None, option("V|A:B", forms.speed, forms.speed_word)]
StepLength = Annotated[
    Interval | None, option("A:B", partial(forms.interval, "step_length"), forms.interval_word)
]
Lean = Annotated[Interval | None, option("SIZE|A:B", forms.lean, forms.interval_word)]
StepHeight = Annotated[
    Interval | None, option("A:B", partial(forms.interval, "step_height"), forms.interval_word)
]
Slope = Annotated[Interval | None, option("A:B", forms.slope, forms.slope_word)]
Box = Annotated[Mapping[str, float] | None, option("NAME=SIZE,...", forms.box, forms.box_word)]
Disturbance = Annotated[
    tuple[float, float] | Literal["learned"] | None,
    option("A,B|learned", forms.disturbance, forms.disturbance_word),
]
Gains = Annotated[tuple[float, float] | None, option("KP,KD", forms.gains, forms.numbers_word)]
_NAMED_VALUES = arg(metavar="NAME=VALUE,...")
Plant = Annotated[
    AnyRobot | None, arg(metavar="ROBOT"), PythonType("PlanarBiped | str | Path | None")
]
Law = Annotated[Controller, PythonType("str | AbstractLaw")]
Changes = Annotated[
    Disturb | None, _NAMED_VALUES, PythonType("str | Mapping[str, float] | PlantChanges | None")
]
Connection = Annotated[
    Link | None, _NAMED_VALUES, PythonType("str | Mapping[str, Any] | LinkConfig | None")
]
_A_COMMAND = PythonType("str | Mapping[str, float] | None", (str, Mapping))
Constant = Annotated[Command | None, _NAMED_VALUES, _A_COMMAND]
Folder = Annotated[AnyPath | None, arg(metavar="DIR"), A_PATH]
Columns = Annotated[AnyPath | None, arg(metavar="FILE.toml"), A_PATH]
Terrain = Annotated[AnyName | None, arg(metavar="KIND[,NAME=VALUE...]|FILE.csv"), A_PATH]
Workers = Annotated[
    int | None,
    arg(
        metavar="N",
        help="Number of processes on this machine, one thread each. A script calls this below "
        '`if __name__ == "__main__":`.',
    ),
]
Ray = Annotated[
    str | None,
    arg(
        metavar="ADDRESS|local",
        help="A Ray cluster instead: HOST:PORT of its head, auto on a machine that is part of one, "
        "or local for one of this machine; needs the ray extra.",
    ),
]
Progress = Fixed[Callable[[int, int, float], None] | None]
"""Callback with (steps done, steps in all, loss)."""
Begun = Fixed[Callable[[], None] | None]
"""Callback for when the settings are checked and the work begins."""
Root = Annotated[Fixed[Path], arg(help="Folder of the runs.")]


@dataclass(frozen=True)
class Watch:
    """Callbacks that report the progress of a training.

    Attributes:
        proved: called with the proved share so far, and the number of boxes.
        ended: called after each round of proof and repair.
        doubted: called before the training with a line about what is unusual: changes of the robot
            file that --feet makes, a robot without rotors, a speed at which no gait is likely.
        begun: called when the settings are checked and compiling begins.
    """

    proved: Callable[[float, int], None] | None = None
    ended: Callable[[ProofRound], None] | None = None
    doubted: Callable[[str], None] | None = None
    begun: Callable[[], None] | None = None


if TYPE_CHECKING:
    AnyWatch = Watch | None
else:
    AnyWatch = Annotated[Any, PythonType("Watch | None", (Watch, type(None)))]
