"""Settings of the verbs that learn from logs: `fit`, `refine` and `episodes`."""

from collections.abc import Callable
from dataclasses import KW_ONLY, dataclass
from typing import TYPE_CHECKING, Annotated, Any, Literal

from tyro.conf import Fixed, Positional

from neuralgaits._checks import (
    check_proof_budget,
    check_rounds,
    check_seed,
    check_steps,
)
from neuralgaits.runs import RUNS_ROOT
from neuralgaits.settings.options import Settings, arg
from neuralgaits.settings.shared_options import (
    A_PATH,
    SOME_PATHS,
    AnyName,
    AnyPath,
    AnyWatch,
    Changes,
    Columns,
    Disturbance,
    Flag,
    Folder,
    Number,
    OwnRobot,
    Paths,
    Plant,
    Progress,
    Root,
    Run,
    Seconds,
)

if TYPE_CHECKING:
    from neuralgaits.residual.fitter import FitConfig
else:
    FitConfig = Any


@dataclass(frozen=True)
class FitSettings(Settings):
    """Settings of `fit`: the logs that a run's residual is learned from."""

    run: Run
    """Run folder, or latest."""
    logs: Annotated[Positional[Paths], arg(metavar="LOG.csv..."), SOME_PATHS]
    """Logs of walks in CSV or MCAP, falls included; see the page 'Your own logs'."""
    _: KW_ONLY
    columns: Columns = None
    """Names, units and signs of a robot's own columns; see the page 'Your own logs'."""
    optimizer: Literal["adam", "adamw", "nero"] = "adam"
    """Optimiser of the fit; nero is the paper's."""
    seed: Annotated[int, arg(metavar="N")] = 0
    """Seed of the split of strides, initial weights and batches."""
    config: Fixed[FitConfig | None] = None
    """Further settings of the fit; they take precedence over `optimizer`."""
    progress: Progress = None
    """Called with (step, steps, validation loss) now and then."""

    def __post_init__(self) -> None:
        super().__post_init__()
        check_seed(self.seed)


@dataclass(frozen=True)
class RefineSettings(Settings):
    """Settings of `refine`: how a policy is trained further on what was learned."""

    run: Run
    """Run folder, or latest."""
    _: KW_ONLY
    residual: Annotated[AnyPath | None, arg(metavar="FILE"), A_PATH] = None
    """File that fit wrote; the run's own if not given."""
    seed: Annotated[int, arg(metavar="N")] = 0
    """Seed of samples."""
    steps: Number = None
    """Gradient steps; a share of the spec's own number if not given."""
    disturbance: Disturbance = None
    """Bounds on the disturbance of dz besides the residual (m/s, N m), which training then allows
    for; learned: the remaining error of the residual."""
    certify: Flag = False
    """Prove the conditions (level 1) on the corrected dynamics, as train --certify does."""
    budget: Seconds = None
    """With --certify: time for proofs and further training [s]."""
    out: Folder = None
    """Run folder to make, instead of runs/ROBOT/<time>-<seed>."""
    progress: Progress = None
    """Called with (step, steps, loss) now and then."""
    watch: Fixed[AnyWatch] = None
    """Callbacks about the progress of the proof."""
    root: Root = RUNS_ROOT

    def __post_init__(self) -> None:
        super().__post_init__()
        check_seed(self.seed)
        check_steps(self.steps)
        check_proof_budget(self.certify, self.budget)


@dataclass(frozen=True)
class EpisodesSettings(Settings):
    """Settings of `episodes`: rounds of walking, learning and refining."""

    robot: OwnRobot = None
    """The model: name of a built-in robot, or path of an MJCF file; the run's own with
    --resume."""
    _: KW_ONLY
    plant: Plant = None
    """Robot that walks, in simulation."""
    disturb: Changes = None
    """Further differences between plant and model, as in torso_shift_m=-0.02."""
    controller: Annotated[Literal["pd", "fblin"] | None, arg(metavar="{pd,fblin}")] = None
    """Joint PD (if not given), or input-output linearisation with the model."""
    logs: Folder = None
    """Folder of a robot's own logs in place of a plant: CSV or MCAP files in DIR/round-0 and
    so on. The rounds stop at the first missing logs, and continue once those exist."""
    columns: Columns = None
    """With --logs: names, units and signs of these logs' columns; see the page 'Your own logs'."""
    rounds: Number = None
    """Rounds of learning and refining; 2 if not given."""
    seed: Number = None
    """Seed of everything random; 0 if not given."""
    out: Folder = None
    """Folder to make, instead of runs/episodes/ROBOT/<time>-<seed>."""
    resume: Annotated[AnyName | None, arg(metavar="RUN"), A_PATH] = None
    """Episodes to resume (their folder, or latest), or a trained run to start from."""
    steps: Fixed[int | None] = None
    """Gradient steps of training and of each refinement; those of the recipe if not given."""
    progress: Progress = None
    """Called with (step, steps, loss) now and then."""
    tell: Fixed[Callable[[int, str], None] | None] = None
    """Called with the round and the stage that begins."""
    root: Root = RUNS_ROOT

    def __post_init__(self) -> None:
        super().__post_init__()
        check_rounds(self.rounds)
