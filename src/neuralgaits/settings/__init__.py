"""Settings of the verbs: one class each, which the command line and the Python call both read."""

from neuralgaits._called_with import called_with
from neuralgaits.settings.certify_settings import CertifySettings, CheckProofSettings
from neuralgaits.settings.deploy_settings import CheckDeploySettings
from neuralgaits.settings.export_settings import ExportSettings
from neuralgaits.settings.learn_settings import EpisodesSettings, FitSettings, RefineSettings
from neuralgaits.settings.shared_options import Watch
from neuralgaits.settings.simulate_settings import SimulateSettings
from neuralgaits.settings.sweep_settings import SweepSettings
from neuralgaits.settings.train_settings import (
    GaitSettings,
    ImportGaitSettings,
    OptimiseSettings,
    TrainSeedsSettings,
    TrainSettings,
)

__all__ = [
    "CertifySettings",
    "CheckDeploySettings",
    "CheckProofSettings",
    "EpisodesSettings",
    "ExportSettings",
    "FitSettings",
    "GaitSettings",
    "ImportGaitSettings",
    "OptimiseSettings",
    "RefineSettings",
    "SimulateSettings",
    "SweepSettings",
    "TrainSeedsSettings",
    "TrainSettings",
    "Watch",
    "called_with",
]
