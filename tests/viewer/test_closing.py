"""A page that ends while its portrait is being hung: nothing is written to it afterwards."""

import threading

from viser.infra._async_message_buffer import AsyncMessageBuffer

from neuralgaits.viewer.panel import Panel
from neuralgaits.workflows.demo import demo


def test_nothing_is_written_to_a_page_that_has_ended(monkeypatch):
    begun, late = threading.Event(), []
    push, tell = AsyncMessageBuffer.push, Panel.tell_how_sure

    def watched(buffer, message):
        if buffer.done and message.lifecycle_phase != "remove":
            late.append(type(message).__name__)
        push(buffer, message)

    def slow(panel, *words):
        begun.set()
        # The page is being closed meanwhile.
        threading.Event().wait(1.0)
        tell(panel, *words)

    monkeypatch.setattr(AsyncMessageBuffer, "push", watched)
    monkeypatch.setattr(Panel, "tell_how_sure", slow)
    with demo() as live:
        assert begun.wait(60.0)
    assert live.ready(60.0)
    assert late == []
    assert live.player.failure is None
