"""The law and the bandwidth of a walk where none is given: those that a run's proof is about."""

from collections.abc import Sequence
from dataclasses import replace

from neuralgaits._control_laws import CONTROL_LAWS
from neuralgaits.analysis.joint_file import JointFile
from neuralgaits.analysis.run import Run
from neuralgaits.certificate.run_certificate.proved_law import proved_law
from neuralgaits.certificate.run_certificate.verified_summary import read_certificate
from neuralgaits.control import AbstractLaw
from neuralgaits.simulation.linked.config import LinkConfig
from neuralgaits.workflows.export import design_of

PROVABLE: Sequence[str] = ("fblin", "scheduled-pd")
"""Laws that level 5 can be about."""


def with_proved_law(
    run: Run, link: LinkConfig | None, joints: JointFile | None, bandwidth: float | None
) -> LinkConfig | None:
    """Return a link whose law is named: the default law of an export, if none is given.

    Args:
        run: the run.
        link: link of plant and controller; None without one.
        joints: identified joints that torques are for; None for those of the run's robot.
        bandwidth: requested double pole of output errors [rad/s]; None if none is.
    """
    if link is None or link.law:
        return link
    certificate = read_certificate(run.folder)
    if proved_law(certificate) is None:
        return replace(link, law=next(name for name, law in CONTROL_LAWS.items() if law.exported))
    return replace(link, law=design_of(run, certificate, joints, bandwidth).default_law)


def proved_bandwidth(run: Run, controller: str | AbstractLaw) -> float | None:
    """Return the bandwidth of a run's proof [rad/s] if it is about this law; None otherwise."""
    if controller not in PROVABLE:
        return None
    proved = proved_law(read_certificate(run.folder))
    return proved.bandwidth if proved is not None and proved.name == controller else None
