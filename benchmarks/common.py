"""What the benchmarks share: trained gaits, kept between them, and a table of figures."""

import os
import sys
from pathlib import Path

import jax
import numpy as np

from neuralgaits._environment import prepare
from neuralgaits.analysis.run import Run, open_run
from neuralgaits.robots import PlanarBiped, load_robot
from neuralgaits.workflows.train import train

prepare()
# What benchmarks have from the tests: robots, forged files, walks looked at by force.
sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))
# JAX reads the environment when it is imported, which a benchmark may have done already.
jax.config.update("jax_enable_x64", True)
jax.config.update("jax_compilation_cache_dir", os.environ["JAX_COMPILATION_CACHE_DIR"])
ROOT = Path("runs") / "bench"


def trained(
    robot: str | PlanarBiped,
    seed: int,
    spec: str = "walking",
    hidden: tuple[int, ...] | None = None,
) -> Run:
    """The gait of a seed, trained now or by an earlier benchmark."""
    model = load_robot(robot) if isinstance(robot, str) else robot
    widths = "".join(f"-{width}" for width in hidden or ())
    folder = ROOT / f"{model.name}-{spec}{widths}-{seed}"
    if (folder / "summary.json").is_file():
        return open_run(folder)
    return train(model, spec, seed=seed, hidden=hidden, out=folder, root=ROOT)


def whole(name: str, default: int, *, least: int = 1) -> int:
    """A whole number that an environment variable may set; ends the process if it is none."""
    text = os.environ.get(name, str(default))
    if not (text.isdecimal() and int(text) >= least):
        print(
            f"expected {name} to be a whole number from {least} on, found {text!r}", file=sys.stderr
        )
        sys.exit(2)
    return int(text)


def seeds(default: int = 20) -> range:
    """Seeds to run: all of them, or as many as the environment variable SEEDS says."""
    return range(whole("SEEDS", default))


def show(figure: str, measured: object, asked: str = "") -> None:
    """Print one row."""
    text = f"{measured:.4g}" if isinstance(measured, float | np.floating) else str(measured)
    print(f"{figure:64s} {text:>24s}   {asked}", flush=True)
