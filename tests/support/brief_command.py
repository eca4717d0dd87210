"""The command line as a process of its own, whose exports are compared on few states, without -O.

For tests that look at what a process reads and writes, not at what compiled C computes.
"""

from neuralgaits.cli.main import run
from neuralgaits.export import build, compare

STATES = 100
"""Random states on which an export is compared with Python."""

if __name__ == "__main__":
    build.PLAIN, build.NATIVE = ("-O0",), ("-O0", "-march=native")
    # The workflow, which is not imported yet, takes this for its default.
    compare.STATES = STATES
    run()
