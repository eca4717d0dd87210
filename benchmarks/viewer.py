"""Times of the live page: to the first frame, frames a second, from a slider to its effect.

`viewer.py [RUN]`; the shipped run if none is given. With chromium on the machine the page is also
opened, and what the browser draws is counted; without a graphics card it draws in software.
"""

import json
import os
import shutil
import subprocess
import sys
import tempfile
import time
import urllib.request
from pathlib import Path

from common import show

from neuralgaits._environment import prepare

SECONDS = 6.0
"""How long frames are counted."""
CLIENT = ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader"]
CLIENT += ["--enable-unsafe-swiftshader"]
COUNT_FRAMES = """(seconds) => new Promise(done => {
  let frames = 0; const began = performance.now();
  const next = () => {
    frames += 1; const spent = (performance.now() - began) / 1000;
    if (spent < seconds) requestAnimationFrame(next); else done(frames / spent);
  }; next(); })"""


def from_a_shell(cache: Path | None) -> tuple[float, float, float]:
    """Seconds from the start of `neuralgaits demo` until the robot stands in the page and walks.

    The third number is the processor's time until it walks, which a busy machine stretches less.

    `cache` is the folder of compiled programs; None is the user's own.
    """
    own = {} if cache is None else {"JAX_COMPILATION_CACHE_DIR": str(cache)}
    code = (
        "import json, sys, time\n"
        "from neuralgaits._environment import prepare; prepare()\n"
        "from neuralgaits.workflows.demo import demo\n"
        "view = demo(); print(json.dumps(view.url), flush=True)\n"
        "while view.gait.live.time == 0.0: time.sleep(0.005)\n"
        "print(time.process_time(), flush=True); view.close()\n"
    )
    start_time = time.perf_counter()
    with subprocess.Popen(
        [sys.executable, "-c", code], stdout=subprocess.PIPE, text=True, env=os.environ | own
    ) as shell:
        assert shell.stdout is not None
        address = json.loads(shell.stdout.readline())
        with urllib.request.urlopen(address, timeout=10.0) as page:
            page.read()
        served = time.perf_counter() - start_time
        spent = float(shell.stdout.readline())
        return served, time.perf_counter() - start_time, spent


def slider_to_effect(view, rounds: int = 8) -> list[float]:
    """Seconds from a wish of the panel until the plant has it and a picture shows it."""
    times = []
    for number in range(rounds):
        value = 0.5 if number % 2 else -0.5
        before, frames = view.gait.live.plant, view.player.frames
        start_time = time.perf_counter()
        view.player.ask(lambda walker, value=value: walker.disturb("slope_deg", value))
        while view.gait.live.plant is before or view.player.frames < frames + 1:
            time.sleep(0.001)
        times.append(time.perf_counter() - start_time)
        time.sleep(0.3)
    return times


def in_a_browser(view, chromium: str) -> None:
    """What a browser on this machine draws of the page."""
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=chromium, args=CLIENT)
        page = browser.new_page(viewport={"width": 960, "height": 640})
        start_time = time.perf_counter()
        page.goto(view.url)
        page.get_by_text("Walks ·").wait_for(timeout=120_000)
        show("browser, page opened to the walk on it", f"{time.perf_counter() - start_time:.1f} s")
        time.sleep(4.0)
        frames, simulated = view.player.frames, view.gait.live.time
        start_time = time.perf_counter()
        drawn = page.evaluate(COUNT_FRAMES, SECONDS)
        spent = time.perf_counter() - start_time
        show("browser open: pictures sent", f"{(view.player.frames - frames) / spent:.0f} /s")
        show("browser open: drawn, in software", f"{drawn:.0f} /s")
        show("browser open: pace", f"{(view.gait.live.time - simulated) / spent:.2f} of real time")
        box = page.get_by_role("textbox").nth(3)
        before = view.gait.live.plant
        box.fill("2")
        start_time = time.perf_counter()
        box.press("Enter")
        while view.gait.live.plant is before and time.perf_counter() < start_time + 20.0:
            time.sleep(0.002)
        show(
            "browser: number typed to its effect",
            f"{1e3 * (time.perf_counter() - start_time):.0f} ms",
        )
        browser.close()


def main() -> None:
    """Print the figures."""
    load = f"{os.getloadavg()[0]:.1f} on {os.cpu_count()} cores"
    show("load when begun", load)
    from_a_shell(None)
    served, walks, spent = from_a_shell(None)
    show("demo, compiled before: first frame served", f"{served:.1f} s", "<= 3 s")
    show("demo, compiled before: walks", f"{walks:.1f} s, {spent:.1f} s of processor")
    with tempfile.TemporaryDirectory() as folder:
        served, walks, spent = from_a_shell(Path(folder))
    show("demo, nothing compiled: first frame served", f"{served:.1f} s")
    show("demo, nothing compiled: walks", f"{walks:.1f} s, {spent:.1f} s of processor", "<= 10 s")
    prepare()
    from neuralgaits.workflows.demo import FOLDER
    from neuralgaits.workflows.view import LiveView, view

    with view(sys.argv[1] if len(sys.argv) > 1 else FOLDER) as live:
        assert isinstance(live, LiveView)
        start_time = time.perf_counter()
        live.ready()
        show(
            "portrait and margins after the first frame",
            f"{time.perf_counter() - start_time:.1f} s",
        )
        frames, simulated = live.player.frames, live.gait.live.time
        time.sleep(SECONDS)
        show("pictures sent", f"{(live.player.frames - frames) / SECONDS:.0f} /s", ">= 30 /s")
        show("pace", f"{(live.gait.live.time - simulated) / SECONDS:.2f} of real time")
        times = sorted(slider_to_effect(live))
        middle, worst = 1e3 * times[len(times) // 2], 1e3 * times[-1]
        show("slider to effect, median and worst", f"{middle:.0f} and {worst:.0f} ms", "<= 200 ms")
        chromium = shutil.which("chromium")
        if chromium is not None:
            in_a_browser(live, chromium)


if __name__ == "__main__":
    main()
