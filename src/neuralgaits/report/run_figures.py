"""Every figure of a run: its words and data, or what is missing and which command makes it."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from matplotlib.figure import Figure

from neuralgaits.analysis.box_map import BoxMap
from neuralgaits.analysis.data import GaitData, MeasuredWalk
from neuralgaits.analysis.family_data import family_data
from neuralgaits.analysis.gait_data import gait_data
from neuralgaits.analysis.residual_data import residual_data
from neuralgaits.analysis.run import Run
from neuralgaits.analysis.walk_log import measured_walk
from neuralgaits.analysis.walks_by_command import alternating, drawn, walks_under
from neuralgaits.errors import RunError
from neuralgaits.records.episode_records import CONFIG_FILE, EPISODES_SUMMARY, EpisodesSummary
from neuralgaits.records.level_words import ORBIT_LEVEL
from neuralgaits.records.simulated import LOG
from neuralgaits.records.training_config import TrainingConfig
from neuralgaits.report.certificate import ProvedOfGait
from neuralgaits.report.drawing import command_words
from neuralgaits.report.figures import (
    barrier_sketches,
    certificate_map,
    command_walks,
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

STEPS = 24
"""Number of steps of walks under commands: walks that settle have settled."""


@dataclass(frozen=True)
class Absent(Exception):
    """Raised if a figure cannot be drawn; it names the reason and the command that helps."""

    reason: str
    command: str


Made = tuple[str, Figure]
"""Caption of a figure, and the figure."""


@dataclass(frozen=True)
class RunFigures:
    """Figures of a run, each with its caption; a figure that cannot be drawn raises `Absent`.

    Attributes:
        run: open run.
        certificate: its proved results.
    """

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
    def periodic(self) -> GaitData:
        """Return the data of a gait with a periodic orbit."""
        if not self.data.periodic:
            line = repeat_commands.longer(self.run.folder)
            raise Absent("the gait has no periodic orbit between its fences: train longer", line)
        return self.data

    @property
    def path(self) -> str:
        """Return the run's folder as a command-line argument."""
        return named(self.run.path)

    def gait_tiles(self) -> Made:
        """Draw poses of one step of the orbit."""
        caption = (
            "One step of the periodic gait, from the moment a foot lands to the moment the other "
            "one does. The grey leg swings forward, the other one stands. Below are the time and "
            "the height of the swinging foot."
        )
        data = self.periodic
        return caption, gait_tiles.draw(data["orbit/skeleton"], data["orbit/t"], data.torso)

    def walk_tiles(self) -> Made:
        """Draw poses of the last step of a logged walk."""
        walk = self.walk
        if walk is None:
            log = self.run.path / LOG
            line = command("simulate", self.path, "--log", named(log))
            raise Absent("the run has no log of a walk of this gait", line)
        caption = (
            f"The last full step of a walk ({walk.source}), where feet can slip, motors saturate "
            "and contact is soft: it should look like the gait it was designed to be."
        )
        rows, torso = walk.last_step, self.run.robot.torso is not None
        since = walk.t[rows] - walk.t[rows[0]]
        return caption, gait_tiles.draw(walk.skeleton[rows], since, torso)

    def phase_portrait(self) -> Made:
        """Draw the phase portrait, with a logged walk if there is one."""
        data, walk = self.data, self.walk
        told_some = bool(self.run.config.commands)
        words = phase_portrait.caption(data, walk, self.certificate.level, told_some)
        return words, phase_portrait.draw(data, walk)

    def barrier_sketches(self) -> Made:
        """Draw the conditions on the robot itself."""
        caption = (
            "Walking is asked for as limits on the robot, not as a motion to copy: the torso stays "
            "within its wedge, the swing foot above its arc, the contact force inside the friction "
            "cone, hip and knees on the right side of their bounds. Poses and forces are those of "
            "the periodic gait."
        )
        return caption, barrier_sketches.draw(self.periodic)

    def stride(self) -> Made:
        """Draw one step over time, and a measured one if there is one."""
        return stride.caption(self.walk), stride.draw(self.periodic, self.walk)

    def margins_orbit(self) -> Made:
        """Draw the margins along the orbit, and the least of each."""
        data, proved = self.data, self.certificate.margins
        return margins_orbit.caption(data, proved), margins_orbit.draw(data, proved)

    def margins_region(self) -> Made:
        """Draw the tightest condition at each state of the tube."""
        return margins_region.CAPTION, margins_region.draw(self.data)

    def certificate_map(self) -> Made:
        """Draw the boxes of the certificate."""
        path, certificate = self.run.path / MAP, self.certificate
        if certificate.reason is None and certificate.map_fits:
            caption = (
                "Every box is a set of states on which all conditions that apply there were "
                "bounded at once. Green boxes are proved, the stronger the further from a limit, "
                "on a square-root scale; orange ones are undecided, and in cross-hatched ones a "
                "condition is violated. A green box speaks of every state in it: none lies between "
                "samples. The map is certify's own word: the proof file has its boxes, and no "
                "picture of them."
            )
            return caption, certificate_map.draw(BoxMap.read(path))
        if certificate.of_a_box or self.run.config.parameters:
            raise self.absent_for_box(1, "the map is of states of one robot")
        missing = f"{path.name} is missing in the certificate, or another one's"
        raise Absent(certificate.reason or missing, command("certify", self.path))

    def return_map(self) -> Made:
        """Draw the Poincaré map."""
        data, proved = self.periodic, self.certificate.orbit
        return return_map.caption(data, proved), return_map.draw(data, proved)

    def full_order_set(self) -> Made:
        """Draw the invariant set of level 4."""
        certificate, config = self.certificate, self.run.config
        if config.commands:
            line = repeat_commands.certifying(self.run.path, config.last_level)
            raise Absent("level 4 is about one gait, and this one takes commands", line)
        if config.on_flat_feet:
            line = repeat_commands.certifying(self.run.path, config.last_level)
            raise Absent("level 4 is about point feet, and this robot has flat ones", line)
        if certificate.full is not None:
            caption = (
                "Real joints never follow exactly. a) Over the states of the region, how large "
                "their errors may be and the robot still provably walks on for ever, with motors "
                "that do without delay what the controller asks: little near the edges and before "
                "the foot lands. b) The same along the step, against the errors that an impact "
                "leaves and how the controller lets them die out."
            )
            return caption, full_order_set.draw(self.data, certificate.full)
        if certificate.of_a_box or config.parameters:
            raise self.absent_for_box(4, "level 4 is about one robot on the floor as meant")
        raise Absent(certificate.no_full, repeat_commands.certifying(self.run.path, 4))

    def absent_for_box(self, level: int, reason: str) -> Absent:
        """Return why a figure is missing, and whether a proof about a box is the cause."""
        if self.certificate.of_a_box:
            reason += (
                ", and the run's proof about a box of them; the command proves the file's robot "
                "alone, and its proof takes the place of the box's: copy the run's folder first to "
                "have both"
            )
        return Absent(reason, repeat_commands.certifying(self.run.path, level, parameters={}))

    def loss_curves(self) -> Made:
        """Draw the losses of the training."""
        rows = self.run.folder.read_metrics()
        if not rows:
            raise Absent("the run took no training step", repeat_commands.longer(self.run.folder))
        if absent := [name for name in loss_curves.WHOLE if name not in rows[0]]:
            raise RunError(
                f"expected a column {absent[0]} in the metrics.csv of {self.run.path}, found none: "
                "restore the file, or train again"
            )
        caption = (
            "The loss says by how much the conditions are broken on random states, or are nearer "
            "to their limits than training wants them; effort is added to it. So it does not end "
            "at zero, and a small loss alone does not say that nothing is broken."
        )
        return caption, loss_curves.draw(rows)

    def residual_field(self) -> Made:
        """Draw what was learned from logs."""
        data = residual_data(self.run)
        if data is None:
            raise Absent("nothing was learned from logs of this gait", learning(self.run.path))
        return residual_field.caption(data), residual_field.draw(data)

    def rounds(self) -> Made:
        """Draw the rounds of the run's episodes."""
        folder = self.run.path.parent
        if not all((folder / file).is_file() for file in (CONFIG_FILE, EPISODES_SUMMARY)):
            plant = repeat_commands.robot_word(self.run.folder)
            heavier = "--plant", plant, "--disturb", "mass_scale=1.05"
            line = command("episodes", *heavier, "--resume", self.path)
            raise Absent("the run is no round of episodes, as with a robot 5 % heavier", line)
        caption = (
            "The gait walks on a robot that differs from its model; what differs is learned from "
            "the logs, and the policy is trained on with it. From round to round it should walk "
            "further, from more speeds, and predict its own motion better."
        )
        return caption, rounds.draw(EpisodesSummary.read(folder / EPISODES_SUMMARY))

    def family(self) -> Made:
        """Draw the gaits of a family at some of its commands."""
        data = family_data(self.run)
        if not data.periodic:
            line = repeat_commands.longer(self.run.folder)
            raise Absent("no periodic orbit was found at any command: train longer", line)
        return family.caption(data), family.draw(data)

    def command_walks(self) -> Made:
        """Draw walks under commands that repeat, and under others."""
        commands = self.run.trained.commands
        repeated, random = walks_under(
            self.run, alternating(commands, STEPS), drawn(commands, STEPS)
        )
        if not (np.isfinite(repeated.z2).all() and np.isfinite(random.z2).all()):
            line = repeat_commands.longer(self.run.folder)
            raise Absent("a walk from a fence of the region does not come back: train longer", line)
        name, proved = commands[0].name, self.certificate.level >= ORBIT_LEVEL
        words = command_walks.caption(name, repeated, proved)
        return words, command_walks.draw(name, repeated, random)


Maker = tuple[str, str, Callable[[RunFigures], Made]]
"""Name, title and drawing function of a figure."""
MAKERS: tuple[Maker, ...] = (
    (command_words.FAMILY, "A family of gaits", RunFigures.family),
    (command_words.WALKS, "Commands that repeat, and some that do not", RunFigures.command_walks),
    ("gait-tiles", "The gait", RunFigures.gait_tiles),
    ("walk-tiles", "The gait in simulation", RunFigures.walk_tiles),
    ("phase-portrait", "Every step in one picture", RunFigures.phase_portrait),
    ("barrier-sketches", "The rules of the gait", RunFigures.barrier_sketches),
    ("stride", "One step: angles, torques, forces", RunFigures.stride),
    ("margins-orbit", "How much room there is", RunFigures.margins_orbit),
    ("margins-region", "Where it is tight", RunFigures.margins_region),
    ("certificate-map", "What is proved, where", RunFigures.certificate_map),
    ("return-map", "Why the gait settles", RunFigures.return_map),
    ("full-order-set", "How far the joints may be off", RunFigures.full_order_set),
    ("loss", "How it was trained", RunFigures.loss_curves),
    ("residual-field", "What the robot taught the model", RunFigures.residual_field),
    ("rounds", "Learning on the robot", RunFigures.rounds),
)
"""Every figure that some run can have, in the order of the report."""


def makers_of(config: TrainingConfig) -> list[Maker]:
    """Return the figures that count as missing if a run with these settings lacks them."""
    never = set() if config.commands else set(command_words.FIGURES)
    never |= set() if config.as_given is None else {"loss"}
    return [one for one in MAKERS if one[0] not in never]
