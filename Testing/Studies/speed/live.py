# SPDX-License-Identifier: BSD-3-Clause
"""How fast ParaView's window follows a value that is changed step by step. Leaves a table.

    Testing/Studies/run.py live --steps 30

A scan of the airport by Airport32 with 100 rays, Auto Apply on, a window of 1600 x 1000 pixels drawn by software on a display of its
own (Testing/Plugin/live_steps.py). Each number is the median of the steps (the fastest in brackets), in milliseconds, from the key to
the end of the frame. The main thread's is processor time, without threads that light beams or draw, and without waiting.
"""
import os
import pathlib
import statistics
import sys

import tools
from running import argument, study

SOURCE = pathlib.Path(__file__).resolve().parents[3]


def milliseconds(seconds):
    return f"{1000 * statistics.median(seconds):.0f} ({1000 * min(seconds):.0f})"


def row(name, change):
    return (name, *(milliseconds(change[key]) for key in ("wall", "main", "filter", "drawing")), f"{1 / min(change['wall']):.1f}",
            f"{change['rays']:,.0f}")


@study(argument("--build", type=pathlib.Path, default=SOURCE / "build" / "paraview", help="folder of the build"),
       argument("--steps", default="30", help="steps of each property, default 30"))
def main(options):
    build = options.build.resolve()
    os.environ["AVIANLIDAR_SOURCE_DIR"] = str(SOURCE)
    os.environ["AVIANLIDAR_TEST_OUTPUT_DIR"] = str(build / "Testing" / "Temporary")
    os.environ["AVIANLIDAR_PLUGIN"] = str(next((build / "lib").glob("paraview-*/plugins/AvianLidarPlugin/AvianLidarPlugin.so")))
    sys.path.insert(0, str(SOURCE / "Testing" / "Plugin"))
    from gui_testing import HERE, LOAD, run_script

    before, script = os.getloadavg()[0], os.path.join(HERE, "live_steps.py")
    found = run_script("paraview", "live", (1600, 1000), [*LOAD, "--script", script], timeout=1800, AVIANLIDAR_STEPS=options.steps)
    tools.leave(options.out, "live", ("property", "clock", "main thread", "echo filter", "drawing", "updates per second, by the fastest",
                                      "rays traced"), [row(*item) for item in found["changes"].items()])
    scripted = {name: milliseconds(seconds) for name, seconds in found["scripted"].items()}
    print(f"{os.cpu_count()} cores, load average {before:.1f} before and {os.getloadavg()[0]:.1f} after. By a script, a step of the "
          f"attenuation coefficient takes {scripted['update']} in UpdatePipeline() and {scripted['render']} in Render(). The first "
          f"scan traced {found['first']['Custom']:,.0f} rays, with the preset Standard {found['first']['Standard']:,.0f}.")
