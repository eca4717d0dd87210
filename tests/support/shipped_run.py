"""Where the run lies that ships with the package."""

from pathlib import Path

import neuralgaits

SHIPPED = Path(neuralgaits.__file__).parent / "demo_run"
