"""Design of an exported controller: its parts and their origin."""

from collections.abc import Mapping
from dataclasses import dataclass

import jax.numpy as jnp
import numpy as np

from neuralgaits._quick_jit import quick_filter_jit
from neuralgaits._types import Actuated, Float
from neuralgaits.analysis.state_monitor import StateMonitor
from neuralgaits.control import AbstractLaw, Controller
from neuralgaits.control.controlled_gait import ControlledGait
from neuralgaits.control.measurement import by_leg
from neuralgaits.control.safeguard import SafeguardConfig
from neuralgaits.deployment.deployment_file import DeploymentFile
from neuralgaits.errors import SpecError
from neuralgaits.export.condition_query import ConditionQuery
from neuralgaits.gait.commands import Commands
from neuralgaits.gait.joint_inertia import JointResponse
from neuralgaits.gait.policies.commanded_gait import AnyGait
from neuralgaits.records.law_proof import LawProof

_by_leg = quick_filter_jit(by_leg)


@dataclass(frozen=True)
class Origin:
    """Hashes and names that tie C to a run.

    Attributes:
        robot_sha256: sha256 of the robot file's text.
        policy_sha256: sha256 of the weights' file.
        proof_sha256: sha256 of the proof file, None without one.
        proof_verdict: result of that proof, as in `proved at level 3`; None without one.
        spec: name of the gait specification.
        version: version of this package.
        joints_sha256: sha256 of the file of identified joints; None without.
    """

    robot_sha256: str
    policy_sha256: str
    proof_sha256: str | None
    proof_verdict: str | None
    spec: str
    version: str
    joints_sha256: str | None = None


@dataclass(frozen=True, eq=False)
class Design:
    """All parts of an exported controller.

    Attributes:
        gait: policy and region, or a family of them that takes commands.
        controllers: controllers by name of the law; alike but for the law.
        safeguard: thresholds of faults.
        origin: origin of the design.
        monitor: sets that are proved of the gait; None without.
        deployment: deployment file that was read; None without.
        supervised: whether an FMU or a ROS 2 package stands, walks and stops on request; the C
            controller always can.
        queries: conditions for other provers; empty in formats of a controller.
        left_out: laws that the gait cannot have, each with the reason.
        law_proofs: whether level 5 of the proof is about each law; empty if it is not proved.
    """

    gait: AnyGait
    controllers: Mapping[str, Controller]
    safeguard: SafeguardConfig
    origin: Origin
    monitor: StateMonitor | None = None
    deployment: DeploymentFile | None = None
    supervised: bool = False
    queries: tuple[ConditionQuery, ...] = ()
    left_out: tuple[str, ...] = ()
    law_proofs: tuple[LawProof, ...] = ()

    @classmethod
    def of(
        cls,
        controlled: ControlledGait,
        laws: Mapping[str, AbstractLaw],
        origin: Origin,
    ) -> "Design":
        """Return the design of a gait under some laws.

        Args:
            controlled: the gait, and what its controllers share.
            laws: laws by name; one that the gait cannot have is left out.
            origin: origin of the design.
        """
        controllers, left_out = {}, []
        for name, law in laws.items():
            try:
                controllers[name] = controlled.under(law)
            except SpecError as error:
                left_out.append(str(error))
        safeguard = SafeguardConfig.for_joints(JointResponse(controlled.robot))
        return cls(controlled.gait, controllers, safeguard, origin, left_out=tuple(left_out))

    @property
    def controller(self) -> Controller:
        """Any one of the controllers, for the facts that all of them share."""
        return next(iter(self.controllers.values()))

    @property
    def default_law(self) -> str:
        """Name of the law that level 5 of the proof is about; of the first if there is none."""
        proved = (one.law for one in self.law_proofs if one.proved)
        return next(proved, next(iter(self.controllers)))

    @property
    def commands(self) -> Commands:
        """Commands that the gait takes at each touchdown."""
        return self.gait.commands

    @property
    def leg_joints(self) -> int:
        """Joints of a leg, its hip included."""
        return self.controller.robot.n // 2

    def by_leg(self, actuated: Actuated) -> Float[np.ndarray, "2 k"]:
        """Return values of actuated coordinates by leg, leg 0 in stance."""
        return np.asarray(_by_leg(self.controller.robot.layout, jnp.asarray(actuated)))
