"""Whether level 5 of a run's proof is about a control law as an export has it.

The proof is about one law, one bandwidth and one clock. It names no rounding, and no safeguard of
exported controllers: those must not act.
"""

from collections.abc import Mapping
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from neuralgaits.analysis.run import Run
from neuralgaits.barriers import Gait
from neuralgaits.certificate.level_target import grid
from neuralgaits.certificate.levels.disturbed.theorem import DisturbedConstants, wider_tube
from neuralgaits.certificate.levels.full_order.theorem import FullOrderConstants
from neuralgaits.certificate.run_certificate.proved_monitor import proved_levels
from neuralgaits.certificate.run_certificate.verified_summary import CertificateReading
from neuralgaits.control import Controller, Fblin, ScheduledPd
from neuralgaits.records.law_proof import Clock, LawProof
from neuralgaits.records.level_words import DISTURBED_LEVEL, FULL_ORDER_LEVEL

ROUNDING = 1e-9
"""Largest difference of fitted gains from those of a proof file, as a share of the largest gain."""


class ProvedLaw(NamedTuple):
    """The control law that level 5 of a proof is about.

    Attributes:
        name: name of the law.
        bandwidth: double pole of its output errors [rad/s].
        hold_s: longest proved time between two ticks [s].
        clock: whether one of the ticks has to be at each touchdown.
    """

    name: str
    bandwidth: float
    hold_s: float
    clock: Clock


def proved_law(certificate: CertificateReading) -> ProvedLaw | None:
    """Return the law that level 5 of a certificate's proof is about; None if it is not proved."""
    if certificate.proof is None or DISTURBED_LEVEL not in proved_levels(certificate):
        return None
    parameters = certificate.proof.theorems.parameters
    full, disturbed = parameters[FULL_ORDER_LEVEL], parameters[DISTURBED_LEVEL]
    name = "scheduled-pd" if disturbed.scheduled else "fblin"
    clock = "free" if disturbed.free_clock else "touchdown"
    return ProvedLaw(name, full.bandwidth, disturbed.hold, clock)


def law_proofs(
    run: Run, certificate: CertificateReading, controllers: Mapping[str, Controller]
) -> tuple[LawProof, ...]:
    """Return what level 5 of a run's proof states of each control law.

    Args:
        run: the run.
        certificate: certificate of the run.
        controllers: controllers by the names of their laws.

    Returns: one for each law; none if level 5 is not proved of the run.
    """
    subject = proved_law(certificate)
    if subject is None or certificate.proof is None:
        return ()
    parameters = certificate.proof.theorems.parameters
    full, disturbed = parameters[FULL_ORDER_LEVEL], parameters[DISTURBED_LEVEL]
    proofs = []
    for name, controller in controllers.items():
        reason = f"the proof is about {subject.name}"
        if name == subject.name:
            reason = _difference(run, controller, full, disturbed)
        law = controller.law
        width = law.bandwidth if isinstance(law, Fblin | ScheduledPd) else None
        robots = disturbed.model_box
        told = subject.name, subject.hold_s, subject.clock
        proofs.append(LawProof(name, width, *told, reason, robots))
    return tuple(proofs)


def _difference(
    run: Run, controller: Controller, full: FullOrderConstants, disturbed: DisturbedConstants
) -> str | None:
    """Return how a controller differs from the one of the theorem; None if it does not."""
    law = controller.law
    if type(law) not in (Fblin, ScheduledPd):
        return "which is about the law of this package"
    assert isinstance(law, Fblin | ScheduledPd)
    if law.bandwidth != full.bandwidth:
        return f"the proof is about {full.bandwidth:g} rad/s: --bandwidth {full.bandwidth:g}"
    if law.hold_ticks != 1 or law.uses_impact_consistent_rates:
        return "its torque is not that of the measured state at every tick"
    if controller.joints is not None:
        return "its torques are for identified joints, and the proof is about the robot file's"
    if not disturbed.hold >= controller.period_s:
        proved, period = (f"{1e3 * one:.4g}" for one in (disturbed.hold, controller.period_s))
        return f"its ticks are {period} ms apart, and the proof is about {proved} ms at most"
    if isinstance(law, ScheduledPd) and not _has_gains(law, disturbed):
        return "its gains are not those of the proof file"
    if not _unchanged(run, controller, full, disturbed):
        return "it bounds z inside the set of the proof, so that its torque is another one there"
    return None


def _has_gains(law: ScheduledPd, disturbed: DisturbedConstants) -> bool:
    """Return whether a law's gains are those of a proof file, but for rounding."""
    if law.schedule is None:
        return False
    gains = law.schedule.gains
    pairs = (gains.torque, disturbed.torque_gains), (gains.inertia, disturbed.inertia_gains)
    for fitted, stated in pairs:
        own, other = np.ravel(np.asarray(fitted)), np.array(stated)
        if own.shape != other.shape:
            return False
        if not np.abs(own - other).max() <= ROUNDING * np.abs(other).max():
            return False
    return True


def _unchanged(
    run: Run, controller: Controller, full: FullOrderConstants, disturbed: DisturbedConstants
) -> bool:
    """Return whether a controller uses z as it is all over the tube of a set, at sampled states."""
    gait, schedule = run.trained, getattr(controller.law, "schedule", None)
    assert isinstance(gait, Gait)
    # States at which a controller's bounds are compared with a set.
    low, high = wider_tube(full, disturbed)
    charts = grid(np.linspace(low[0], high[0], 33), np.linspace(low[1], high[1], 5))

    @jax.vmap
    def changes(u: jax.Array) -> jax.Array:
        z = gait.z(u)
        moved = jnp.abs(controller.bounds(z) - z).max()
        return moved if schedule is None else moved + jnp.abs(schedule.chart(z) - u).max()

    return bool(np.max(np.asarray(changes(jnp.asarray(charts)))) < ROUNDING)
