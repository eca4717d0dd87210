"""All kinds of forgeries of level 5, by theme."""

from support.forgeries import disturbed, disturbed_files, disturbed_laws, disturbed_runs
from support.forgeries.base import Forgery

LEVEL_5: dict[str, list[Forgery]] = {
    "level-5-numbers": disturbed.THEME.kinds,
    "level-5-files": disturbed_files.THEME.kinds,
    "level-5-laws": disturbed_laws.THEME.kinds,
    "level-5-runs": disturbed_runs.THEME.kinds,
}
