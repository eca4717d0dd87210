"""A page is dark where the browser asks for it, and asks for itself once more only then."""

import pytest

from neuralgaits.viewer.page_style import follow_scheme

ADDRESS = "http://localhost/"


@pytest.mark.parametrize(("asked", "ends"), [("dark", "?darkMode="), ("light", "")])
def test_the_page_follows_the_browser(browser, asked, ends):
    opened = browser.new_page(color_scheme=asked)
    # Answered by the test: nothing is served.
    opened.route(
        "**/*", lambda route: route.fulfill(body=follow_scheme(), content_type="text/html")
    )
    loads = []
    opened.on("load", lambda page: loads.append(page.url))
    opened.goto(ADDRESS)
    opened.wait_for_url(ADDRESS + ends)
    opened.wait_for_load_state()
    opened.close()
    assert loads[-1] == ADDRESS + ends and len(loads) <= 2
