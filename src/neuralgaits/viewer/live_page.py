"""A page that is being served: its server, the threads behind it, and how it ends."""

import threading
from collections.abc import Callable
from typing import Any, Self

from neuralgaits._environment import COMPLETING
from neuralgaits.viewer import live_server
from neuralgaits.viewer.player import Player


class LivePage:
    """A page that is being served; a subclass puts a robot onto it.

    Attributes:
        player: player that moves the robot.
        url: address of the page.
        port: port that the server listens on.
        host: address that the server is bound to.
    """

    player: Player[Any]

    def __init__(self, title: str, host: str, port: int | None):
        """Serve an empty page. Raises: InputError if host or port is not available."""
        self._closed = threading.Event()
        self._showing = threading.Lock()
        self._server = live_server.open_server(title, host, port)
        self.host, self.port = host, self._server.get_port()
        self.url = live_server.url(host, self.port)

    @property
    def summary(self) -> dict[str, Any]:
        """Address of the page, as `view --json` prints it."""
        return {"url": self.url, "port": self.port}

    def wait(self) -> None:
        """Wait until Ctrl-C. Raises: any failure while the robot walked."""
        self.player.wait()

    def close(self) -> None:
        """Stop the walk and the server."""
        with self._showing:
            # What is being put onto the page gets there; nothing is begun any more.
            self._closed.set()
        if hasattr(self, "player"):
            self.player.stop()
        with live_server.quiet():
            self._server.stop()

    def ready(self, timeout: float | None = None) -> bool:
        """Wait until the page is complete (s). Returns: whether it is."""
        self._completing.join(timeout)
        return not self._completing.is_alive()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _complete_with(self, function: Callable[[], None]) -> None:
        """Complete the page in a thread of its own; a failure ends the page."""

        def complete() -> None:
            try:
                function()
            except BaseException as error:
                self.player.fail(error)

        self._completing = threading.Thread(target=complete, name=COMPLETING, daemon=True)
        self._completing.start()

    def _if_open(self, function: Callable[[], None]) -> None:
        """Change the page, unless it is closed."""
        with self._showing:
            if not self._closed.is_set():
                function()
