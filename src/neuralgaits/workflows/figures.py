"""All figures of a run, drawn from what lies in its folder."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from matplotlib.figure import Figure

from neuralgaits.report import certificate_map, loss_curves, rounds
from neuralgaits.report.figure import Drawn, Missing, write
from neuralgaits.runs import read_arrays
from neuralgaits.workflows.certificate_figure import DATA as MAP
from neuralgaits.workflows.run import Run, open_run

FOLDER = "figures"
EPISODES, SUMMARY = "episodes.json", "summary.json"
"""Files of the folder that the rounds of episodes lie in."""


@dataclass(frozen=True)
class Sketch:
    """A figure that is not on disk yet. Attributes: see `Drawn`."""

    name: str
    title: str
    caption: str
    figure: Figure


Maker = Callable[[Run], Sketch | Missing]


def figures(run: Run | str | Path, out: str | Path | None = None) -> list[Drawn | Missing]:
    """Draw every figure of a run.

    Args:
        run: a run, its folder, or `latest`.
        out: folder for the files; `figures` in the run's folder if None.

    Returns: one entry a figure, always in the same order; `Missing` names what makes the figure.
    Raises: RunError with one line if the run is missing or damaged.
    """
    run = open_run(run)
    folder = run.path / FOLDER if out is None else Path(out)
    drawn: list[Drawn | Missing] = []
    for make in _MAKERS:
        made = make(run)
        if isinstance(made, Missing):
            drawn.append(made)
            continue
        png, svg = write(made.figure, folder, made.name)
        drawn.append(Drawn(made.name, made.title, made.caption, png, svg))
    return drawn


def _certificate_map(run: Run) -> Sketch | Missing:
    name, title = "certificate-map", "What is proved where"
    path = run.path / "certificate" / MAP
    if not path.is_file():
        return Missing(name, title, "the run has no certificate", f"neuralgaits certify {run.path}")
    arrays, words = read_arrays(path)
    caption = (
        "Every box is a set of states for which all conditions that apply there were bounded at "
        "once. Green boxes are proved, the darker the further from the limit; orange ones are "
        "open and red ones are broken."
    )
    figure = certificate_map.draw(
        arrays["corners"],
        arrays["answer"],
        arrays["margin"],
        arrays["counterexamples"],
        words.get("title", ""),
    )
    return Sketch(name, title, caption, figure)


def _loss(run: Run) -> Sketch | Missing:
    name, title = "loss", "Training"
    rows = run.folder.read_metrics()
    if not rows:
        command = f"neuralgaits train {run.folder.config['robot']}"
        return Missing(name, title, "the run took no training step", command)
    caption = (
        "The loss says by how much the conditions are broken on random states, zero being not at "
        "all. What remains at the end is effort and the distance that training keeps from the "
        "limits."
    )
    return Sketch(name, title, caption, loss_curves.draw(rows))


def _rounds(run: Run) -> Sketch | Missing:
    name, title = "rounds", "Learning on the robot"
    if not all((run.path.parent / file).is_file() for file in (EPISODES, SUMMARY)):
        robot = run.folder.config["robot"]
        command = f"neuralgaits episodes {robot} --plant ROBOT --resume {run.path}"
        return Missing(name, title, "the run is no part of episodes", command)
    caption = (
        "From round to round the gait walks on a robot that differs from its model, the difference "
        "is learned from the logs, and the policy is trained on with it."
    )
    return Sketch(name, title, caption, rounds.draw(run.folder.read_json(f"../{SUMMARY}")))


_MAKERS: tuple[Maker, ...] = (_certificate_map, _loss, _rounds)
