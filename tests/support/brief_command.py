"""The command line as a process of its own, whose exports are compared on few states, without -O.

For tests that look at what a process reads and writes, not at what compiled C computes.
"""

from neuralgaits.cli.main import run
from neuralgaits.export import build
from neuralgaits.settings.export_settings import ExportSettings

STATES = 100
"""Random states on which an export is compared with Python."""

if __name__ == "__main__":
    build.PLAIN, build.NATIVE = ("-O0",), ("-O0", "-march=native")
    settled = ExportSettings.__post_init__

    def briefly(self: ExportSettings) -> None:
        """Settle few states, whatever the default is."""
        object.__setattr__(self, "states", STATES)
        settled(self)

    ExportSettings.__post_init__ = briefly
    run()
