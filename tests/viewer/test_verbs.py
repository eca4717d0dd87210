"""What the verbs say before they stay."""

from types import SimpleNamespace
from typing import Any

import pytest

from neuralgaits.cli.arguments import PageOptions
from neuralgaits.cli.main import main
from neuralgaits.cli.viewer_verbs import _served
from neuralgaits.workflows.demo import FOLDER, TOLD


def served(host, wait=None):
    calls = []
    live: Any = SimpleNamespace(
        host=host,
        url="http://127.0.0.1:8080",
        summary={"url": "http://127.0.0.1:8080", "port": 8080},
        wait=wait or (lambda: calls.append("wait")),
        close=lambda: calls.append("close"),
    )
    outcome = _served(live, PageOptions(no_browser=True))
    assert outcome.then is not None
    return outcome.show, outcome.then, calls


def test_on_loopback_nothing_is_warned_of(capsys):
    show, stay, calls = served("127.0.0.1")
    show()
    out, err = capsys.readouterr()
    assert err == ""
    assert "http://127.0.0.1:8080 " in out and out.count("\n") == 1
    assert calls == []
    stay()
    assert calls == ["wait", "close"]


def test_an_address_that_others_reach_is_said_to_be_one(capsys):
    served("0.0.0.0")
    out, err = capsys.readouterr()
    assert out == ""
    assert err.count("\n") == 1
    assert "0.0.0.0 is reached from other machines" in err
    assert "--host" in err


def test_the_page_is_closed_when_it_is_left():
    def leave():
        raise KeyboardInterrupt

    _, stay, calls = served("127.0.0.1", leave)
    with pytest.raises(KeyboardInterrupt):
        stay()
    assert calls == ["close"]


@pytest.mark.parametrize(
    ("words", "what"),
    [
        (["view", "no-such-run"], "expected a run folder at no-such-run, found nothing"),
        (["view"], "RUN"),
        (["view", str(FOLDER), "--terrain", "stones"], "found one that takes none: train one"),
        (["view", str(TOLD), "--terrain", "stairs"], "takes step_length and step_height on stairs"),
        (["view", str(TOLD), "--terrain", "slopes"], "train one with --slope A:B"),
        (["view", str(TOLD), "--terrain", "hills"], "no such kind and no such file"),
        (["demo", "--port", "0"], "--port from 1 to 65535"),
        (["demo", "--port", "many"], "'many'"),
        (["demo", "--host", "no.such.host.invalid"], "--host as an address of this machine"),
    ],
)
def test_bad_input_is_one_line_and_exit_2(words, what, capsys, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    assert main(words) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.count("\n") == 1
    assert what in err
