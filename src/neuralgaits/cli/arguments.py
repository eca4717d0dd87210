"""The verbs and their flags: the settings of `neuralgaits.settings`, and how to show the result.

`--help` is generated from these classes.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Annotated, Literal

from tyro.conf import Positional

from neuralgaits.settings import (
    CertifySettings,
    CheckDeploySettings,
    CheckProofSettings,
    EpisodesSettings,
    ExportSettings,
    FitSettings,
    ImportGaitSettings,
    OptimiseSettings,
    RefineSettings,
    SimulateSettings,
    SweepSettings,
    TrainSettings,
    forms,
)
from neuralgaits.settings.options import arg, option
from neuralgaits.settings.shared_options import Flag, Run, Seeds, Terrain


@dataclass(frozen=True)
class OutputOptions:
    """Options that control how the result is shown."""

    json: Flag = False
    """Print one JSON object on stdout, and no progress."""
    verbose: Annotated[bool, arg(aliases=["-v"])] = False
    """Print the whole result, not its key lines; the traceback of an error."""


Output = Annotated[OutputOptions, arg(name="")]


@dataclass(frozen=True, kw_only=True)
class TrainOptions(TrainSettings):
    """Train a gait for a robot."""

    seeds: Seeds = None
    """Train seeds A, A+1, ... up to B-1 in one command, each with the same result as alone: one
    run folder each, in --out or runs/seeds/ROBOT/<time>-A; see the page
    'From a laptop to a cluster'."""
    output: Output = OutputOptions()


@dataclass(frozen=True, kw_only=True)
class OptimiseOptions(OptimiseSettings):
    """Find a gait of least cost of transport by trajectory optimisation; needs the hzd extra."""

    output: Output = OutputOptions()


@dataclass(frozen=True, kw_only=True)
class ImportGaitOptions(ImportGaitSettings):
    """Make a run of a published gait: Bezier polynomials of the joints, from a file."""

    output: Output = OutputOptions()


@dataclass(frozen=True, kw_only=True)
class SimulateOptions(SimulateSettings):
    """Walk a trained gait at full order, in MuJoCo or in Drake."""

    output: Output = OutputOptions()


@dataclass(frozen=True, kw_only=True)
class CertifyOptions(CertifySettings):
    """Prove the gait's conditions for every state of their regions."""

    output: Output = OutputOptions()


@dataclass(frozen=True, kw_only=True)
class CheckProofOptions(CheckProofSettings):
    """Check a proof file again: bound every box anew, without the search."""

    output: Output = OutputOptions()


@dataclass(frozen=True, kw_only=True)
class FitOptions(FitSettings):
    """Learn what a robot does beyond its model, from logs of a run's policy."""

    joints: Flag = False
    """Identify dry and viscous friction and rotor inertia of the joints instead, from logs with
    torques; see the page 'Friction and rotors from logs'."""
    write: Annotated[Path | None, arg(metavar="OUT.xml")] = None
    """With --joints: write the robot file with the identified rotors and damping."""
    output: Output = OutputOptions()


@dataclass(frozen=True, kw_only=True)
class RefineOptions(RefineSettings):
    """Continue training a run's policy, on dynamics corrected by what was learned."""

    output: Output = OutputOptions()


@dataclass(frozen=True, kw_only=True)
class EpisodesOptions(EpisodesSettings):
    """Walk, learn the model's error, refine the policy, and walk again."""

    output: Output = OutputOptions()


@dataclass(frozen=True, kw_only=True)
class SweepOptions(SweepSettings):
    """Train, prove and walk many combinations: robots, specs, speeds and seeds."""

    output: Output = OutputOptions()


@dataclass(frozen=True, kw_only=True)
class ExportOptions(ExportSettings):
    """Write the gait as C, FMU, ROS 2 package, ONNX or VNN-LIB, and compare it with Python."""

    output: Output = OutputOptions()


@dataclass(frozen=True, kw_only=True)
class CheckDeployOptions(CheckDeploySettings):
    """Compare a deployment file with a log of the robot in a stand, joints moved one by one."""

    output: Output = OutputOptions()


@dataclass(frozen=True)
class ReportOptions:
    """Write everything about a run into one HTML file that opens offline."""

    run: Run
    """Run folder, finished or not, or latest."""
    out: Annotated[Path | None, arg(metavar="FILE.html")] = None
    """The file; RUN/report.html if not given."""
    output: Output = OutputOptions()


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
    terrain: Terrain = None
    """Solid blocks in place of the floor, as in simulate: stones, stairs, slopes, or a file of
    stones. For a gait that takes step lengths or slopes as commands."""
    page: Annotated[PageOptions, arg(name="")] = PageOptions()
    output: Output = OutputOptions()


@dataclass(frozen=True)
class DemoOptions:
    """Watch a gait that came with the package, and its proof, on the same page: no training."""

    speed: Flag = False
    """Another gait: a slider commands its speed, and it is proved for the whole range."""
    lean: Flag = False
    """Another gait: it learns where the torso's weight is while it walks. It is proved for every
    sequence of beliefs and all robots near them."""
    page: Annotated[PageOptions, arg(name="")] = PageOptions()
    output: Output = OutputOptions()


@dataclass(frozen=True)
class InspectOptions:
    """Show the contents of a robot file, or everything that is wrong with it."""

    robot: Annotated[Positional[str], arg(metavar="ROBOT")]
    """Name of a built-in robot, or path of an MJCF file, or with --planarise of a URDF."""
    planarise: Annotated[Path | None, arg(metavar="OUT.xml")] = None
    """Write a copy that this program supports, also of a URDF or of a humanoid's section in the
    plane: flat feet become welded point feet, arms are welded, and elements that the theory ignores
    are removed; every change is listed."""
    feet: Literal["point", "flat"] = "point"
    """Feet of that copy: flat keeps the ankles and their motors."""
    weld: Annotated[Sequence[str], option("JOINT,...", partial(forms.names, "weld"), ",".join)] = ()
    """Joints to weld in that copy: at the file's first keyframe, or at zero without one."""
    output: Output = OutputOptions()


@dataclass(frozen=True)
class RobotsOptions:
    """List the built-in robots and specs, or write a robot's file to start from."""

    robot: Annotated[Positional[str | None], arg(metavar="[ROBOT]")] = None
    """Name of the built-in robot to write; all are listed without it."""
    out: Annotated[Path | None, arg(metavar="FILE.xml")] = None
    """File to write it to."""
    output: Output = OutputOptions()


@dataclass(frozen=True)
class DoctorOptions:
    """Check this machine, with a fix for each problem."""

    output: Output = OutputOptions()
