"""Verbs that serve a live page: they answer as soon as it opens, and run until Ctrl-C."""

import sys
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from neuralgaits.cli.arguments import DemoOptions, PageOptions, ViewOptions
from neuralgaits.cli.outcome import Outcome

if TYPE_CHECKING:
    from neuralgaits.viewer.live_page import LivePage


def carry_out_view(verb: ViewOptions) -> Outcome:
    """Carry out the verb `view`; always good."""
    from neuralgaits.cli.progress import WorkProgress
    from neuralgaits.workflows.view import view

    with WorkProgress("putting the robot onto its feet", quiet=verb.output.json):
        live = view(verb.run, terrain=verb.terrain, **_place(verb.page))
    return _served(live, verb.page)


def carry_out_demo(verb: DemoOptions) -> Outcome:
    """Carry out the verb `demo`; always good."""
    from neuralgaits.cli.progress import WorkProgress
    from neuralgaits.workflows.demo import demo

    with WorkProgress("putting the robot onto its feet", quiet=verb.output.json):
        live = demo(speed=verb.speed, lean=verb.lean, **_place(verb.page))
    return _served(live, verb.page)


def _place(page: PageOptions) -> dict[str, Any]:
    return {"port": page.port} if page.host is None else {"port": page.port, "host": page.host}


def _served(live: "LivePage", page: PageOptions) -> Outcome:
    """Print the page's address, open the page, and serve it until Ctrl-C."""
    from neuralgaits.viewer.live_server import is_loopback, show_in_browser

    if not is_loopback(live.host):
        print(
            f"neuralgaits: {live.host} is reached from other machines: whoever opens the page can "
            "push the robot; leave --host away to keep it on this machine",
            file=sys.stderr,
        )
    opened = not page.no_browser and show_in_browser(live.url)

    def stay() -> None:
        try:
            live.wait()
        finally:
            live.close()

    def show(result: Mapping[str, Any]) -> None:
        what = "" if opened else " (open it in a browser)"
        print(f"live page at {result['url']}{what}; Ctrl-C ends it", flush=True)

    return Outcome(live.summary, good=True, table=show, then=stay)
