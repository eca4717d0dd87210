"""A page is dark where the browser asks for it, and asks for itself once more only then."""

import pytest

from neuralgaits.viewer.page_style import follow_scheme, page_title

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


def test_a_tab_has_any_title_and_runs_none_of_it(browser):
    title = """a "robot" & 'its' <b>gait</b>';alert(1)//"""
    opened, said = browser.new_page(), []
    opened.on("dialog", lambda dialog: (said.append(dialog.message), dialog.dismiss()))
    opened.set_content(f"<title>Viser</title>{page_title(title)}")
    opened.wait_for_function("document.title !== 'Viser'")
    assert (opened.title(), said) == (title, [])
    opened.close()
