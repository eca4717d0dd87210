"""One function a verb: call the workflow, judge the answer, say how to show it."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from neuralgaits.cli import screen
from neuralgaits.cli.arguments import Doctor, Inspect, Robots, Simulate, Train, Verb
from neuralgaits.errors import InputError


@dataclass(frozen=True)
class Outcome:
    """A verb's answer.

    Attributes:
        result: what `--json` prints.
        good: False if the answer is no.
        table: shows the result to a person.
    """

    result: dict[str, Any]
    good: bool
    table: Callable[[dict[str, Any]], None]

    def show(self) -> None:
        """Print the result for a person on stdout."""
        self.table(self.result)


def carry_out(verb: Verb) -> Outcome:
    """Run the verb's workflow."""
    match verb:
        case Train():
            return _train(verb)
        case Simulate():
            return _simulate(verb)
        case Inspect():
            return _inspect(verb)
        case Robots():
            return _robots()
        case Doctor():
            return _doctor()


def _train(verb: Train) -> Outcome:
    hidden = None if verb.hidden is None else _widths(verb.hidden)
    from neuralgaits.cli.progress import TrainingProgress
    from neuralgaits.robots import load_robot
    from neuralgaits.workflows.train import train

    robot = load_robot(verb.robot)
    with TrainingProgress() as progress:
        run = train(
            robot,
            spec=verb.spec,
            seed=verb.seed,
            init=verb.init,
            hidden=hidden,
            steps=verb.steps,
            out=verb.out,
            resume=verb.resume,
            progress=progress,
        )
    return Outcome(run.summary, True, screen.show_training)


def _simulate(verb: Simulate) -> Outcome:
    from neuralgaits.cli.progress import waiting
    from neuralgaits.workflows.simulate import simulate

    with waiting("walking in MuJoCo"):
        done = simulate(
            verb.run,
            plant=verb.plant,
            controller=verb.controller,
            steps=verb.steps,
            start=verb.start,
            push=verb.push,
            disturb=verb.disturb,
            seed=verb.seed,
            episodes=verb.episodes,
            log=verb.log,
            video=verb.video,
        )
    return Outcome(done.summary, not any(done.summary["fell"]), screen.show_walks)


def _inspect(verb: Inspect) -> Outcome:
    from neuralgaits.robots import load_robot
    from neuralgaits.workflows.inspect import inspect

    return Outcome(inspect(load_robot(verb.robot)), True, screen.show_robot)


def _robots() -> Outcome:
    from neuralgaits.workflows.robots import robots

    return Outcome(robots(), True, screen.show_names)


def _doctor() -> Outcome:
    from neuralgaits.workflows.doctor import doctor

    result = doctor()
    return Outcome(result, result["ok"], screen.show_findings)


def _widths(text: str) -> tuple[int, ...]:
    """Read `N,N`. Raises: InputError unless every N is a positive whole number."""
    words = [word.strip() for word in text.split(",")]
    if not all(word.isdecimal() and int(word) > 0 for word in words):
        raise InputError(
            f"expected --hidden as positive whole numbers N,N, found {text!r}: write 32,32"
        )
    return tuple(int(word) for word in words)
