"""Level 4: the full-order theorem for trained gaits, its constants, and the same by force.

Default gaits of AMBER-3M, one of RABBIT, and one of a free network (walking-mlp), whose outputs
do not match through the impact. Where a theorem is not proved, every obstacle is printed with
both of its sides. Walks are of the rigid model in continuous time, from states of the set, many on
its faces; MuJoCo has sampled control and compliant contact, and its shares are not asked for.

Asked: proved with epsilon >= 0.03 [h/s]; of 10,000 walks none leaves the set.
"""

import time

from common import seeds, show, trained

from neuralgaits.analysis.run import Run
from neuralgaits.certificate.levels.full_order.conclude import constants
from neuralgaits.certificate.levels.full_order.of_run import model_of
from neuralgaits.certificate.levels.full_order.prove import FullOrderResult, full_order
from support.full_order_check import check_by_force, check_in_mujoco

DEFAULT_SEEDS = 5


def prove(name: str, run: Run) -> FullOrderResult:
    """Prove, and print a row."""
    before = time.process_time()
    found = full_order(model_of(run))
    seconds = f"{found.wall_s:.1f} s, {time.process_time() - before:.1f} s of processor time"
    show(f"{name}: level 4", found.conclusion.verdict, "proved")
    show(f"{name}: time, {found.boxes} boxes", seconds)
    if found.conclusion.reason is not None:
        for obstacle in found.conclusion.reason.split("; "):
            print(f"    in the way: {obstacle}", flush=True)
    if found.shape is not None:
        shape = found.shape
        show(f"{name}: epsilon, least", min(b.epsilon for b in shape.barriers), ">= 0.03")
        show(f"{name}: sqrt(V) in the set at the start of a step [rad]", shape.radius)
        show(f"{name}: sqrt(v_sym) [rad]", found.conclusion.figures["sqrt v_sym"])
    return found


def describe(found: FullOrderResult) -> None:
    """Print every constant."""
    assert found.shape is not None
    for constant in constants(found.shape):
        value = f"{constant.value:.6g} {constant.unit}"
        print(f"    {constant.name:24s} {value:28s} {constant.meaning}", flush=True)


def walk(name: str, run: Run, found: FullOrderResult) -> None:
    """Try the set by force, in the model and in MuJoCo."""
    assert found.shape is not None
    forced = check_by_force(run, found.shape)
    left = f"{forced.left} of {forced.walks}"
    show(f"{name}: walks of {forced.steps} impacts that leave the set", left, "0")
    show(f"{name}: time of these walks [s]", forced.wall_s)
    for number, least in sorted(forced.least.items()):
        print(f"    least {number}: {least:.3e}", flush=True)
    mujoco = check_in_mujoco(run, found.shape)
    title = f"{name}: MuJoCo, {mujoco.episodes} episodes of {mujoco.steps} steps:"
    show(f"{title} walk", f"{100.0 * mujoco.walked:.0f} %")
    show(f"{title} stay", f"{100.0 * mujoco.stayed:.0f} %")
    show(f"{title} stay but for 10 ms of contact", f"{100.0 * mujoco.stayed_settled:.0f} %")
    show(f"{title} ticks inside", f"{100.0 * mujoco.ticks:.1f} %")


def main() -> None:
    """Default seeds, then another robot, then a free network."""
    cases = [(f"amber3m seed {seed}", "amber3m", seed, "walking") for seed in seeds(DEFAULT_SEEDS)]
    cases += [("rabbit", "rabbit", 0, "walking"), ("walking-mlp", "amber3m", 0, "walking-mlp")]
    for name, robot, seed, spec in cases:
        run = trained(robot, seed, spec)
        found = prove(name, run)
        if seed == 0 and found.shape is not None:
            describe(found)
            walk(name, run, found)


if __name__ == "__main__":
    main()
