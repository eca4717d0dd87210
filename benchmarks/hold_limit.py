"""The hold that level 5 proves, beside the holds at which walks of the same set leave it.

Default gaits of AMBER-3M under `fblin` at 50 rad/s, on both clocks. Walks are of the rigid model,
from states of the set, many on its faces; torques are held for longer and longer.

Asked: the proved hold is a third of the first one at which some walk leaves. SEEDS, WALKS and STEPS
shorten it.
"""

import shutil
import tempfile
from pathlib import Path

import numpy as np
from common import seeds, show, trained, whole

from neuralgaits.analysis.run import Run
from neuralgaits.certificate.levels.disturbed.theorem import DisturbedConstants
from neuralgaits.certificate.levels.full_order.theorem import FullOrderConstants
from neuralgaits.certificate.proof_file.reader import read_claims
from neuralgaits.records.certified import PROOF
from neuralgaits.records.law_proof import Clock
from neuralgaits.records.level_words import DISTURBED_LEVEL
from neuralgaits.workflows.certify import certify
from support.held_walk import ticker, walk_held

BANDWIDTH = 50.0
WALKS, STEPS = whole("WALKS", 300), whole("STEPS", 4)
STRIDE_S = 0.5e-3
"""From one hold that is tried to the next [s]."""
LONGEST_S = 12e-3
STEP_S = 0.5
"""About what a step takes [s]."""


def proved(run: Run, clock: Clock) -> tuple[FullOrderConstants, DisturbedConstants] | None:
    """Return set and hold of a proof of level 5; None if there is none."""
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(shutil.copytree(run.path, Path(folder) / "run"))
        result = certify(copy, level=5, bandwidth=BANDWIDTH, clock=clock)
        if result.verdict != "proved":
            return None
        theorems = read_claims(copy / PROOF).theorems
    assert theorems.full is not None
    return theorems.full, theorems.parameters[DISTURBED_LEVEL]


def of_run(words: str, run: Run, clock: Clock) -> None:
    """Try holds from the proved one on, until a walk leaves the set."""
    found = proved(run, clock)
    if found is None:
        show(f"{words}: level 5", "not proved", "proved")
        return
    shape, disturbed = found
    ticked = ticker(run, shape, free_clock=disturbed.free_clock)
    show(f"{words}: proved hold [ms]", 1e3 * disturbed.hold)
    longer = np.arange(np.ceil(disturbed.hold / STRIDE_S), round(LONGEST_S / STRIDE_S) + 1)
    for hold in (disturbed.hold, *(STRIDE_S * longer)):
        ticks = round(STEPS * STEP_S / hold)
        walked = walk_held(run, shape, float(hold), ticked, walks=WALKS, ticks=ticks)
        left = f"{walked.left:.1%} of {WALKS}, {walked.touchdowns} steps or more"
        show(f"{words}: leave at {1e3 * hold:.3f} ms", left)
        if walked.left:
            show(f"{words}: proved share of that hold", disturbed.hold / hold, ">= 0.33")
            return


def main() -> None:
    """Walk the gaits of all seeds on both clocks."""
    for seed in seeds(3):
        for clock in ("touchdown", "free"):
            of_run(f"seed {seed}, {clock} clock", trained("amber3m", seed), clock)


if __name__ == "__main__":
    main()
