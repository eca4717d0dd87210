"""Draw the picture of docs/paper.md: where a step of Table 1 begins, and one of `paper-walks`.

    FROM=1 SEEDS=2 .venv/bin/python docs/images/make_paper.py

Gaits are those of benchmarks/paper_ablation.py, of seed FROM, or trained here as there.
"""

# ruff: noqa: E402
# pyright: reportMissingImports=false
# The benchmark is imported from its folder.

import os
import sys
from pathlib import Path

os.environ.setdefault("SEEDS", "1")
FOLDER = Path(__file__).parent
sys.path.insert(0, str(FOLDER.parents[1] / "benchmarks"))

import jax
import jax.numpy as jnp
import numpy as np
import paper_ablation
from make_pictures import save
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from neuralgaits.barriers import Gait
from neuralgaits.gait import ZeroDynamics
from neuralgaits.report.drawing.figure import png
from neuralgaits.report.drawing.style import BLACK, BLUE, GREY, LIGHT, RED, new_figure, styled
from neuralgaits.robots import PlanarBiped, load_robot

SEED = int(os.environ.get("FROM", 0))
PANELS = {
    "table1": "a)  Table 1: steps begin\n     where nothing was asked",
    "table1+sum-guard": "b)  paper-walks: steps begin\n     where they were trained",
}
LEVELS = (0.3, 0.5, 0.7)
TIME_STEP_S = 0.002
LONGEST = 1000
HEIGHT = 3.6


def step(robot: PlanarBiped, gait: Gait, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """One step of the zero dynamics from z: its path to the touchdown, and z after the impact."""
    zd = ZeroDynamics(robot, gait.policy)

    @jax.jit
    def flow(z):
        def one(z, _):
            k1 = zd.zdot(z)
            after = z + TIME_STEP_S * zd.zdot(z + 0.5 * TIME_STEP_S * k1)
            return after, (z, zd.point(z).foot)

        return jax.lax.scan(one, z, None, length=LONGEST)[1]

    path, foot = (np.asarray(part) for part in flow(jnp.asarray(z)))
    down = (foot[:, 1] <= 0.0) & (path[:, 0] > 0.1)
    # One that never lands is shown as far as the policy was trained.
    end = int(np.argmax(down)) if down.any() else int(np.argmax(path[:, 0] > 0.25))
    return path[: end + 1], np.asarray(zd.reset(jnp.asarray(path[end])))


def panel(axes: Axes, robot: PlanarBiped, gait: Gait, title: str) -> None:
    """The trained region, steps that begin in its middle, and where their impacts land."""
    span = np.linspace(-0.2, 0.2, 50)
    phases = (span + 0.2) / 0.4
    low, high = (
        np.array([float(gait.z(jnp.array([t, level]))[1]) for t in phases]) for level in (0.0, 1.0)
    )
    axes.fill_between(span, low, high, color=LIGHT, alpha=0.6, lw=0, label="trained on")
    for level in LEVELS:
        path, after = step(robot, gait, np.asarray(gait.z(jnp.array([0.5, level]))))
        axes.plot(*path.T, color=BLUE, label="flow" if level == LEVELS[0] else None)
        axes.annotate(
            "",
            tuple(after),
            tuple(path[-1]),
            arrowprops={"arrowstyle": "-|>", "color": GREY, "linestyle": ":"},
        )
        axes.plot(*after, "o", color=RED, label="after the impact" if level == LEVELS[0] else None)
    axes.set_xlim(-0.42, 0.28)
    axes.set_ylim(0.0, 26.0)
    axes.set_xlabel("z1, hip ahead of the stance foot [m]")
    axes.set_title(title, loc="left", color=BLACK)


@styled
def drawn(robot: PlanarBiped) -> Figure:
    """Both panels."""
    figure = new_figure(HEIGHT)
    both = figure.subplots(1, 2, sharey=True)
    for axes, (name, title) in zip(both, PANELS.items(), strict=True):
        gait, _ = paper_ablation.trained(robot, paper_ablation.variant(name, robot), SEED)
        panel(axes, robot, gait, title)
    both[0].set_ylabel("z2, angular momentum about it [kg m²/s]")
    both[1].legend(loc="lower right")
    return figure


if __name__ == "__main__":
    save("paper", png(drawn(load_robot(paper_ablation.ROBOT))))
