"""Result of `simulate`: the walks, their figures and their ticks."""

from dataclasses import dataclass

from neuralgaits.logs import Log
from neuralgaits.records.simulated import SimulationSummary
from neuralgaits.simulation.episode_log import log_of
from neuralgaits.simulation.incompatible_settings import about_other_robot
from neuralgaits.simulation.walk import Walk


@dataclass(frozen=True)
class Simulation:
    """A simulation and its figures.

    Attributes:
        walk: settings and arrays of the walks.
        summary: what `simulate --json` prints.
        replaces_undisturbed: whether these disturbed walks took the place of undisturbed ones in
            the run folder, which has room for one simulation.
    """

    walk: Walk
    summary: SimulationSummary
    replaces_undisturbed: bool = False

    @property
    def logs(self) -> tuple[Log, ...]:
        """Every tick of each walk: times, joint angles, rates, torques and z.

        Empty unless `simulate` was called with `log` or `monitor`: ticks are not kept otherwise.
        """
        names = self.walk.robot.joint_names
        return tuple(
            log_of(names, record, f"episode {number}")
            for number, record in enumerate(self.walk.episodes.records)
        )

    @property
    def plant_note(self) -> str | None:
        """Return a note if another robot walked than the gait's own; None otherwise."""
        return about_other_robot(self.walk.robot, self.walk.plant.robot)

    def __repr__(self) -> str:
        """Summarise in one line how many walks stayed up, and how far they came."""
        summary = self.summary
        steps = " to ".join(
            str(n) for n in sorted({min(summary.steps_walked), max(summary.steps_walked)})
        )
        return (
            f"<Simulation of {summary.plant} under {summary.controller}: {summary.stayed} of "
            f"{len(summary.fell)} walks stayed up, {steps} steps>"
        )
