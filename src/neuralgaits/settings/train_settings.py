"""Settings of the verbs that make gaits: `train`, for one seed or many, `optimise`, `import-gait`.

Robot and spec are words on the command line, and words or objects in Python.
"""

from collections.abc import Callable
from dataclasses import KW_ONLY, dataclass, fields
from functools import partial
from pathlib import Path
from typing import Annotated

from tyro.conf import Fixed, Positional

from neuralgaits._checks import (
    check_proof_budget,
    check_seed,
    check_seeds,
    check_steps,
    check_widths,
)
from neuralgaits.errors import InputError
from neuralgaits.runs import RUNS_ROOT
from neuralgaits.settings import forms
from neuralgaits.settings.options import Settings, arg, option
from neuralgaits.settings.shared_options import (
    A_PATH,
    A_ROBOT,
    AnyName,
    AnyRobot,
    AnyWatch,
    Begun,
    Box,
    Feet,
    Flag,
    Folder,
    Init,
    Lean,
    Names,
    Number,
    OwnRobot,
    Progress,
    Robot,
    Root,
    Seconds,
    Slope,
    Spec,
    Speed,
    StepHeight,
    StepLength,
    Widths,
)


@dataclass(frozen=True)
class GaitSettings(Settings):
    """Settings of an untrained gait: everything but its seed."""

    robot: OwnRobot = None
    """Name of a built-in robot, or path of an MJCF file; the run's own with --resume."""
    spec: Spec = None
    """Specification of the gait: walking (if not given), walking-mlp, walking-flat-feet (for
    robots with flat feet, and theirs if not given), rugged (faster, for pushes and uneven floors),
    paper, paper-walks, authors, or FILE.py:NAME."""
    _: KW_ONLY
    init: Init = None
    """Start from a walking posture (if not given), or from random weights as the paper does."""
    hidden: Widths = None
    """Widths of the policy's hidden layers; the spec's own if not given."""
    steps: Number = None
    """Gradient steps; the spec's own number if not given."""
    speed: Speed = None
    """Mean speed to walk at [m/s], or a range, as in 0.55:0.90: one policy then takes a speed
    command at each touchdown."""
    step_length: StepLength = None
    """Range of commanded step lengths [m]."""
    step_height: StepHeight = None
    """Range of commanded heights of the next foothold [m], as in --step-height=-0.02:0.02."""
    slope: Slope = None
    """Range of commanded slopes of the ground, as in --slope=-5:5 [degrees]; a pair of numbers in
    Python is in radians."""
    lean: Lean = None
    """Range of commanded leans: how far the torso's centre of mass is believed to be ahead of the
    file's, as in 2cm, either way, or --lean=-0.02:0.02 [m]. Gaits are trained for torsos up to 3 mm
    from the belief, or --parameters lean=SIZE; `simulate --adapt lean` then learns it."""
    feet: Feet = None
    """Train a changed copy of the robot file, as inspect --planarise writes it, on point feet or
    flat ones; it becomes the run's robot.xml, with the list of changes at its top."""
    weld: Annotated[Names, option("JOINT,...", partial(forms.names, "weld"), ",".join)] = ()
    """With --feet: joints to weld in that copy, at the file's first keyframe or at zero."""
    parameters: Box = None
    """Box of robots that one policy must walk on, as in mass=2%,com=5mm,inertia=5%,rotor=5%:
    errors of every link's mass, centre of mass and inertia, and of every rotor; and of the floor:
    floor=5mm, footholds higher or lower than intended, and friction=0.5, the least coefficient."""

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.init not in (None, "posture", "random"):
            raise InputError(f"expected init posture or random, found {self.init!r}")
        check_widths(self.hidden)
        check_steps(self.steps)
        if self.weld and self.feet is None:
            raise InputError(
                "--weld: expected --feet point or --feet flat beside it, found none: add it"
            )
        if self.feet is not None and not isinstance(self.robot, str | Path | None):
            raise InputError(f"feet: expected the path of a robot file, found {self.robot!r}")


@dataclass(frozen=True, kw_only=True)
class TrainSettings(GaitSettings):
    """Settings of `train`: the robot, what its gait is to do, and how it is trained."""

    seed: Number = None
    """Seed of initial weights and samples; 0 if not given."""
    certify: Flag = False
    """Prove the conditions (level 1) after training; if that fails, continue training with
    samples of the boxes that are left, until the proof succeeds."""
    budget: Seconds = None
    """With --certify: time for proofs and further training [s]."""
    out: Folder = None
    """Run folder to make, instead of runs/ROBOT/<time>-<seed>."""
    resume: Annotated[AnyName | None, arg(metavar="RUN"), A_PATH] = None
    """Continue an unfinished run: its folder, or latest for the last one started. All other
    settings are the run's own."""
    progress: Progress = None
    """Called with (step, steps, loss) now and then."""
    watch: Fixed[AnyWatch] = None
    """Callbacks about the progress of the proof, and about a speed that is likely too hard."""
    root: Root = RUNS_ROOT

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.seed is not None:
            check_seed(self.seed)
        inputs = self.given
        if self.resume is not None and inputs:
            flags = ", ".join(f"--{name.replace('_', '-')}" for name in inputs)
            raise InputError(
                f"expected --resume alone, found it with {flags}: a run goes on with its own "
                "settings; drop them, or train anew without --resume"
            )
        check_proof_budget(self.certify, self.budget)

    @property
    def given(self) -> list[str]:
        """Names of the settings that a resumed run already has, and that are not the usual ones."""
        free = "robot", "resume", "progress", "watch", "root"
        rest = (one for one in fields(TrainSettings) if one.name not in free)
        return [one.name for one in rest if getattr(self, one.name) != one.default]


@dataclass(frozen=True, kw_only=True)
class TrainSeedsSettings(GaitSettings):
    """Settings of `train_seeds`, which is `train --seeds`."""

    seeds: tuple[int, int]
    """First seed, and the one after the last."""
    out: Folder = None
    """Folder that holds a run folder for each seed, named after its number;
    runs/seeds/ROBOT/<time>-<first seed> if not given."""
    progress: Progress = None
    """Called with (steps of all seeds done, in all, mean loss) now and then, from one thread at a
    time, which need not be the caller's."""
    doubted: Fixed[Callable[[str], None] | None] = None
    """Called before the training with a line about what is unusual, as `Watch.doubted`."""
    begun: Begun = None
    """Called when the settings are checked and compiling begins."""
    root: Root = RUNS_ROOT

    def __post_init__(self) -> None:
        super().__post_init__()
        check_seeds(self.seeds)


@dataclass(frozen=True)
class OptimiseSettings(Settings):
    """Settings of `optimise`: the robot, and the speed that the gait is for."""

    robot: Robot
    """Name of a built-in robot, or path of an MJCF file."""
    speed: Annotated[float, arg(metavar="V")]
    """Mean speed to walk at [m/s]."""
    _: KW_ONLY
    degree: Annotated[int, arg(metavar="N")] = 5
    """Degree of the joints' Bezier polynomials."""
    out: Folder = None
    """Run folder to make, instead of runs/ROBOT/<time>-0."""
    begun: Begun = None
    """Called when the settings are checked and the search begins."""
    root: Root = RUNS_ROOT


@dataclass(frozen=True)
class ImportGaitSettings(Settings):
    """Settings of `import-gait`: the file of the gait, and the robot."""

    file: Annotated[Positional[Path], arg(metavar="FILE.json")]
    """Joints, control points [rad] and phase, in the format of docs/optimise.md."""
    robot: Annotated[AnyRobot, arg(metavar="ROBOT"), A_ROBOT]
    """Robot that walks the gait: name of a built-in robot, or path of an MJCF file."""
    _: KW_ONLY
    name: Annotated[str | None, arg(metavar="NAME")] = None
    """Name of the gait, if the file has several."""
    out: Folder = None
    """Run folder to make, instead of runs/ROBOT/<time>-0."""
    begun: Begun = None
    """Called when the file is read and the work begins."""
    root: Root = RUNS_ROOT
