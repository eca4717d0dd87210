"""Inputs of a batch of episodes beside robot and control, for every loop."""

from dataclasses import dataclass

from neuralgaits.simulation.setup.command_schedule import CommandSchedule
from neuralgaits.simulation.setup.course import Courses
from neuralgaits.simulation.setup.push import Push
from neuralgaits.simulation.setup.uneven_floor import UnevenFloor


@dataclass(frozen=True)
class EpisodeInputs:
    """Inputs of all episodes: floors, pushes, commands and noise.

    Attributes:
        terrain: floor levels, before the first tick.
        push: push of each robot, at the pitch axis of its root; likewise.
        schedule: what each touchdown is to latch.
        courses: ground in place of floors, which also gives commands; None for floors.
        seed: seed of the sensors' noise.
        noisy: whether they have noise.
        first: number of the first episode, on which what is random depends.
        record: keep records and states of episode 0.
        longest: keep records of the first so many ticks of every episode.
        adapt: commands that are adapted, see `control.speed_adapter` and `control.command_belief`.
    """

    terrain: UnevenFloor
    push: Push
    schedule: CommandSchedule
    courses: Courses | None
    seed: int
    noisy: bool
    first: int
    record: bool = False
    longest: int = 0
    adapt: tuple[str, ...] = ()
