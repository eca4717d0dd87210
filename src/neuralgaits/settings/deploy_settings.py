"""Settings of the verb `check-deploy`, for command line and Python call alike."""

from dataclasses import KW_ONLY, dataclass
from typing import Annotated

from tyro.conf import Positional

from neuralgaits.settings.options import Settings, arg
from neuralgaits.settings.shared_options import A_PATH, ONE_PATH, AnyName, AnyPath, Flag


@dataclass(frozen=True)
class CheckDeploySettings(Settings):
    """Settings of `check-deploy`: a deployment file and a log of the robot that it describes."""

    file: Annotated[Positional[AnyPath], arg(metavar="deploy.yaml"), ONE_PATH]
    """Deployment file."""
    log: Annotated[Positional[AnyPath], arg(metavar="LOG.csv"), ONE_PATH]
    """Log of the robot in a stand; see the page 'The deployment file'."""
    _: KW_ONLY
    run: Annotated[AnyName | None, arg(metavar="RUN"), A_PATH] = None
    """Run folder, or latest, that the file is about; the one that it names if not given."""
    rehearse: Flag = False
    """First write LOG.csv, as a simulated robot that fits the file would record it; then change
    the file and see what is found."""
