"""The shipped run, and a browser if the machine has one."""

import shutil

import pytest

from neuralgaits.workflows.demo import FOLDER
from neuralgaits.workflows.run import open_run

# A machine without a graphics card draws in software.
CHROMIUM = ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader"]
CHROMIUM += ["--enable-unsafe-swiftshader"]


@pytest.fixture(scope="session")
def shipped():
    return open_run(FOLDER)


@pytest.fixture(scope="session")
def browser():
    found = shutil.which("chromium")
    if found is None:
        pytest.skip("no chromium on this machine to open the page with")
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        chromium = playwright.chromium.launch(executable_path=found, args=CHROMIUM)
        yield chromium
        chromium.close()
