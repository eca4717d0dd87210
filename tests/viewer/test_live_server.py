"""Where a page is served, and what it refuses."""

import logging
import socket
import warnings

import pytest
import viser
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect
from websockets.typing import Subprotocol

from neuralgaits.errors import InputError
from neuralgaits.viewer import live_server

PROTOCOLS = [Subprotocol(f"viser-v{viser.__version__}")]


@pytest.fixture
def taken():
    """A port that somebody listens on."""
    with socket.socket() as listener:
        listener.bind((live_server.LOOPBACK, 0))
        listener.listen()
        yield listener.getsockname()[1]


def test_a_taken_port_is_refused_when_asked_for(taken):
    with pytest.raises(InputError, match=rf"port {taken} to be free, found it taken: leave --port"):
        live_server.open_server("test", port=taken)


def test_without_a_wish_a_free_port_is_taken(taken, monkeypatch):
    monkeypatch.setattr(live_server, "PORT", taken)
    server = live_server.open_server("test")
    try:
        assert taken < server.get_port() < taken + 100
        assert server.get_host() == live_server.LOOPBACK
        with socket.create_connection((live_server.LOOPBACK, server.get_port()), timeout=60.0):
            pass
    finally:
        with live_server.quiet():
            server.stop()


def test_nobody_can_publish_the_page(capfd):
    server = live_server.open_server("test")
    try:
        assert server.request_share_url() is None
    finally:
        with live_server.quiet():
            server.stop()
    assert capfd.readouterr().out == ""


@pytest.mark.parametrize("port", [0, -1, 65536])
def test_a_port_that_does_not_exist(port):
    with pytest.raises(InputError, match=rf"--port from 1 to 65535, found {port}"):
        live_server.open_server("test", port=port)


@pytest.mark.parametrize("host", ["203.0.113.7", "no.such.host.invalid", "x" * 300])
def test_an_address_that_is_not_ours(host):
    with pytest.raises(InputError, match="--host as an address of this machine"):
        live_server.open_server("test", host=host)


@pytest.mark.parametrize(
    ("host", "alone"),
    [
        ("127.0.0.1", True),
        ("127.8.8.8", True),
        ("::1", True),
        ("localhost", True),
        ("0.0.0.0", False),
        ("::", False),
        ("192.168.1.5", False),
        ("example.org", False),
    ],
)
def test_loopback_is_known(host, alone):
    assert live_server.is_loopback(host) is alone


def test_an_address_can_be_opened_on_this_machine():
    assert live_server.url("0.0.0.0", 8080) == "http://127.0.0.1:8080"
    assert live_server.url("::1", 81) == "http://[::1]:81"


def test_without_a_browser_nothing_opens(monkeypatch):
    import webbrowser

    def none(*_):
        raise webbrowser.Error("none")

    monkeypatch.setattr(webbrowser, "get", none)
    assert not live_server.show_in_browser("http://127.0.0.1:1")
    # One that would take the terminal is no window either.
    monkeypatch.setattr(webbrowser, "get", lambda *_: webbrowser.GenericBrowser("w3m"))
    assert not live_server.show_in_browser("http://127.0.0.1:1")


def test_what_comes_after_the_end_is_not_warned_of():
    """Of that alone: here every warning is an error."""
    server = live_server.open_server("test")
    said = server.gui.add_markdown("before")
    with live_server.quiet():
        server.stop()
    said.content = "after"
    with pytest.raises(UserWarning, match="something else"):
        warnings.warn("something else", stacklevel=1)


@pytest.mark.parametrize(
    "frame", ["text", b"", b"\xff\x00", b"\x05", b"\x81\xa4type\xa4Nope", b"\x81\xa1a\x01"]
)
def test_a_frame_that_viser_does_not_understand_is_not_on_the_terminal(capfd, monkeypatch, frame):
    # Handlers of pytest would keep it off, too.
    monkeypatch.setattr(logging.getLogger(), "handlers", [])
    server = live_server.open_server("test")
    try:
        address = f"ws://{live_server.LOOPBACK}:{server.get_port()}"
        with connect(address, subprotocols=PROTOCOLS) as visitor:
            visitor.send(frame)
            with pytest.raises(ConnectionClosed):
                while True:
                    visitor.recv()
    finally:
        with live_server.quiet():
            server.stop()
    assert capfd.readouterr() == ("", "")
