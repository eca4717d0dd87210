"""Take the picture of a live page: the shipped gait, or a run's, a few steps into its walk.

    .venv/bin/python docs/images/make_viewer.py
    .venv/bin/python docs/images/make_viewer.py RUN       # of walker3d: pushed to the left before

Needs Chromium; without a graphics card it draws in software, which the page then says: the note
is closed first.
"""

import shutil
import sys
from io import BytesIO
from pathlib import Path

from PIL import Image
from playwright.sync_api import sync_playwright

from neuralgaits._environment import prepare

WIDTH, HEIGHT = 1280, 760
"""Size of the window in pixels."""
WALKED_S = 6.0
"""How long it has walked before the picture is taken."""
QUALITY = 88
"""Of the picture: small words stay sharp, at a fifth of the size of a PNG file."""
OUT, OF_RUN = (Path(__file__).with_name(name) for name in ("viewer.webp", "space-view.webp"))
DRAWING = ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader"]
DRAWING += ["--enable-unsafe-swiftshader"]


def main(run: str | None = None) -> None:
    """Serve the page, look at it, save what is seen."""
    chromium = shutil.which("chromium")
    if chromium is None:
        sys.exit("expected chromium, found none: install it, as in `apt-get install chromium`")
    prepare()
    from neuralgaits.workflows.demo import demo
    from neuralgaits.workflows.view import view

    with demo() if run is None else view(run) as live, sync_playwright() as driver:
        live.ready(600.0)
        browser = driver.chromium.launch(executable_path=chromium, args=DRAWING)
        page = browser.new_page(viewport={"width": WIDTH, "height": HEIGHT})
        page.goto(live.url)
        page.get_by_text("Walks ·").wait_for(timeout=60_000)
        page.wait_for_timeout(1000.0 * WALKED_S)
        for close in page.locator(".mantine-Notification-closeButton").all():
            close.click()
        if run is not None:
            page.get_by_role("button", name="left").click()
        page.wait_for_timeout(2000.0)
        picture = Image.open(BytesIO(page.screenshot(timeout=300_000))).convert("RGB")
        browser.close()
    picture.save(OUT if run is None else OF_RUN, quality=QUALITY, method=6)


if __name__ == "__main__":
    main(*sys.argv[1:2])
