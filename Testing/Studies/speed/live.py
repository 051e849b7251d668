#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Measures how fast ParaView's window follows a value that is changed step by step, and writes the page about it.

    Testing/Studies/speed/live.py BUILD_FOLDER [steps]

A scan of the airport by Airport32, Auto Apply on, a window of 1600 x 1000 pixels drawn by software on a display of its
own (Testing/Plugin/live_steps.py). Says how busy the machine was."""
import argparse
import os
import pathlib
import statistics
import sys

SOURCE = pathlib.Path(__file__).resolve().parents[3]
PAGE = SOURCE / "Documentation" / "results" / "live.md"

PAGE_TEXT = """# Live changes in ParaView: results

How fast ParaView's window follows a changed property. What it means: [In ParaView](../paraview.md#live-changes).
Made by `Testing/Studies/speed/live.py build/paraview {steps}`: not to be edited.

The airport Hongqiao, Airport32 (61,440 beams x 100 rays), tree and echoes in one view, all other settings at their
defaults. {cores} cores; load average {load_before:.1f} before and {load_after:.1f} after, so clock times are those of {busy} machine.
Software OpenGL in a window of 1600 x 1000 pixels. Each number is the median of {steps} steps (the fastest in brackets), in milliseconds.

In a script, a step of the attenuation coefficient takes {update} in `UpdatePipeline()` and {render} in `Render()`.

In the window, with Auto Apply, from the key to the end of the frame. *Main thread* is the processor time of ParaView's
main thread: without other threads (lighting beams, drawing pixels) and all waiting. *Rays traced* is the sum of all steps.

| property | clock | main thread | echo filter | drawing | updates per second, by the fastest | rays traced |
|---|---|---|---|---|---|---|
{rows}
The first scan traced {first[Custom]:,.0f} rays, with the preset Standard {first[Standard]:,.0f}. After each row the echoes are those
of a new scan, bit for bit. The rest of the time is ParaView's: ranges of all arrays for its panels, geometry of the
echoes, the panel itself.
"""


def milliseconds(seconds):
    return f"{1000 * statistics.median(seconds):.0f} ({1000 * min(seconds):.0f})"


def row(name, change):
    cells = [milliseconds(change[key]) for key in ("wall", "main", "filter", "drawing")]
    return f"| {name} | {' | '.join(cells)} | {1 / min(change['wall']):.1f} | {change['rays']:,.0f} |\n"


def main(argv):
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n", maxsplit=1)[0])
    parser.add_argument("build", type=pathlib.Path, help="folder of the build")
    parser.add_argument("steps", nargs="?", default="30", help="steps of each property, default 30")
    options = parser.parse_args(argv)
    build, steps = options.build.resolve(), options.steps
    os.environ["AVIANLIDAR_SOURCE_DIR"] = str(SOURCE)
    os.environ["AVIANLIDAR_TEST_OUTPUT_DIR"] = str(build / "Testing" / "Temporary")
    plugin = next((build / "lib").glob("paraview-*/plugins/AvianLidarPlugin/AvianLidarPlugin.so"))
    os.environ["AVIANLIDAR_PLUGIN"] = str(plugin)
    sys.path.insert(0, str(SOURCE / "Testing" / "Plugin"))
    from gui_testing import HERE, LOAD, run_script

    before = os.getloadavg()[0]
    script = os.path.join(HERE, "live_steps.py")
    found = run_script("paraview", "live", (1600, 1000), [*LOAD, "--script", script], timeout=1800, AVIANLIDAR_STEPS=steps)
    after = os.getloadavg()[0]
    busy = "a quiet" if before < os.cpu_count() / 2 else "a busy"
    PAGE.write_text(PAGE_TEXT.format(
        steps=steps, cores=os.cpu_count(), load_before=before, load_after=after, busy=busy,
        update=milliseconds(found["scripted"]["update"]), render=milliseconds(found["scripted"]["render"]),
        first=found["first"], rows="".join(row(*item) for item in found["changes"].items())),
        encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
