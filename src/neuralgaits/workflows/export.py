"""Write a trained gait for a robot, or its conditions for provers, and compare with Python."""

from dataclasses import dataclass, replace
from pathlib import Path

import jax
import numpy as np

from neuralgaits._version import __version__
from neuralgaits.analysis.joint_file import JointFile, read_joints
from neuralgaits.analysis.run import Run, open_run
from neuralgaits.certificate.run_certificate.proved_law import law_proofs, proved_law
from neuralgaits.certificate.run_certificate.proved_monitor import monitor_of
from neuralgaits.certificate.run_certificate.verified_summary import (
    CertificateReading,
    read_certificate,
)
from neuralgaits.control.law_by_name import at_bandwidth, exported_laws
from neuralgaits.deployment.deployment_reader import read_deployment
from neuralgaits.deployment.deployment_template import deployment_text, template
from neuralgaits.errors import InputError, SpecError
from neuralgaits.export import output_folder
from neuralgaits.export.design import Design, Origin
from neuralgaits.export.monitor_source import monitor_files
from neuralgaits.gait.policies.commanded_gait import AnyGait
from neuralgaits.records.certified import PROOF
from neuralgaits.records.exported import ExportRecord
from neuralgaits.runs.hashes import file_hashes
from neuralgaits.runs.names import ROBOT, WEIGHTS
from neuralgaits.settings import ExportSettings, called_with
from neuralgaits.simulation.setup.starts import controlled_gait, momentum_range
from neuralgaits.systems.family_tasks import task_of
from neuralgaits.systems.system_family import ProgressCallbacks
from neuralgaits.workflows.condition_queries import queries_of
from neuralgaits.workflows.deployed_run import deployed_robot, usual_gains
from neuralgaits.workflows.export_formats import MAPPED, MONITORED, QUERIED, SUPERVISED, WRITERS
from neuralgaits.workflows.export_warnings import unproved_of_export

TEMPLATE = "deploy.template.yaml"
"""Deployment file beside a controller, to be copied and edited."""
KEPT = "{} was kept: it was edited, or is of another run; delete it for a new template"


@dataclass(frozen=True)
class Export:
    """Written export. Attributes: summary: what `export --json` prints."""

    summary: ExportRecord

    @property
    def checked(self) -> bool:
        """Return whether the result was compared with Python; false without a compiler."""
        return self.summary.checked


@called_with(ExportSettings)
def export_controller(settings: ExportSettings) -> Export:
    """Write a run's gait for a robot.

    Returns: `Export`; of a family beside walkers, the record that `--json` prints.
    Raises: InputError, SpecError or RunError; MismatchError if the code differs from Python.
    """
    _refuse_settings(settings)
    if (task := task_of("export", settings)) is not None:
        return task(ProgressCallbacks(begun=settings.begun)).returned
    trained = open_run(settings.run)
    folder = Path(settings.out)
    kind = settings.format
    output_folder.refuse_used(folder, force=settings.force)
    if kind == "c" and settings.config is None:
        output_folder.refuse_stale_map(folder)
    certificate = read_certificate(trained.folder)
    _refuse_unusable(trained.trained)
    about = deployed_robot(trained)
    deployment = None if settings.config is None else read_deployment(settings.config, about)
    joints = None if settings.joints is None else _joints_for(trained, kind, settings.joints)
    if settings.begun is not None:
        settings.begun()
    # Numbers that are not finite are refused where they are written.
    with np.errstate(all="ignore"):
        design, lacking = _designed(trained, certificate, kind, joints, settings.bandwidth)
        usual = template(about, usual_gains(design))
        # A ROS 2 package always has a map: without a file that of the robot file itself.
        mapped = usual if kind == "ros2" and deployment is None else deployment
        exported = replace(design, deployment=mapped, supervised=settings.supervisor)
        files, make_record = WRITERS[kind](exported, settings.states)
    output_folder.refuse_stale_queries(folder, files)
    if kind in MAPPED and deployment is None:
        more, note = _template_file(folder, deployment_text(usual))
        files, lacking = {**files, **more}, [*lacking, *note]
    return Export(
        make_record(
            run=str(trained.path),
            format=kind,
            out=str(folder),
            files=tuple(output_folder.publish(folder, files)),
            laws=tuple(design.controllers),
            warnings=(*unproved_of_export(certificate), *lacking),
            deployment_sha256=None if deployment is None else deployment.sha256,
            bandwidth=settings.bandwidth,
            law_proofs=design.law_proofs,
        )
    )


def _template_file(folder: Path, text: str) -> tuple[dict[str, str], list[str]]:
    """Return the template to write, if none that differs is there, and a warning if one is."""
    if output_folder.differs(folder / TEMPLATE, text):
        return {}, [KEPT.format(folder / TEMPLATE)]
    return {TEMPLATE: text}, []


def _designed(
    trained: Run,
    certificate: CertificateReading,
    kind: str,
    joints: JointFile | None,
    bandwidth: float | None = None,
) -> tuple[Design, list[str]]:
    """Return everything that the files are made of, and what it lacks: laws, a monitor."""
    design = design_of(trained, certificate, joints, bandwidth)
    if kind == QUERIED:
        return replace(design, queries=queries_of(trained)), []
    # Pages say which laws gaits with commands have.
    lacking = [] if design.commands else [f"no law {reason}" for reason in design.left_out]
    if kind not in MONITORED:
        return design, lacking
    monitored, more = with_monitor(design, trained, certificate)
    return monitored, [*lacking, *more]


def _joints_for(trained: Run, kind: str, joints: str | Path) -> JointFile:
    """Return identified joints for an export. Raises: InputError for one without torques."""
    if kind not in MONITORED:
        raise InputError(
            f"--joints: expected --format {' or '.join(MONITORED)}, whose controller gives "
            f"torques, found {kind}: leave --joints out"
        )
    return read_joints(trained, joints)


def _refuse_settings(settings: ExportSettings) -> None:
    """Refuse settings that make no sense together. Raises: InputError."""
    kind = settings.format
    if kind not in WRITERS:
        raise InputError(f"unknown format {kind!r}: expected one of {', '.join(WRITERS)}")
    if settings.config is not None and kind not in MAPPED:
        raise InputError(
            f"--config: expected --format {' or '.join(MAPPED)} beside it, found {kind}: "
            "leave one of them out"
        )
    if settings.bandwidth is not None and kind not in MONITORED:
        raise InputError(
            f"--bandwidth: expected --format {' or '.join(MONITORED)}, whose controller has "
            f"control laws, found {kind}: leave --bandwidth out"
        )
    if settings.supervisor and kind not in SUPERVISED:
        remedy = "C always has the supervisor" if kind == "c" else "it has no torques"
        raise InputError(
            f"--supervisor: expected --format {' or '.join(SUPERVISED)} beside it, found {kind}: "
            f"leave --supervisor out, {remedy}"
        )


def _refuse_unusable(gait: AnyGait) -> None:
    """Refuse a gait with numbers that single precision does not hold. Raises: InputError."""
    numbers = [
        float(np.abs(leaf).max(initial=0.0)) for leaf in map(np.asarray, jax.tree.leaves(gait))
    ]
    with np.errstate(all="ignore"):
        numbers += momentum_range(gait)
    # Largest number of a gait that may be exported: C may compute in single precision.
    largest = 1e30
    if not all(abs(one) <= largest for one in numbers):
        raise InputError(
            f"expected weights and momenta of at most {largest:g}, found others: the run's policy "
            "is damaged or not trained; restore it or train again"
        )


def design_of(
    trained: Run,
    certificate: CertificateReading | None = None,
    joints: JointFile | None = None,
    bandwidth: float | None = None,
) -> Design:
    """Return everything that the exported controller of a run is made of.

    Args:
        trained: the run.
        certificate: its certificate; read if None.
        joints: identified joints that torques are for; those of the run's robot if None.
        bandwidth: double pole of output errors under laws that have one [rad/s]. If None, that of
            the proof for the law that level 5 is about, their own for the others.
    """
    certificate = certificate or read_certificate(trained.folder)
    laws = exported_laws(bandwidth)
    if bandwidth is None and (proved := proved_law(certificate)) is not None:
        laws[proved.name] = at_bandwidth(proved.name, proved.bandwidth)
    controlled = controlled_gait(trained, None if joints is None else joints.model)
    origin = _origin(trained, certificate, None if joints is None else joints.sha256)
    design = Design.of(controlled, laws, origin)
    return replace(design, law_proofs=law_proofs(trained, certificate, design.controllers))


def with_monitor(
    design: Design, trained: Run, certificate: CertificateReading
) -> tuple[Design, list[str]]:
    """Return the design with a monitor of the proved sets, and why it has none.

    Without a certificate of the run's own there is none, which another warning says.
    """
    try:
        monitored = replace(design, monitor=monitor_of(trained, certificate))
        monitor_files(monitored)
    except SpecError as error:
        return design, [f"no monitor is written: {error}"]
    if monitored.monitor is None and certificate.summary is not None:
        return design, ["no monitor is written: no level above 1 is proved of this gait"]
    return monitored, []


def _origin(trained: Run, certificate: CertificateReading, joints: str | None = None) -> Origin:
    about, verdict = certificate.summary, None
    if about is not None and certificate.proof is not None:
        verdict = f"{about.verdict} at level {about.level}"
    hashes = file_hashes(trained.path, (ROBOT, WEIGHTS, PROOF))
    return Origin(
        robot_sha256=str(hashes[ROBOT]),
        policy_sha256=str(hashes[WEIGHTS]),
        proof_sha256=None if verdict is None else hashes[PROOF],
        proof_verdict=verdict,
        spec=trained.config.spec,
        version=__version__,
        joints_sha256=joints,
    )
