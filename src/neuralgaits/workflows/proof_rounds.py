"""Train until the proof succeeds: boxes that a certificate leaves open become samples.

A round certifies the gait at level 1. If boxes are left, it takes further gradient steps from the
same weights with points of these boxes in every batch, and the next round begins. The weights in
the folder are always those that the certificate in the folder is about.
"""

import time
from collections import Counter
from dataclasses import replace
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from neuralgaits._types import Array
from neuralgaits.analysis.run import Run
from neuralgaits.certificate.search.checkpoint import OpenBoxes, open_boxes
from neuralgaits.gait.policies.commanded_gait import AnyGait
from neuralgaits.records.certified import FOLDER, PROOF
from neuralgaits.records.trained import ProofHistory, ProofRound, TrainingProof
from neuralgaits.runs import names, packed
from neuralgaits.runs.hashes import file_hashes
from neuralgaits.runs.names import WEIGHTS
from neuralgaits.settings import CertifySettings, Watch
from neuralgaits.training import Boxes, Extra, Trainer, TrainState
from neuralgaits.training.training_loop import GradientSteps
from neuralgaits.workflows.certify import certify_alone

ROUNDS = 10
"""Repairs after which a training gives up."""
SHARE = 0.25
"""Gradient steps of a repair, as a share of those of the recipe."""
REPAIR = names.REPAIR
HISTORY = names.ROUNDS


class RepairState(NamedTuple):
    """State of a repair: everything that a killed run needs to resume it."""

    number: Array
    """Number of the round, from 1. int32 scalar."""
    extra: Extra
    training: TrainState


class ProofRounds:
    """Runner of the proof rounds of one run."""

    def __init__(self, trained: Run, steps: GradientSteps, watch: Watch):
        self.trained, self.folder = trained, trained.folder
        self.steps, self.watch = steps, watch

    def run(
        self, trainer: Trainer, gait: AnyGait, budget: float | None
    ) -> tuple[AnyGait, TrainingProof]:
        """Certify and repair until the proof succeeds, or rounds or budget are used up.

        Args:
            trainer: trainer that trained the gait.
            gait: trained gait; an interrupted repair resumes from its own checkpoint.
            budget: seconds for all rounds; None for no limit.

        Returns: the gait last certified, and its entry in the run's summary.
        """
        start_time = time.monotonic()
        deadline = start_time + (np.inf if budget is None else budget)
        repairer = trainer.repairing(max(round(SHARE * self.trained.spec.recipe.steps), 1))
        state = self._under_way(repairer, gait)
        history = self._rounds_before(state)
        while True:
            if state is not None:
                training = self._repair(repairer, state, trainer.steps, deadline)
                if not repairer.done(training):
                    # The weights that were certified last stay.
                    gait = self.folder.read_tree(WEIGHTS, gait)
                    break
                state = state._replace(training=training)
                gait = repairer.gait(training.best)
            number = 0 if state is None else int(state.number)
            steps = trainer.steps + number * repairer.steps
            boxes = self._certify(gait, number, steps, deadline, history)
            proved, late = history[-1].verdict == "proved", time.monotonic() >= deadline
            if proved or not boxes or number == ROUNDS or late:
                break
            before = None if state is None else state.extra
            extra = Extra.of(boxes, trainer.spec, trainer.layout, before)
            extra = jax.tree.map(jnp.asarray, extra)
            state = RepairState(jnp.asarray(number + 1, jnp.int32), extra, repairer.init(gait))
            self.folder.write_tree(REPAIR, state)
        return gait, self._summary(history, trainer.steps, time.monotonic() - start_time)

    def _under_way(self, repairer: Trainer, gait: AnyGait) -> RepairState | None:
        """Return the state of the repair in which a run was killed; None if there is none."""
        if not (self.folder.path / REPAIR).is_file():
            return None
        number = jnp.zeros((), jnp.int32)
        like = RepairState(number, Extra.shapes(repairer.layout), repairer.init(gait))
        return self.folder.read_tree(REPAIR, like)

    def _rounds_before(self, state: RepairState | None) -> list[ProofRound]:
        """Return the rounds of a killed run before the repair in which it was killed."""
        if state is None:
            return []
        rounds = ProofHistory.read(self.folder.path / HISTORY).rounds
        return [one for one in rounds if one.number < int(state.number)]

    def _repair(
        self, repairer: Trainer, state: RepairState, trained: int, deadline: float
    ) -> TrainState:
        """Take the gradient steps of one repair, or as many as the deadline allows."""
        number = int(state.number)
        before = trained + (number - 1) * repairer.steps

        def save(training: TrainState) -> None:
            self.folder.write_tree(REPAIR, state._replace(training=training))

        self.steps.forget_after(before + int(state.training.step))
        trainer = repairer.for_repair_round(state.extra, number)
        return self.steps.take(trainer, state.training, save, before=before, deadline=deadline)

    def _certify(
        self, gait: AnyGait, number: int, steps: int, deadline: float, history: list[ProofRound]
    ) -> dict[str, Boxes]:
        """Certify the gait and record the round. Returns: the boxes left open, by region."""
        path = self.folder.path
        before = file_hashes(path, (WEIGHTS,))
        self.folder.write_tree(WEIGHTS, gait)
        if file_hashes(path, (WEIGHTS,)) != before:
            # It would be kept, and is about the gait of the round before, which is gone.
            packed.remove(path / PROOF)
        left = deadline - time.monotonic()
        run = replace(self.trained, trained=gait)
        # Without any time left it still says what was to be proved.
        budget = None if left == np.inf else max(left, 1e-3)
        settings = CertifySettings(run, level=1, budget=budget, progress=self.watch.proved)
        # Whoever trains holds the run's lock.
        result = certify_alone(run, settings)
        left_open = self._open_boxes()
        proof_round = ProofRound(
            number=number,
            steps=steps,
            verdict=result.verdict,
            open_boxes=sum(len(boxes.low) for boxes in left_open),
            failing=_open_box_counts(left_open),
            smallest_margin=result.summary.least_margin,
            wall_s=result.summary.wall_s,
        )
        history.append(proof_round)
        self.folder.write_json(HISTORY, ProofHistory(tuple(history)))
        if self.watch.ended is not None:
            self.watch.ended(proof_round)
        regions: dict[str, list[OpenBoxes]] = {}
        for boxes in left_open:
            regions.setdefault(boxes.region, []).append(boxes)
        return {
            region: (np.concatenate([b.low for b in some]), np.concatenate([b.high for b in some]))
            for region, some in regions.items()
        }

    def _open_boxes(self) -> list[OpenBoxes]:
        files = sorted((self.folder.path / FOLDER).glob("boxes-*.safetensors"))
        return [boxes for boxes in map(open_boxes, files) if len(boxes.low)]

    def _summary(self, history: list[ProofRound], trained: int, wall_s: float) -> TrainingProof:
        last = history[-1]
        return TrainingProof(
            verdict=last.verdict,
            level=1,
            repairs=last.number,
            repair_steps=last.steps - trained,
            smallest_margin=last.smallest_margin,
            open_boxes=last.open_boxes,
            failing=last.failing,
            wall_s=wall_s,
        )


def _open_box_counts(left_open: list[OpenBoxes]) -> dict[str, int]:
    total: Counter[str] = Counter()
    for boxes in left_open:
        total.update(boxes.failing)
    return dict(total)
