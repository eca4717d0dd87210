"""Settings of the verb `simulate`, for command line and Python call alike."""

from dataclasses import KW_ONLY, dataclass
from typing import Annotated, Literal

from neuralgaits._checks import check_bandwidth, check_push, check_walking_steps, check_walks
from neuralgaits.settings import forms
from neuralgaits.settings.options import Settings, arg
from neuralgaits.settings.shared_options import (
    A_PATH,
    AnyName,
    AnyPath,
    Begun,
    Box,
    Changes,
    Connection,
    Constant,
    Flag,
    Gains,
    Law,
    Plant,
    Ray,
    Run,
    Terrain,
    Workers,
)


@dataclass(frozen=True)
class SimulateSettings(Settings):
    """Settings of `simulate`: the walks, the law, the plant and what disturbs it."""

    run: Run
    """Run folder, or latest."""
    _: KW_ONLY
    plant: Plant = None
    """Robot to simulate; the one trained for if not given."""
    controller: Law = "pd"
    """pd: joint PD with the model's torques; fblin: input-output linearisation; paper: the PD of
    the paper (soft, z2 = 0); clf-qp: a quadratic program with a control Lyapunov function within
    limits of torque and friction; scheduled-pd: PD whose gains and torques are tables of the
    phase; c: the exported controller as a process of its own. To walk with the supervisor, use c
    with --link address=HOST:PORT of the firmware in examples/firmware."""
    bandwidth: Annotated[float | None, arg(metavar="RAD/S")] = None
    """Double pole w of the output errors under fblin, scheduled-pd or clf-qp. If not given, that of
    the run's proof of level 5 for the law that it is about, else 30, 40 and 30."""
    link: Connection = None
    """Settings of the connection to controller c, as in
    law=fblin,lockstep=1,loss=0.01,jitter_ms=2; address=HOST:PORT is that of a controller you have
    started."""
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
    """Impulse of a push [N s], forward positive, at most 10000 either way, over 0.1 s, within half
    a second of touchdown 5 (half-way in shorter walks); the result says how many walks it ended."""
    push_left: Annotated[float | None, arg(metavar="NS")] = None
    """The same to the left, of a walker in three dimensions [N s]."""
    disturb: Changes = None
    """Differences between plant and model, as in friction=0.4,delay_ms=4."""
    gains: Gains = None
    """Gains of the joints' drives [N m/rad, N m s/rad], as in 100,3: between two ticks each drive
    holds what it was told with a loop of its own. Joint PD control then has these gains, too."""
    drive_rate: Annotated[float | None, arg(metavar="HZ")] = None
    """Rate of the drives' loops, whole kilohertz up to 40000 [Hz]; 2000 if not given. MuJoCo takes
    a step for each, so a walk takes longer."""
    sensing: Annotated[str | None, arg(metavar="perfect|encoders[,NAME=VALUE...]")] = None
    """Measurements of the controller: perfect (the plant's own rates and hip velocity), or
    encoders (only angles, pitch and contact), as in
    encoders,bits=14,pitch_noise=0.001,delay_ms=2, which are the defaults; perfect if not
    given."""
    joints: Annotated[AnyName | None, arg(metavar="latest|FILE.json"), A_PATH] = None
    """Friction and rotors in the torques of pd, fblin and scheduled-pd, as fit --joints identified
    them: latest for the run's own, or a file; those of the run's robot file if not given."""
    parameters: Box = None
    """Walk another robot each time, drawn from this box around the run's own, as in
    mass=2%,com=5mm,inertia=5%; with floor=5mm and friction=0.5 on such a floor."""
    command: Constant = None
    """Constant command of a gait that takes commands, as in speed=0.7 or slope=3 [degrees]; the
    middle of its ranges if not given. A mapping in Python is in SI units."""
    adapt: Annotated[str | None, arg(metavar="NAME,...")] = None
    """Adapt commands at each touchdown, within their ranges: speed, until the robot walks as told;
    lean and slope, to what the joint angles show of them, as in speed,lean or speed,lean,slope.
    For a gait that takes them as commands."""
    commands: Annotated[AnyName | None, arg(metavar="FILE.csv|random"), A_PATH] = None
    """Command for each step: a file with a row a step, step,speed[m/s],..., or new random
    commands at each touchdown."""
    terrain: Terrain = None
    """Solid blocks in place of the floor, seen by the robot one step ahead: stones, stairs or
    slopes, as in stones,width=0.1 or stairs,rise=-0.05, or a row a stone,
    stone,x[m],z[m],width[m]. For a gait that takes step lengths or slopes as commands."""
    seed: Annotated[int, arg(metavar="N")] = 0
    """Seed of random starts, terrain and disturbances."""
    episodes: Annotated[int, arg(metavar="N")] = 1
    """Number of walks."""
    workers: Workers = None
    ray: Ray = None
    log: Annotated[AnyPath | None, arg(metavar="FILE.csv"), A_PATH] = None
    """Write the first walk's log; further walks get FILE-1.csv, FILE-2.csv, ... beside it. A
    name that ends in .mcap asks for MCAP, which needs the mcap extra."""
    video: Annotated[AnyPath | None, arg(metavar="FILE.mp4"), A_PATH] = None
    """Write a video of the first walk; needs the video extra."""
    monitor: Flag = False
    """Say for which share of the ticks the controller's state was in the sets that the run's proof
    is about, by level; needs a run that is proved to level 2 or more."""
    begun: Begun = None
    """Called when the settings are checked and the walks begin."""

    def __post_init__(self) -> None:
        super().__post_init__()
        check_walking_steps(self.steps)
        check_walks(self.episodes, self.seed, self.push)
        if self.bandwidth is not None:
            check_bandwidth(self.bandwidth)
        check_push(self.push_left)
        if self.adapt is not None:
            object.__setattr__(self, "adapt", forms.adapted(self.adapt))

    @property
    def adapted_commands(self) -> tuple[str, ...]:
        """Names of the commands that are adapted."""
        return () if self.adapt is None else tuple(self.adapt.split(","))
