# SPDX-License-Identifier: BSD-3-Clause
"""The README's first pictures: the shipped airport with echoes, birds and lidar, still and moving, as the page of
`avianlidar view` shows them in Chromium.

    Testing/Studies/run.py first_picture --out build/first-picture
"""
import io
import time

from PIL import Image

from avianlidar._command import main as avianlidar
from browser import Browser
from running import AIRPORT, argument, study

SIZE, SMALL = (1280, 720), (800, 450)  # pixels of the still and of the moving picture
# Where the camera stands and what it looks at, m east, north and up of the scene's origin.
EYE, TARGET = (10.0, -680.0, 275.0), (230.0, -40.0, 0.0)
QUALITY = 60  # of the moving picture, 0 to 100


def wait(browser):
    """Waits until the page is drawn."""
    end = time.monotonic() + 120
    while not browser.run("return Boolean(window.avianLidar)"):
        if time.monotonic() > end:
            raise RuntimeError(browser.run("return document.body.innerText"))
        time.sleep(0.1)


def show(browser, moment):
    """Shows the birds at a time, s, and returns the picture."""
    browser.run("""
        const time = document.getElementById('time');
        time.value = arguments[0];
        time.dispatchEvent(new Event('input'));
        window.avianLidar.render();""", moment)
    return Image.open(io.BytesIO(browser.driver.get_screenshot_as_png())).convert("RGB")


@study(argument("--scans", type=int, default=20, help="number of scans, each of which takes the lidar 2 s"))
def main(options):
    out, scene = options.out, str(AIRPORT)
    out.mkdir(parents=True, exist_ok=True)
    scenario = AIRPORT.parents[2] / "sequence" / "hongqiao.scenario.json"
    for words in (["scan", scene, "--sensor", "Search905", "-o", out / "echoes.vtp", "--quiet"],
                  ["sequence", scenario, "-o", out / "birds", "--scans", options.scans],
                  ["view", scene, out / "echoes.vtp", "--sequence", out / "birds", "-o", out / "view.html"]):
        code = avianlidar([str(word) for word in words])
        if code:
            return code
    with Browser(*SIZE, graphics=True) as browser:
        browser.open(out / "view.html")
        wait(browser)
        browser.run("""
            const [eye, target] = arguments, { camera, controls, centre, thin } = window.avianLidar;
            controls.target.set(...target.map((one, k) => one - centre[k]));
            camera.position.set(...eye.map((one, k) => one - centre[k]));
            controls.update();
            thin(false);
            document.getElementById('panel').hidden = true;""", EYE, TARGET)
        time.sleep(0.5)
        first, last = (float(browser.run(f"return document.getElementById('time').{end}")) for end in ("min", "max"))
        show(browser, (first + last) / 2).save(out / "airport.png", optimize=True)
        frames = [show(browser, first + k).resize(SMALL) for k in range(int(last - first) + 1)]
    frames[0].save(out / "moving.webp", save_all=True, append_images=frames[1:], duration=100, loop=0, quality=QUALITY)
    return 0
