"""Level 4: the full-order theorem for trained gaits, its constants, and the same by force.

Default gaits of AMBER-3M, one of RABBIT, and one of a free network (walking-mlp), whose outputs
do not match through the impact. Where a theorem is not proved, every obstacle is printed with
both of its sides. Walks are of the rigid model in continuous time, from states of the set, many on
its faces; MuJoCo has sampled control and compliant contact, and its shares are not asked for.

Asked: proved with epsilon >= 0.03 [h/s]; of 10,000 walks none leaves the set.
"""

import shutil
import tempfile
import time
from pathlib import Path

from common import seeds, show, trained

from neuralgaits.analysis.run import Run
from neuralgaits.certificate.levels.full_order.theorem import FullOrderConstants
from neuralgaits.certificate.proof_file.reader import read_claims
from neuralgaits.records.certified import PROOF, Conclusion
from neuralgaits.workflows.certify import certify
from support.full_order_check import check_by_force, check_in_mujoco

DEFAULT_SEEDS = 5


def prove(name: str, run: Run) -> tuple[Conclusion, FullOrderConstants | None]:
    """Prove, and print a row."""
    before = time.process_time()
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(shutil.copytree(run.path, Path(folder) / "run"))
        summary = certify(copy, level=4).summary
        shape = read_claims(copy / PROOF).theorems.full if summary.full_order_proof else None
    found = summary.levels[-1]
    seconds = f"{summary.wall_s:.1f} s, {time.process_time() - before:.1f} s of processor time"
    show(f"{name}: level 4", found.verdict, "proved")
    show(f"{name}: time of all levels, {summary.boxes} boxes", seconds)
    if found.reason is not None:
        for obstacle in found.reason.split("; "):
            print(f"    in the way: {obstacle}", flush=True)
    if shape is not None:
        show(f"{name}: epsilon, least", min(b.epsilon for b in shape.barriers), ">= 0.03")
        show(f"{name}: sqrt(V) in the set at the start of a step [rad]", shape.radius)
        show(f"{name}: sqrt(v_sym) [rad]", found.figures["sqrt v_sym"])
    return found, shape


def describe(found: Conclusion) -> None:
    """Print every constant."""
    for constant in found.constants:
        value = f"{constant.value:.6g} {constant.unit}"
        print(f"    {constant.name:24s} {value:28s} {constant.meaning}", flush=True)


def walk(name: str, run: Run, shape: FullOrderConstants) -> None:
    """Try the set by force, in the model and in MuJoCo."""
    forced = check_by_force(run, shape)
    left = f"{forced.left} of {forced.walks}"
    show(f"{name}: walks of {forced.steps} impacts that leave the set", left, "0")
    show(f"{name}: time of these walks [s]", forced.wall_s)
    for number, least in sorted(forced.least.items()):
        print(f"    least {number}: {least:.3e}", flush=True)
    mujoco = check_in_mujoco(run, shape)
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
        found, shape = prove(name, run)
        if seed == 0 and shape is not None:
            describe(found)
            walk(name, run, shape)


if __name__ == "__main__":
    main()
