"""Connect a simulation to the exported controller of a gait, in a process of its own."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace

from neuralgaits.errors import InputError
from neuralgaits.export import build, output_folder
from neuralgaits.export.design import Design
from neuralgaits.export.source import gait_files
from neuralgaits.simulation.linked.config import LinkConfig
from neuralgaits.simulation.linked.remote import Remote

SOURCES = (*build.CORE, "amber_log.c", "link.c")


@contextmanager
def connected(design: Design, config: LinkConfig, episodes: int, seed: int) -> Iterator[Remote]:
    """Write, compile and start the controller of a gait, or connect to one that runs already.

    Args:
        design: design of the controller.
        config: settings of the link; its law is the design's default if none is named.
        episodes: number of controllers.
        seed: seed of the network's loss and delays.

    Raises: InputError if there is no compiler, or no controller at the address.
    """
    laws = list(design.controllers)
    config = replace(config, law=config.law or design.default_law)
    if config.address:
        with Remote(None, laws, config, episodes, seed) as remote:
            yield remote
        return
    compilers = build.compilers()
    if not compilers:
        raise InputError("expected a C compiler for --controller c, found none: install gcc")
    files = output_folder.shipped() | gait_files(design)
    with output_folder.scratch(files) as folder:
        program = build.build(compilers[0], folder, "controller", SOURCES, build.PLAIN)
        with Remote(program, laws, config, episodes, seed) as remote:
            yield remote
