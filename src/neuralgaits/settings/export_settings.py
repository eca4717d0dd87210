"""Settings of the verb `export`, for command line and Python call alike."""

from dataclasses import KW_ONLY, dataclass
from typing import TYPE_CHECKING, Annotated, Literal

from tyro.conf import Fixed

from neuralgaits._called_with import PythonType
from neuralgaits._checks import check_bandwidth
from neuralgaits.errors import InputError
from neuralgaits.settings.options import Settings, arg
from neuralgaits.settings.shared_options import A_PATH, ONE_PATH, AnyName, AnyPath, Begun, Flag, Run

if TYPE_CHECKING:
    AnyFormat = str
else:
    AnyFormat = Literal["c", "onnx", "fmu", "fmu2", "ros2", "vnnlib"]

Format = Annotated[AnyFormat, PythonType("str", (str,))]


@dataclass(frozen=True)
class ExportSettings(Settings):
    """Settings of `export`: which gait, in which format, for which hardware."""

    run: Run
    """Run folder, or latest."""
    out: Annotated[AnyPath, arg(metavar="DIR"), ONE_PATH]
    """Folder to write to; new or empty unless --force."""
    _: KW_ONLY
    format: Format = "c"
    """c: the controller in C99 without dependencies. onnx: the policy and its rate; needs the onnx
    extra. fmu: the controller for co-simulation by FMI 3.0. fmu2: by FMI 2.0. ros2: a
    package for ros2_control around the controller in C. vnnlib: the conditions as ONNX models and
    VNN-LIB queries, for other provers; needs the onnx extra."""
    force: Flag = False
    """Replace the files of an earlier export."""
    config: Annotated[AnyPath | None, arg(metavar="deploy.yaml"), A_PATH] = None
    """Deployment file: writes its map between motors and joints beside the controller. Without it
    a template of such a file is written."""
    joints: Annotated[AnyName | None, arg(metavar="latest|FILE.json"), A_PATH] = None
    """Friction and rotors in the torques of pd, fblin and scheduled-pd, as fit --joints identified
    them: latest for the run's own, or a file."""
    bandwidth: Annotated[float | None, arg(metavar="RAD/S")] = None
    """Double pole w of the output errors under fblin and scheduled-pd. If not given, that of the
    run's proof of level 5 for the law that it is about, else 30 and 40."""
    supervisor: Flag = False
    """With --format fmu, fmu2 or ros2: stand, walk and stop on request, and damp after a fault."""
    states: Fixed[int] = 100_000
    """Number of random states on which C and Python are compared."""
    begun: Begun = None
    """Called when the settings are checked and the work begins."""

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.bandwidth is not None:
            check_bandwidth(self.bandwidth)
        if self.states < 1:
            raise InputError(f"states: expected 1 or more, found {self.states}")
