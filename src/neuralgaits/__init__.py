"""Neural gaits: walking policies from barrier conditions on zero dynamics.

The names below are the public Python interface. Each is imported when it is first used, so
that importing the package is quick and changes nothing, JAX's settings included.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from neuralgaits._version import __version__

if TYPE_CHECKING:
    from neuralgaits.analysis.poincare_map import poincare
    from neuralgaits.analysis.run import open_run
    from neuralgaits.barriers import specs
    from neuralgaits.gait import (
        BezierPolicy,
        HybridInvariantPolicy,
        MLPPolicy,
        ZeroDynamics,
    )
    from neuralgaits.robots import load_robot
    from neuralgaits.workflows.certify import certify
    from neuralgaits.workflows.check_deploy import check_deploy
    from neuralgaits.workflows.check_proof import check_proof
    from neuralgaits.workflows.demo import demo
    from neuralgaits.workflows.doctor import doctor
    from neuralgaits.workflows.episodes import episodes
    from neuralgaits.workflows.export import export_controller
    from neuralgaits.workflows.figures import figures
    from neuralgaits.workflows.fit import fit
    from neuralgaits.workflows.fit_joints import fit_joints
    from neuralgaits.workflows.import_gait import import_gait
    from neuralgaits.workflows.inspect import inspect
    from neuralgaits.workflows.optimise import optimise
    from neuralgaits.workflows.refine import refine
    from neuralgaits.workflows.report import write_report
    from neuralgaits.workflows.simulate import simulate
    from neuralgaits.workflows.sweep import sweep
    from neuralgaits.workflows.train import train
    from neuralgaits.workflows.train_seeds import train_seeds
    from neuralgaits.workflows.view import view

_HOMES = {
    "BezierPolicy": "neuralgaits.gait",
    "HybridInvariantPolicy": "neuralgaits.gait",
    "MLPPolicy": "neuralgaits.gait",
    "ZeroDynamics": "neuralgaits.gait",
    "certify": "neuralgaits.workflows.certify",
    "check_deploy": "neuralgaits.workflows.check_deploy",
    "check_proof": "neuralgaits.workflows.check_proof",
    "demo": "neuralgaits.workflows.demo",
    "doctor": "neuralgaits.workflows.doctor",
    "episodes": "neuralgaits.workflows.episodes",
    "export_controller": "neuralgaits.workflows.export",
    "figures": "neuralgaits.workflows.figures",
    "fit": "neuralgaits.workflows.fit",
    "fit_joints": "neuralgaits.workflows.fit_joints",
    "import_gait": "neuralgaits.workflows.import_gait",
    "inspect": "neuralgaits.workflows.inspect",
    "load_robot": "neuralgaits.robots",
    "open_run": "neuralgaits.analysis.run",
    "optimise": "neuralgaits.workflows.optimise",
    "poincare": "neuralgaits.analysis.poincare_map",
    "refine": "neuralgaits.workflows.refine",
    "simulate": "neuralgaits.workflows.simulate",
    "specs": "neuralgaits.barriers",
    "sweep": "neuralgaits.workflows.sweep",
    "train": "neuralgaits.workflows.train",
    "train_seeds": "neuralgaits.workflows.train_seeds",
    # `report` is the room of figures and pages.
    "view": "neuralgaits.workflows.view",
    "write_report": "neuralgaits.workflows.report",
}

__all__ = [
    "BezierPolicy",
    "HybridInvariantPolicy",
    "MLPPolicy",
    "ZeroDynamics",
    "__version__",
    "certify",
    "check_deploy",
    "check_proof",
    "demo",
    "doctor",
    "episodes",
    "export_controller",
    "figures",
    "fit",
    "fit_joints",
    "import_gait",
    "inspect",
    "load_robot",
    "open_run",
    "optimise",
    "poincare",
    "refine",
    "simulate",
    "specs",
    "sweep",
    "train",
    "train_seeds",
    "view",
    "write_report",
]


def __getattr__(name: str) -> Any:
    """Import a public name from its room. Raises: AttributeError for any other name."""
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(_HOMES[name]), name)


def __dir__() -> list[str]:
    return __all__
