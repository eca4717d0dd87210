"""Take the picture of a report: the first screen of the shipped gait's, after a walk of 50 steps.

    .venv/bin/python docs/images/make_report.py

Needs Chromium, which draws in software where there is no graphics card.
"""

import shutil
import sys
import tempfile
from io import BytesIO
from pathlib import Path

import jax
from PIL import Image
from playwright.sync_api import sync_playwright

import neuralgaits as ng
from neuralgaits.workflows.demo import FOLDER

WIDTH, HEIGHT = 1440, 900
"""Size of the window in pixels."""
WALKED_S = 3.0
"""How long it has walked before the picture is taken."""
QUALITY = 86
"""Of the picture: small words stay sharp."""
OUT = Path(__file__).with_name("report.webp")
DRAWING = ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader"]
DRAWING += ["--enable-unsafe-swiftshader"]


def main() -> None:
    """Write the report of a copy of the shipped run, look at it, save what is seen."""
    chromium = shutil.which("chromium")
    if chromium is None:
        sys.exit("expected chromium, found none: install it, as in `apt-get install chromium`")
    jax.config.update("jax_enable_x64", True)
    with tempfile.TemporaryDirectory() as scratch, sync_playwright() as driver:
        run = Path(shutil.copytree(FOLDER, Path(scratch) / "run"))
        ng.simulate(run)
        page_file = ng.write_report(run).path
        browser = driver.chromium.launch(executable_path=chromium, args=DRAWING)
        page = browser.new_page(viewport={"width": WIDTH, "height": HEIGHT})
        page.goto(page_file.as_uri())
        page.wait_for_timeout(1000.0 * WALKED_S)
        picture = Image.open(BytesIO(page.screenshot())).convert("RGB")
        browser.close()
    picture.save(OUT, quality=QUALITY, method=6)


if __name__ == "__main__":
    main()
