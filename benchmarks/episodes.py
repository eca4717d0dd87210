"""Episodes: the paper's story, and the one that a residual cannot tell.

Asked: the nominal policy falls in 9 of 10; after round 1 at least 9 of 10 walk 200 steps; after
round 2 at least 9 of 10 walk from 0.8 to 1.2 times the nominal z2; 60 s of walking a round; 120 s a
round; half the nominal policy's falls over the standard disturbances. SHIFT moves the plant's torso
further back than `amber3m-tail` has it [m].
"""

import os
from dataclasses import replace
from typing import Any, Literal

from common import ROOT, show, trained
from plants import TAIL, walked

from neuralgaits.analysis.run import Run, open_run
from neuralgaits.robots import load_robot
from neuralgaits.simulation.setup.disturbance_set import DISTURBANCE_SET
from neuralgaits.workflows.episodes import Episodes, episodes

SHIFT_M = float(os.environ.get("SHIFT", -0.02))
FLOOR_STEPS = 50
"""Steps of a walk on a disturbed plant."""


def rounds_of(
    robot: str, plant: str, controller: Literal["pd", "fblin"], disturb: dict[str, float]
) -> Episodes:
    """Two rounds, made now or by an earlier benchmark."""
    shift = disturb.get("torso_shift_m", 0.0)
    out = ROOT / f"episodes-{robot}-{plant}-{controller}{shift:+.3f}"
    if (out / "episodes.json").is_file():
        return episodes(load_robot(robot), resume=out, root=ROOT)
    start = trained(robot, 0).path
    return episodes(
        load_robot(robot),
        plant=plant,
        disturb=disturb,
        controller=controller,
        rounds=2,
        resume=start,
        out=out,
        root=ROOT,
    )


def tell(name: str, done: Episodes) -> None:
    """Print the rounds of one story."""
    asked = {0: "<= 10 %", 1: ">= 90 %", 2: ">= 90 %"}
    rounds = done.summary["rounds"]
    for entry in rounds:
        number, label = entry["round"], f"{name}, round {entry['round']}"
        steps = entry["steps_walked"]
        walked = f"{100 * entry['share_that_walks']:.0f} %, {min(steps)}-{max(steps)} steps"
        show(f"{label}: walks 200 steps from the tube", walked, asked[number])
        share = f"{100 * entry['share_of_speeds']:.0f} %"
        show(f"{label}: walks from 0.8-1.2 of the nominal z2", share, asked[2] if number else "")
        show(f"{label}: range of z2 held, of the nominal", entry["momentum_range"])
        show(f"{label}: logged time in the tube", entry["barriers"]["tube"])
        show(f"{label}: seconds of walking learned from", entry["walked_s"], "<= 60")
        errors(label, entry)
        before = rounds[number - 1]["wall_s"] if number else None
        if before and before["fit"]:
            cost = before["walk"] + before["fit"] + entry["wall_s"]["train"]
            show(f"{label}: simulation, fit and refinement s", cost, "<= 120")
    if done.summary["diverged"]:
        show(f"{name}, round {len(rounds)}", "training diverged")


def errors(label: str, entry: dict[str, Any]) -> None:
    """What the model misses, what is left, and what that is made of."""
    learned, nominal = entry["heldout_error"], entry["nominal_heldout_error"]
    if learned is None:
        show(f"{label}: nothing learned", entry["reason"][:24])
        return
    show(f"{label}: held-out error over the model's", learned / nominal, "<= 0.6")
    show(
        f"{label}: held-out error over the best table's", learned / entry["binned_floor"], "<= 1.3"
    )
    landed = entry["touchdowns"]
    for when in ("before", "after"):
        if landed[when] is not None:
            for name, value in landed[when].items():
                show(f"{label}: touchdowns {when} the reset residual, {name}", value)


def falls(run: Run, controller: str) -> int:
    """Falls over the standard disturbances, on the plant of the story."""
    total = 0
    for disturbance in DISTURBANCE_SET.values():
        moved = replace(disturbance, torso_shift_m=disturbance.torso_shift_m + SHIFT_M)
        total += sum(walked(run, TAIL, moved, controller, FLOOR_STEPS).fell)
    return total


def main() -> None:
    """Print every row."""
    story = rounds_of("amber3m", TAIL, "pd", {"torso_shift_m": SHIFT_M})
    tell(f"{TAIL} {SHIFT_M:+.2f} m, pd", story)
    nominal, refined = (open_run(story.path / f"round-{number}") for number in (0, 2))
    before, after = falls(nominal, "pd"), falls(refined, "pd")
    show("falls over the standard disturbances, nominal policy", before)
    show("falls over the standard disturbances, after two rounds", after, f"<= {before // 2}")
    tell("amber3m-paper on amber3m, fblin", rounds_of("amber3m-paper", "amber3m", "fblin", {}))


if __name__ == "__main__":
    main()
