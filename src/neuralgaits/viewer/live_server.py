"""The server of a live page: on loopback by default, on a port of its own.

It is viser's. The page and the server exchange messages over a WebSocket; JavaScript of this
program's own is in `page_style.py` and `phase_chart.py`.
"""

import contextlib
import errno
import io
import ipaddress
import logging
import socket
import threading
import warnings
import webbrowser
from collections.abc import Iterator

import viser

from neuralgaits.errors import InputError
from neuralgaits.viewer import page_style

PORT = 8080
"""First port that is tried if none was requested."""
LOOPBACK = "127.0.0.1"


class LocalServer(viser.ViserServer):
    """A server that visitors cannot publish; viser offers to, over a relay on the internet."""

    def request_share_url(self, verbose: bool = True) -> str | None:
        """Refuse to publish the page. Returns: None."""
        return None


def open_server(label: str, host: str = LOOPBACK, port: int | None = None) -> LocalServer:
    """Serve an empty page.

    Args:
        label: title of the page, at its top and in the browser's tab.
        host: address to bind to.
        port: exactly this one; None takes the first free one from `PORT` on.

    Raises: InputError if host or port is not available.
    """
    free_port = _free_port(host, port)
    _keep_visitors_quiet()
    with quiet():
        server = LocalServer(host=host, port=free_port, label=label, verbose=False)
    if server.get_port() != free_port:
        server.stop()
        raise InputError(f"expected port {free_port} to be free, found it taken: {_REMEDY}")
    server.gui.configure_theme(show_logo=False, show_share_button=False, brand_color=(11, 87, 164))
    server.gui.main_panel.dock_right()
    server.gui.main_panel.set_width(370)
    scripts = page_style.follow_scheme() + page_style.page_title(label)
    server.gui.add_html(scripts + page_style.head())
    return server


def _keep_visitors_quiet() -> None:
    """Keep off the terminal what goes wrong with a visitor's messages; there is nothing to be done.

    Whoever sends no WebSocket frames, or none that viser understands, loses the connection. A
    caller who sets up logging has the tracebacks.
    """
    # A visitor may also leave, or the page end, while an answer is on its way.
    warnings.filterwarnings("ignore", message=r"Queued a \w+ on a closed connection")
    warnings.filterwarnings("ignore", message=r"\[viser\] .* does not match annotation")
    # They report visitors' messages; without a handler Python prints them to stderr.
    for library in "websockets", "asyncio":
        logger = logging.getLogger(library)
        if not logger.handlers:
            logger.addHandler(logging.NullHandler())


_REMEDY = "leave --port away to have a free one chosen, or name another"


def refuse_no_port(port: int | None) -> None:
    """Refuse an impossible port before anything is opened. Raises: InputError."""
    largest = 65535
    if port is not None and not 1 <= port <= largest:
        raise InputError(f"expected --port from 1 to {largest}, found {port}: {_REMEDY}")


def _free_port(host: str, port: int | None) -> int:
    refuse_no_port(port)
    tries = 100
    for number in range(PORT, PORT + tries) if port is None else (port,):
        if _is_free(host, number):
            return number
    if port is None:
        raise InputError(
            f"expected a free port from {PORT} to {PORT + tries - 1}, found none: name one with "
            "--port"
        )
    raise InputError(f"expected port {port} to be free, found it taken: {_REMEDY}")


def _is_free(host: str, port: int) -> bool:
    """Return whether a server could listen there.

    Raises: InputError for a host that is not an address of this machine.
    """
    try:
        addresses = socket.getaddrinfo(host or None, port, type=socket.SOCK_STREAM)
    except (OSError, UnicodeError):
        raise InputError(f"expected --host as an address of this machine, found {host!r}") from None
    family, kind, protocol, _, address = addresses[0]
    with socket.socket(family, kind, protocol) as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind(address)
        except PermissionError:
            raise InputError(
                f"expected a port that may be opened, found {port}: take one above 1023"
            ) from None
        except OSError as error:
            if error.errno == errno.EADDRINUSE:
                return False
            raise InputError(
                f"expected --host as an address of this machine, found {host!r}: "
                f"{LOOPBACK} is this machine alone"
            ) from None
    return True


def is_loopback(host: str) -> bool:
    """Return whether only this machine reaches a server bound to this address."""
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return host == "localhost"


def url(host: str, port: int) -> str:
    """Return the address of the page for a browser on this machine."""
    name = LOOPBACK if host in ("0.0.0.0", "::", "") else host
    return f"http://[{name}]:{port}" if ":" in name else f"http://{name}:{port}"


def show_in_browser(address: str) -> bool:
    """Open the page in a window. Returns: False if there is no browser with a window.

    A browser inside the terminal does not count: it would take over the terminal.
    """
    try:
        browser = webbrowser.get()
    except webbrowser.Error:
        return False
    if isinstance(browser, webbrowser.GenericBrowser) and not isinstance(
        browser, webbrowser.BackgroundBrowser
    ):
        return False
    threading.Thread(target=browser.open, args=(address,), daemon=True).start()
    return True


@contextlib.contextmanager
def quiet() -> Iterator[None]:
    """Suppress the output of a server as it starts and ends; stdout is for answers."""
    with contextlib.redirect_stdout(io.StringIO()):
        yield
