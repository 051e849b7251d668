#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Size and speed of the page of `avianlidar view` in headless Chromium, which draws by software: hills of 300,000
triangles with houses, a million echoes, 1,280 by 720 pixels.

    view_page.py [--echoes 1000000] [--folder build/view-page]

Prints the size of the page, the time until the first picture, the frames a second while the camera moves (with fewer
points), the time of a frame with all points, and the time of a click."""
import argparse
import pathlib
import sys
import time

import numpy as np

import avianlidar as al
from avianlidar._cloud import add_array, vertices
from avianlidar.apps.view import _view

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1] / "Python"))
from browser import Browser  # noqa: E402

SIDE = 384  # points along a side of the hills
MOVING = """
    const { camera, controls, render, thin, pick } = window.avianLidar;
    const gl = document.querySelector('canvas').getContext('webgl2') ||
      document.querySelector('canvas').getContext('webgl');
    const drawn = () => { render(); gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4)); };
    thin(true);
    drawn();
    let begin = performance.now(), frames = 0;
    while (performance.now() - begin < 5000) {
      camera.position.x += 2;
      controls.update();
      thin(true);
      drawn();
      ++frames;
    }
    const rate = 1000 * frames / (performance.now() - begin);
    thin(false);
    begin = performance.now();
    drawn();
    const whole = performance.now() - begin;
    begin = performance.now();
    pick(innerWidth / 2, innerHeight / 2);
    return [rate, whole / 1000, (performance.now() - begin) / 1000];"""


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--echoes", type=int, default=1_000_000)
    parser.add_argument("--folder", type=pathlib.Path, default=pathlib.Path("build/view-page"))
    options = parser.parse_args()
    options.folder.mkdir(parents=True, exist_ok=True)
    generator = np.random.default_rng(1)
    x, y = np.meshgrid(*2 * [np.linspace(-3000, 3000, SIDE)])
    points = np.column_stack([x.ravel(), y.ravel(), (8 * np.sin(x / 200) * np.cos(y / 170)).ravel()])
    at = np.arange(SIDE * SIDE).reshape(SIDE, SIDE)
    corners = at[:-1, :-1], at[:-1, 1:], at[1:, 1:], at[1:, :-1]
    cells = [np.stack([corners[k] for k in row], axis=-1).reshape(-1, 3) for row in ((0, 1, 2), (0, 2, 3))]
    scene = al.Scene((points, np.concatenate(cells)), material="Grass", name="Hills")
    places = points[generator.integers(0, len(points), options.echoes)]
    echoes = vertices(places + generator.normal(0.0, 2.0, places.shape))
    add_array(echoes.GetPointData(), "energy", 10 ** generator.uniform(-6, -4, options.echoes), "J")
    add_array(echoes.GetPointData(), "object_id", np.zeros(options.echoes, dtype=np.int32))
    page = options.folder / "view.html"
    content = _view.page(scene, "hills", [("echoes", al.Cloud(echoes))], lidar=(0.0, 0.0, 20.0))
    _view.write(page, content)
    print(f"{scene.number_of_triangles} triangles, {options.echoes} echoes, {len(content) / 1e6:.1f} MB")
    with Browser(1280, 720, graphics=True) as browser:
        begin = time.monotonic()
        browser.open(page)
        while not browser.run("return Boolean(window.avianLidar)"):
            time.sleep(0.05)
        print(f"first picture after {time.monotonic() - begin:.1f} s")
        rate, whole, click = browser.run(MOVING)
    print(f"{rate:.1f} frames a second while the camera moves; with all points a frame takes {whole:.2f} s, a click "
          f"{click:.2f} s")


if __name__ == "__main__":
    main()
