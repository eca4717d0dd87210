"""Policies, coordinates and the hybrid zero dynamics they induce."""

from neuralgaits.gait.network import Network
from neuralgaits.gait.orbit import Orbit
from neuralgaits.gait.point import Point
from neuralgaits.gait.policies.bezier import BezierPolicy
from neuralgaits.gait.policies.hybrid_invariant import HybridInvariantPolicy
from neuralgaits.gait.policies.mlp import MLPPolicy
from neuralgaits.gait.policy import (
    AbstractPolicy,
    OutputJet,
    output_jet,
)
from neuralgaits.gait.posture import Posture, posture_path, walking_posture
from neuralgaits.gait.reset_residual import NO_RESIDUALS, Residuals
from neuralgaits.gait.zero_dynamics import ZeroDynamics

__all__ = [
    "NO_RESIDUALS",
    "AbstractPolicy",
    "BezierPolicy",
    "HybridInvariantPolicy",
    "MLPPolicy",
    "Network",
    "Orbit",
    "OutputJet",
    "Point",
    "Posture",
    "Residuals",
    "ZeroDynamics",
    "output_jet",
    "posture_path",
    "walking_posture",
]
