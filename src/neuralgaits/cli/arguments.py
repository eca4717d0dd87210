"""The verbs and their flags, as typed data. `--help` is generated from this file."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import tyro
from tyro.conf import Positional

from neuralgaits._control_laws import CONTROL_LAWS
from neuralgaits.records.levels import WORDS


def arg(**settings: Any) -> Any:
    """Return `tyro.conf.arg` whose help omits a default of None or False."""
    return tyro.conf.arg(help_behavior_hint=_default, **settings)


def _default(label: str) -> str:
    return "" if label in ("None", "False") else f"(default: {label})"


if TYPE_CHECKING:
    Controller = str
else:
    Controller = Literal[(*CONTROL_LAWS, "c")]
Flag = Annotated[bool, arg()]
Robot = Annotated[Positional[str], arg(metavar="ROBOT")]
Run = Annotated[Positional[str], arg(metavar="RUN")]
OwnRobot = Annotated[Positional[str | None], arg(metavar="[ROBOT]")]
"""Optional robot; a resumed run has its own."""


@dataclass(frozen=True)
class OutputOptions:
    """Options that control how the result is shown."""

    json: Flag = False
    """Print one JSON object on stdout, and no progress."""
    verbose: Annotated[bool, arg(aliases=["-v"])] = False
    """Print the whole result, not its key lines; the traceback of an error."""


@dataclass(frozen=True)
class WorkerOptions:
    """Options that choose where many tasks run."""

    workers: Annotated[int | None, arg(metavar="N")] = None
    """Number of processes on this machine, one thread each."""
    ray: Annotated[str | None, arg(metavar="ADDRESS|local")] = None
    """A Ray cluster instead: HOST:PORT of its head, auto on a machine that is part of one, or local
    for one of this machine; needs the ray extra."""


@dataclass(frozen=True)
class TrainOptions:
    """Train a gait for a robot."""

    robot: OwnRobot = None
    """Name of a built-in robot, or path of an MJCF file; the run's own with --resume."""
    spec: Annotated[str | None, arg(metavar="SPEC")] = None
    """Specification of the gait: walking (if not given), walking-mlp, rugged (faster,
    for pushes and uneven floors), paper, paper-walks, authors, or FILE.py:NAME."""
    init: Annotated[Literal["posture", "random"] | None, arg(metavar="{posture,random}")] = None
    """Start from a walking posture (if not given), or from random weights as the paper does."""
    hidden: Annotated[str | None, arg(metavar="N,N")] = None
    """Widths of the policy's hidden layers; the spec's own if not given."""
    seed: Annotated[int | None, arg(metavar="N")] = None
    """Seed of initial weights and samples; 0 if not given."""
    seeds: Annotated[str | None, arg(metavar="A:B")] = None
    """Train seeds A, A+1, ... up to B-1 in one command, each with the same result as alone: one
    run folder each, in --out or runs/seeds/ROBOT/<time>-A; see the page
    'From a laptop to a cluster'."""
    steps: Annotated[int | None, arg(metavar="N")] = None
    """Gradient steps; the spec's own number if not given."""
    speed: Annotated[str | None, arg(metavar="V|A:B")] = None
    """Mean speed to walk at [m/s], or a range, as in 0.55:0.90: one policy then takes a speed
    command at each touchdown."""
    step_length: Annotated[str | None, arg(metavar="A:B")] = None
    """Range of commanded step lengths [m]."""
    step_height: Annotated[str | None, arg(metavar="A:B")] = None
    """Range of commanded heights of the next foothold [m], as in --step-height=-0.02:0.02."""
    slope: Annotated[str | None, arg(metavar="A:B")] = None
    """Range of commanded slopes of the ground [degrees], as in --slope=-5:5."""
    parameters: Annotated[str | None, arg(metavar="NAME=SIZE,...")] = None
    """Box of robots that one policy must walk on, as in mass=2%,com=5mm,inertia=5%,rotor=5%:
    errors of every link's mass, centre of mass and inertia, and of every rotor; and of the floor:
    floor=5mm, footholds higher or lower than intended, and friction=0.5, the least coefficient."""
    certify: Flag = False
    """Prove the conditions (level 1) after training; if that fails, continue training with
    samples of the boxes that are left, until the proof succeeds."""
    budget: Annotated[float | None, arg(metavar="SECONDS")] = None
    """With --certify: time for proofs and further training."""
    out: Annotated[Path | None, arg(metavar="DIR")] = None
    """Run folder to make, instead of runs/ROBOT/<time>-<seed>."""
    resume: Annotated[str | None, arg(metavar="RUN")] = None
    """Continue an unfinished run: its folder, or latest for the last one started. All other
    settings are the run's own."""
    output: Annotated[OutputOptions, arg(name="")] = OutputOptions()


@dataclass(frozen=True)
class OptimiseOptions:
    """Find a gait of least cost of transport by trajectory optimisation; needs the hzd extra."""

    robot: Robot
    """Name of a built-in robot, or path of an MJCF file."""
    speed: Annotated[float, arg(metavar="V")]
    """Mean speed to walk at [m/s]."""
    degree: Annotated[int, arg(metavar="N")] = 5
    """Degree of the joints' Bezier polynomials."""
    out: Annotated[Path | None, arg(metavar="DIR")] = None
    """Run folder to make, instead of runs/ROBOT/<time>-0."""
    output: Annotated[OutputOptions, arg(name="")] = OutputOptions()


@dataclass(frozen=True)
class ImportGaitOptions:
    """Make a run of a published gait: Bezier polynomials of the joints, from a file."""

    file: Annotated[Positional[Path], arg(metavar="FILE.json")]
    """Joints, control points [rad] and phase, in the format of docs/optimise.md."""
    robot: Annotated[str, arg(metavar="ROBOT")]
    """Robot that walks the gait: name of a built-in robot, or path of an MJCF file."""
    name: Annotated[str | None, arg(metavar="NAME")] = None
    """Name of the gait, if the file has several."""
    out: Annotated[Path | None, arg(metavar="DIR")] = None
    """Run folder to make, instead of runs/ROBOT/<time>-0."""
    output: Annotated[OutputOptions, arg(name="")] = OutputOptions()


@dataclass(frozen=True)
class SimulateOptions:
    """Walk a trained gait at full order, in MuJoCo or in Drake."""

    run: Run
    """Run folder, or latest."""
    plant: Annotated[str | None, arg(metavar="ROBOT")] = None
    """Robot to simulate; the one trained for if not given."""
    controller: Controller = "pd"
    """Joint PD, input-output linearisation, the PD of the paper (soft, z2 = 0), a quadratic program
    with a control Lyapunov function within limits of torque and friction, or the exported
    controller as a process of its own."""
    link: Annotated[str | None, arg(metavar="NAME=VALUE,...")] = None
    """Settings of the connection to controller c, as in
    law=fblin,lockstep=1,loss=0.01,jitter_ms=2."""
    steps: Annotated[int, arg(metavar="N")] = 50
    """Number of walking steps in each episode."""
    engine: Annotated[Literal["native", "jax"] | None, arg(metavar="{native,jax}")] = None
    """Compiled code, or JAX, which is the reference and many times slower; native if not given
    and if there is a C compiler."""
    simulator: Literal["mujoco", "drake"] = "mujoco"
    """Simulator of the plant: MuJoCo, or Drake with its own dynamics and contact, to see whether
    the two agree; needs the drake extra."""
    start: Literal["centre", "region", "fixed-point"] = "centre"
    """Initial states: middle of the region, random in it, or on the periodic orbit."""
    push: Annotated[float | None, arg(metavar="NS")] = None
    """Impulse of a forward push [N s], over 0.1 s, within half a second of touchdown 5; the result
    says how many walks it ended."""
    disturb: Annotated[str | None, arg(metavar="NAME=VALUE,...")] = None
    """Differences between plant and model, as in friction=0.4,delay_ms=4."""
    sensing: Annotated[str | None, arg(metavar="perfect|encoders[,NAME=VALUE...]")] = None
    """Measurements of the controller: perfect (the plant's own rates and hip velocity), or
    encoders (only angles, pitch and contact), as in
    encoders,bits=14,pitch_noise=0.001,delay_ms=2, which are the defaults; perfect if not
    given."""
    parameters: Annotated[str | None, arg(metavar="NAME=SIZE,...")] = None
    """Walk another robot each time, drawn from this box around the run's own, as in
    mass=2%,com=5mm,inertia=5%; with floor=5mm and friction=0.5 on such a floor."""
    command: Annotated[str | None, arg(metavar="NAME=VALUE,...")] = None
    """Constant command of a gait that takes commands, as in speed=0.7 or slope=3 [degrees]; the
    middle of its ranges if not given."""
    commands: Annotated[str | None, arg(metavar="FILE.csv|random")] = None
    """Command for each step: a file with a row a step, step,speed[m/s],..., or new random
    commands at each touchdown."""
    terrain: Annotated[str | None, arg(metavar="KIND[,NAME=VALUE...]|FILE.csv")] = None
    """Solid blocks in place of the floor, seen by the robot one step ahead: stones, stairs or
    slopes, as in stones,width=0.1 or stairs,rise=-0.05, or a row a stone,
    stone,x[m],z[m],width[m]. For a gait that takes step lengths or slopes as commands."""
    seed: Annotated[int, arg(metavar="N")] = 0
    """Seed of random starts, terrain and disturbances."""
    episodes: Annotated[int, arg(metavar="N")] = 1
    """Number of walks."""
    pool: Annotated[WorkerOptions, arg(name="")] = WorkerOptions()
    log: Annotated[Path | None, arg(metavar="FILE.csv")] = None
    """Write the first walk's log; further walks get FILE-1.csv, FILE-2.csv, ... beside it."""
    video: Annotated[Path | None, arg(metavar="FILE.mp4")] = None
    """Write a video of the first walk; needs the video extra."""
    output: Annotated[OutputOptions, arg(name="")] = OutputOptions()


_LEVELS = (
    f"What to prove; {', '.join(f'{n}: {words.asks}' for n, words in WORDS.items())}. 3 if not "
    "given, which is the most with parameters."
)


@dataclass(frozen=True)
class CertifyOptions:
    """Prove the gait's conditions for every state of their regions."""

    run: Run
    """Run folder, or latest."""
    level: Annotated[int | None, arg(metavar="N", help=_LEVELS)] = None
    disturbance: Annotated[str | None, arg(metavar="A,B|learned")] = None
    """Bounds on the disturbance of dz at level 2 (m/s, N m), none if not given; learned: the
    remaining error of the run's residual."""
    parameters: Annotated[str | None, arg(metavar="NAME=SIZE,...|none")] = None
    """Box of robots to prove levels 1 to 3 for, as in mass=2%,com=5mm,inertia=5%,floor=5mm; that
    of the run if not given; none: the robot of the file alone, on its floor."""
    bandwidth: Annotated[float | None, arg(metavar="RAD/S")] = None
    """Double pole w of the outputs at levels 4 and 5: that of fblin, 30, if not given. If given,
    --level 4 is about the largest set that the search yields, in a norm of its own: 20 suits
    AMBER-3M."""
    budget: Annotated[float | None, arg(metavar="SECONDS")] = None
    """Stop after this time; the result so far is kept."""
    within: Annotated[str | None, arg(metavar="NAME=LOW:HIGH,...")] = None
    """For a gait that takes commands, prove these ranges only, as in speed=0.70:0.72 or
    slope=-1:1 [degrees]; the run as a whole stays undecided."""
    resume: Flag = False
    """Continue with the boxes of the last certificate."""
    pool: Annotated[WorkerOptions, arg(name="")] = WorkerOptions()
    output: Annotated[OutputOptions, arg(name="")] = OutputOptions()


@dataclass(frozen=True)
class CheckProofOptions:
    """Check a proof file again, with ball arithmetic only."""

    file: Annotated[Positional[Path], arg(metavar="FILE")]
    """Proof file, or the run folder that has one, or latest."""
    run: Annotated[str | None, arg(metavar="RUN")] = None
    """Run folder, or latest, that the proof must be about. Without it only consistency is
    checked, not which robot it is about."""
    output: Annotated[OutputOptions, arg(name="")] = OutputOptions()


@dataclass(frozen=True)
class FitOptions:
    """Learn what a robot does beyond its model, from logs of a run's policy."""

    run: Run
    """Run folder, or latest."""
    logs: Annotated[Positional[tuple[Path, ...]], arg(metavar="LOG.csv...")]
    """Logs of walks, falls included; see the page 'Your own logs'."""
    columns: Annotated[Path | None, arg(metavar="FILE.toml")] = None
    """Names, units and signs of a robot's own columns; see the page 'Your own logs'."""
    optimizer: Literal["adam", "adamw", "nero"] = "adam"
    """Optimiser of the fit; nero is the paper's."""
    seed: Annotated[int, arg(metavar="N")] = 0
    """Seed of the split of strides, initial weights and batches."""
    output: Annotated[OutputOptions, arg(name="")] = OutputOptions()


@dataclass(frozen=True)
class RefineOptions:
    """Continue training a run's policy, on dynamics corrected by what was learned."""

    run: Run
    """Run folder, or latest."""
    residual: Annotated[Path | None, arg(metavar="FILE")] = None
    """File that fit wrote; the run's own if not given."""
    seed: Annotated[int, arg(metavar="N")] = 0
    """Seed of samples."""
    steps: Annotated[int | None, arg(metavar="N")] = None
    """Gradient steps; a share of the spec's own number if not given."""
    disturbance: Annotated[str | None, arg(metavar="A,B|learned")] = None
    """Bounds on the disturbance of dz besides the residual (m/s, N m), which training then allows
    for; learned: the remaining error of the residual."""
    certify: Flag = False
    """Prove the conditions (level 1) on the corrected dynamics, as train --certify does."""
    budget: Annotated[float | None, arg(metavar="SECONDS")] = None
    """With --certify: time for proofs and further training."""
    out: Annotated[Path | None, arg(metavar="DIR")] = None
    """Run folder to make, instead of runs/ROBOT/<time>-<seed>."""
    output: Annotated[OutputOptions, arg(name="")] = OutputOptions()


@dataclass(frozen=True)
class EpisodesOptions:
    """Walk, learn the model's error, refine the policy, and walk again."""

    robot: OwnRobot = None
    """The model: name of a built-in robot, or path of an MJCF file; the run's own with
    --resume."""
    plant: Annotated[str | None, arg(metavar="ROBOT")] = None
    """Robot that walks, in simulation."""
    disturb: Annotated[str | None, arg(metavar="NAME=VALUE,...")] = None
    """Further differences between plant and model, as in torso_shift_m=-0.02."""
    controller: Annotated[Literal["pd", "fblin"] | None, arg(metavar="{pd,fblin}")] = None
    """Joint PD (if not given), or input-output linearisation with the model."""
    logs: Annotated[Path | None, arg(metavar="DIR")] = None
    """Folder of a robot's own logs in place of a plant: DIR/round-0/*.csv and so on."""
    columns: Annotated[Path | None, arg(metavar="FILE.toml")] = None
    """With --logs: names, units and signs of these logs' columns; see the page 'Your own logs'."""
    rounds: Annotated[int | None, arg(metavar="N")] = None
    """Rounds of learning and refining; 2 if not given."""
    seed: Annotated[int | None, arg(metavar="N")] = None
    """Seed of everything random; 0 if not given."""
    out: Annotated[Path | None, arg(metavar="DIR")] = None
    """Folder to make, instead of runs/episodes/ROBOT/<time>-<seed>."""
    resume: Annotated[str | None, arg(metavar="RUN")] = None
    """Episodes to resume (their folder, or latest), or a trained run to start from."""
    output: Annotated[OutputOptions, arg(name="")] = OutputOptions()


@dataclass(frozen=True)
class SweepOptions:
    """Train, prove and walk many combinations: robots, specs, speeds and seeds."""

    robots: Annotated[Positional[tuple[str, ...]], arg(metavar="[ROBOT...]")] = ()
    """Names of built-in robots, or paths of MJCF files; the sweep's own with --resume."""
    specs: Annotated[str | None, arg(metavar="S,...")] = None
    """Specs, as for train; walking if not given."""
    speeds: Annotated[str | None, arg(metavar="V|A:B,...")] = None
    """Speeds to walk at [m/s], or ranges of them, as for train --speed."""
    seeds: Annotated[str | None, arg(metavar="A:B")] = None
    """Seeds A, A+1, ... up to B-1, or one; 0 if not given."""
    steps: Annotated[int | None, arg(metavar="N")] = None
    """Gradient steps of each training; the spec's own number if not given."""
    certify: Annotated[int | None, arg(metavar="LEVEL")] = None
    """Prove each run up to this level; no proof if not given."""
    budget: Annotated[float | None, arg(metavar="SECONDS")] = None
    """With --certify: time for each proof. The result then depends on the machine."""
    controllers: Annotated[str | None, arg(metavar="C,...")] = None
    """Control laws to walk with: pd (if not given), fblin, paper, clf-qp."""
    disturbances: Annotated[str | None, arg(metavar="FILE|standard|none")] = None
    """Disturbances to walk under, besides none: the standard eighteen (if not given), or those
    of a TOML file; see the page 'From a laptop to a cluster'."""
    walks: Annotated[int | None, arg(metavar="N")] = None
    """Number of walks of 25 steps under each disturbance; 4 if not given."""
    pool: Annotated[WorkerOptions, arg(name="")] = WorkerOptions()
    out: Annotated[Path | None, arg(metavar="DIR")] = None
    """Folder of the sweep; runs/sweeps/<time>-<first seed> if not given."""
    resume: Flag = False
    """Continue the sweep in --out, if there is one; finished rows are kept."""
    output: Annotated[OutputOptions, arg(name="")] = OutputOptions()


@dataclass(frozen=True)
class ExportOptions:
    """Write the gait for a robot, as C or ONNX, and compare the result with Python."""

    run: Run
    """Run folder, or latest."""
    out: Annotated[Path, arg(metavar="DIR")]
    """Folder to write to; new or empty unless --force."""
    format: Literal["c", "onnx"] = "c"
    """c: the controller in C99 without dependencies. onnx: the policy and its rate; needs the onnx
    extra."""
    force: Flag = False
    """Replace the files of an earlier export."""
    output: Annotated[OutputOptions, arg(name="")] = OutputOptions()


@dataclass(frozen=True)
class ReportOptions:
    """Write everything about a run into one HTML file that opens offline."""

    run: Run
    """Run folder, finished or not, or latest."""
    out: Annotated[Path | None, arg(metavar="FILE.html")] = None
    """The file; RUN/report.html if not given."""
    output: Annotated[OutputOptions, arg(name="")] = OutputOptions()


@dataclass(frozen=True)
class PageOptions:
    """Address at which a live page is served."""

    port: Annotated[int | None, arg(metavar="N")] = None
    """Port to listen on; a free one if not given."""
    host: Annotated[str | None, arg(metavar="ADDRESS")] = None
    """Address to bind to; only this machine reaches the page if not given."""
    no_browser: Flag = False
    """Print the address only."""


@dataclass(frozen=True)
class ViewOptions:
    """Watch a gait walk, push it, tilt its floor, and put it into any state: a live page."""

    run: Run
    """Run folder, or latest."""
    terrain: Annotated[str | None, arg(metavar="KIND[,NAME=VALUE...]|FILE.csv")] = None
    """Solid blocks in place of the floor, as in simulate: stones, stairs, slopes, or a file of
    stones. For a gait that takes step lengths or slopes as commands."""
    page: Annotated[PageOptions, arg(name="")] = PageOptions()
    output: Annotated[OutputOptions, arg(name="")] = OutputOptions()


@dataclass(frozen=True)
class DemoOptions:
    """Watch a gait that came with the package, and its proof, on the same page: no training."""

    speed: Flag = False
    """Another gait: a slider commands its speed, and it is proved for the whole range."""
    page: Annotated[PageOptions, arg(name="")] = PageOptions()
    output: Annotated[OutputOptions, arg(name="")] = OutputOptions()


@dataclass(frozen=True)
class InspectOptions:
    """Show the contents of a robot file, and what is wrong with it."""

    robot: Robot
    """Name of a built-in robot, or path of an MJCF file."""
    planarise: Annotated[Path | None, arg(metavar="OUT.xml")] = None
    """Write a copy that this program supports: flat feet become welded point feet, and elements
    that the theory ignores are removed; every change is listed."""
    output: Annotated[OutputOptions, arg(name="")] = OutputOptions()


@dataclass(frozen=True)
class RobotsOptions:
    """List the built-in robots and specs, or write a robot's file to start from."""

    robot: Annotated[Positional[str | None], arg(metavar="[ROBOT]")] = None
    """Name of the built-in robot to write; all are listed without it."""
    out: Annotated[Path | None, arg(metavar="FILE.xml")] = None
    """File to write it to."""
    output: Annotated[OutputOptions, arg(name="")] = OutputOptions()


@dataclass(frozen=True)
class DoctorOptions:
    """Check this machine, with a fix for each problem."""

    output: Annotated[OutputOptions, arg(name="")] = OutputOptions()
