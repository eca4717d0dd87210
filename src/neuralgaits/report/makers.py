"""Every figure of a run: its data, or what is missing and which command makes it."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from matplotlib.figure import Figure

from neuralgaits.analysis.data import GaitData, MeasuredWalk
from neuralgaits.analysis.family_data import family_data
from neuralgaits.analysis.gait_data import gait_data
from neuralgaits.analysis.residual_data import residual_data
from neuralgaits.analysis.run import Run
from neuralgaits.analysis.walk_log import measured_walk
from neuralgaits.errors import RunError
from neuralgaits.records.episode_records import ASKED, SUMMARY, EpisodesDone
from neuralgaits.records.simulated import LOG
from neuralgaits.report.certificate import ProvedOfGait
from neuralgaits.report.drawing import command_words
from neuralgaits.report.figures import (
    barrier_sketches,
    certificate_map,
    family,
    full_order_set,
    gait_tiles,
    loss_curves,
    margins_orbit,
    margins_region,
    phase_portrait,
    residual_field,
    return_map,
    rounds,
    stride,
)
from neuralgaits.report.page import repeat_commands
from neuralgaits.runs.names import MAP
from neuralgaits.runs.shell_words import command, learning, named


@dataclass(frozen=True)
class FigureSource:
    """Data source of the figures. Attributes: run: open run; certificate: its proved results."""

    run: Run
    certificate: ProvedOfGait

    @cached_property
    def data(self) -> GaitData:
        """Return the gait's data as arrays."""
        return gait_data(self.run)

    @cached_property
    def walk(self) -> MeasuredWalk | None:
        """Return a logged walk, or None if the run has none."""
        return measured_walk(self.run)

    @property
    def path(self) -> str:
        """Return the run's folder as a command-line argument."""
        return named(self.run.path)


@dataclass(frozen=True)
class Absent(Exception):
    """Raised if a figure cannot be drawn; it names the reason and the command that helps."""

    reason: str
    command: str


Made = tuple[str, Figure]
"""Caption of a figure, and the figure."""


def _phase_portrait(source: FigureSource) -> Made:
    data, walk = source.data, source.walk
    told_some = bool(source.run.asked.commands)
    words = phase_portrait.caption(data, walk, source.certificate.level, told_some)
    return words, phase_portrait.draw(data, walk)


def _barrier_sketches(source: FigureSource) -> Made:
    return barrier_sketches.CAPTION, barrier_sketches.draw(_periodic(source))


def _gait_tiles(source: FigureSource) -> Made:
    data = _periodic(source)
    figure = gait_tiles.draw(data["orbit/skeleton"], data["orbit/t"], data.torso)
    return gait_tiles.CAPTION, figure


def _walk_tiles(source: FigureSource) -> Made:
    walk = source.walk
    if walk is None:
        log = source.run.path / LOG
        line = command("simulate", source.path, "--log", named(log))
        raise Absent("the run has no log of a walk", line)
    rows = walk.last_step
    figure = gait_tiles.draw(
        walk.skeleton[rows], walk.t[rows] - walk.t[rows[0]], source.run.robot.torso is not None
    )
    return gait_tiles.measured_caption(walk.source), figure


def _margins_orbit(source: FigureSource) -> Made:
    data, proved = source.data, source.certificate.margins
    return margins_orbit.caption(data, proved), margins_orbit.draw(data, proved)


def _margins_region(source: FigureSource) -> Made:
    return margins_region.CAPTION, margins_region.draw(source.data)


def _certificate_map(source: FigureSource) -> Made:
    path, certificate = source.run.path / MAP, source.certificate
    if certificate.reason is None and certificate.map_fits:
        return certificate_map.CAPTION, certificate_map.draw_saved(path)
    if certificate.of_a_box or source.run.asked.parameters:
        raise _of_a_box(source, 1, "the map is of states of one robot")
    missing = f"{path.name} is missing in the certificate, or another one's"
    raise Absent(certificate.reason or missing, command("certify", source.path))


def _return_map(source: FigureSource) -> Made:
    data, proved = _periodic(source), source.certificate.orbit
    return return_map.caption(data, proved), return_map.draw(data, proved)


def _full_order_set(source: FigureSource) -> Made:
    certificate = source.certificate
    if source.run.asked.commands:
        line = repeat_commands.certifying(source.run.path, source.run.asked.last_level)
        raise Absent("level 4 is about one gait, and this one takes commands", line)
    if certificate.full is not None:
        return full_order_set.CAPTION, full_order_set.draw(source.data, certificate.full)
    if certificate.of_a_box or source.run.asked.parameters:
        raise _of_a_box(source, 4, "level 4 is about one robot on the floor as meant")
    raise Absent(certificate.no_full, repeat_commands.certifying(source.run.path, 4))


def _of_a_box(source: FigureSource, level: int, reason: str) -> Absent:
    """Return why the figure is missing, and whether a proof about a box is the cause."""
    if source.certificate.of_a_box:
        reason += (
            ", and the run's proof about a box of them; the command proves the file's robot alone, "
            "and its proof takes the place of the box's: copy the run's folder first to have both"
        )
    return Absent(reason, repeat_commands.certifying(source.run.path, level, parameters={}))


def _stride(source: FigureSource) -> Made:
    return stride.caption(source.walk), stride.draw(_periodic(source), source.walk)


def _loss(source: FigureSource) -> Made:
    rows = source.run.folder.read_metrics()
    if not rows:
        raise Absent("the run took no training step", repeat_commands.longer(source.run.folder))
    if absent := [name for name in loss_curves.WHOLE if name not in rows[0]]:
        raise RunError(
            f"expected a column {absent[0]} in the metrics.csv of {source.run.path}, found none: "
            "restore the file, or train again"
        )
    return loss_curves.CAPTION, loss_curves.draw(rows)


def _residual_field(source: FigureSource) -> Made:
    data = residual_data(source.run)
    if data is None:
        raise Absent("nothing was learned from logs of this gait", learning(source.run.path))
    return residual_field.caption(data), residual_field.draw(data)


def _rounds(source: FigureSource) -> Made:
    folder = source.run.path.parent
    if not all((folder / file).is_file() for file in (ASKED, SUMMARY)):
        heavier = (
            "--plant",
            repeat_commands.robot_word(source.run.folder),
            "--disturb",
            "mass_scale=1.05",
        )
        line = command("episodes", *heavier, "--resume", source.path)
        raise Absent("the run is no round of episodes, as with a robot 5 % heavier", line)
    return rounds.CAPTION, rounds.draw(EpisodesDone.read(folder / SUMMARY))


def _family(source: FigureSource) -> Made:
    found = family_data(source.run)
    if not found.periodic:
        line = repeat_commands.longer(source.run.folder)
        raise Absent("no periodic orbit was found at any command: train longer", line)
    return family.caption(found), family.draw(found)


def _periodic(source: FigureSource) -> GaitData:
    """Return the data of a gait with a periodic orbit."""
    if not source.data.periodic:
        line = repeat_commands.longer(source.run.folder)
        raise Absent("the gait has no periodic orbit between its fences: train longer", line)
    return source.data


Maker = tuple[str, str, Callable[[FigureSource], Any]]
"""Name, title and drawing function of a figure."""
MAKERS: tuple[Maker, ...] = (
    ("gait-tiles", gait_tiles.TITLE, _gait_tiles),
    ("walk-tiles", gait_tiles.MEASURED_TITLE, _walk_tiles),
    ("phase-portrait", phase_portrait.TITLE, _phase_portrait),
    ("barrier-sketches", barrier_sketches.TITLE, _barrier_sketches),
    ("stride", stride.TITLE, _stride),
    ("margins-orbit", margins_orbit.TITLE, _margins_orbit),
    ("margins-region", margins_region.TITLE, _margins_region),
    ("certificate-map", certificate_map.TITLE, _certificate_map),
    ("return-map", return_map.TITLE, _return_map),
    ("full-order-set", full_order_set.TITLE, _full_order_set),
    ("loss", loss_curves.TITLE, _loss),
    ("residual-field", residual_field.TITLE, _residual_field),
    ("rounds", rounds.TITLE, _rounds),
)
"""Every figure that a run can have, in the order of the report."""
OF_TRAINING = ("loss",)
"""Names of the figures that a gait without training does not have; none of them counts as
missing."""
OF_FAMILIES: tuple[Maker, ...] = ((command_words.FIGURE, family.TITLE, _family),)
"""Figures of gaits that take commands; for other gaits they do not count as missing."""
