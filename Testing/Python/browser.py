# SPDX-License-Identifier: BSD-3-Clause
"""A page in Chromium, without a display and without a network."""
import base64
import io
import json
import pathlib
import re

import numpy as np
from selenium import webdriver
from selenium.webdriver.chrome.service import Service


class Browser:
    """Opens a file; closed at the end of a `with`. @param width, height of the window, pixels @param graphics whether
    pages draw with WebGL, by software"""

    def __init__(self, width=1150, height=900, graphics=False):
        options = webdriver.ChromeOptions()
        options.binary_location = "/usr/bin/chromium"
        for argument in ("--headless=new", "--no-sandbox", "--disable-dev-shm-usage",
                         *(("--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader") if graphics
                           else ("--disable-gpu",)), "--hide-scrollbars", "--host-resolver-rules=MAP * ~NOTFOUND", "--proxy-server=127.0.0.1:9"):
            options.add_argument(argument)
        options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
        self.driver = webdriver.Chrome(service=Service("/usr/bin/chromedriver"), options=options)
        # Windows have a least width, what they show has not.
        self.driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride",
                                    {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 600})

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.driver.quit()

    def open(self, file):
        """Open a file. @return the addresses that were asked for while it loaded"""
        self.driver.get(pathlib.Path(file).resolve().as_uri())
        messages = [json.loads(entry["message"])["message"] for entry in self.driver.get_log("performance")]
        return [message["params"]["request"]["url"] for message in messages if message["method"]
                == "Network.requestWillBeSent"]

    def complaints(self):
        """What the console says since the page was opened."""
        return self.driver.get_log("browser")

    def run(self, script, *arguments):
        """What a script (JavaScript) returns."""
        return self.driver.execute_script(script, *arguments)

    def pixels(self):
        """What is shown, rows x columns x 3, 0 to 255."""
        from matplotlib.image import imread
        picture = imread(io.BytesIO(self.driver.get_screenshot_as_png()))
        return np.rint(255 * picture[:, :, :3]).astype(int)

    def check_printed(self, test):
        """The page is printed on at most six pages of A4 with letters of 8 points or more, no figure or row of a table
        is taller than a page, and the first page holds all parts."""
        from avianlidar.apps.pages._drawing import PIXELS
        run, was = self.driver.execute_cdp_cmd, self.run("return [innerWidth, innerHeight]")
        pdf = base64.b64decode(run("Page.printToPDF", {"preferCSSPageSize": True})["data"])
        boxes = re.findall(rb"/MediaBox \[0 0 ([0-9.]+) ([0-9.]+)\]", pdf)
        sizes = {(round(float(width)), round(float(height))) for width, height in boxes}
        test.assertTrue(len(boxes) <= 6 and sizes == {(595, 842)}, boxes)
        shown = {"width": 673, "height": 1024, "deviceScaleFactor": 1, "mobile": False}  # of the text on A4, pixels
        run("Emulation.setEmulatedMedia", {"media": "print"})
        run("Emulation.setDeviceMetricsOverride", shown)
        letters, scale, tallest, first, broken, words, wide, parts = self.run("""
            const all = s => [...document.querySelectorAll(s)], height = e => e.getBoundingClientRect().height / 1024;
            const texts = all('body *').filter(e => e.checkVisibility() && [...e.childNodes].some(
                n => n.nodeType === 3 && n.textContent.trim()));
            return [Math.min(...texts.map(e => .75 * parseFloat(getComputedStyle(e).fontSize))),
                Math.min(...[...document.images].map(i => i.width / 96 / (i.naturalWidth / arguments[0]))),
                Math.max(...all('figure, tr').map(height)), height(all('#first')[0]),
                all('figure').filter(e => getComputedStyle(e).breakInside !== 'avoid').length,
                all('#answer')[0].textContent.split(/\\s+/).length, document.documentElement.scrollWidth,
                ['figure img[src^=data]', '#next li', '#assumed p', '#numbers div:nth-child(3) .value'].filter(
                    s => all('#first ' + s).length).length]""", PIXELS)
        run("Emulation.setEmulatedMedia", {"media": ""})
        run("Emulation.setDeviceMetricsOverride", {**shown, "width": was[0], "height": was[1]})
        test.assertTrue(letters >= 7.99 and scale >= 0.99, (letters, scale))  # pictures have letters of 8 points
        test.assertTrue(wide <= 673 and tallest <= 1.0 and broken == 0, (wide, tallest, broken))  # wide ones are shrunk
        test.assertTrue(words <= 25 and parts == 4 and first <= 1.0, (words, parts, first))

    def picture_between(self, first, end, file):
        """Write what is shown from an element to before another (CSS selectors), as PNG."""
        top, bottom, width = self.run(f"""
            const y = s => document.querySelector(s).getBoundingClientRect().top + scrollY;
            return [y('{first}'), y('{end}'), document.documentElement.scrollWidth]""")
        found = self.driver.execute_cdp_cmd("Page.captureScreenshot", {"captureBeyondViewport": True, "clip": {
            "x": 0, "y": max(top - 8, 0), "width": width, "height": bottom - top, "scale": 1}})
        pathlib.Path(file).write_bytes(base64.b64decode(found["data"]))
