# SPDX-License-Identifier: BSD-3-Clause
"""ParaView's window: airport_gui.xml builds the airport from the menus, the state that it saves gives the echoes that
a script gets, and the window is photographed.

Run by the system's Python: TestGui.py paraview pvpython [picture.png]. The window's photo goes to TestGui.png in the
folder for temporary files or to the picture; that is how Documentation/images/paraview.png is made (with Debian's
libqt5svg5, without which ParaView has no icons). The display is an Xvfb of its own whose frame buffer is a file, so the
photo shows what a user sees, dialogs and all."""

import contextlib
import os
import re
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import time
import zlib

import numpy

HERE = os.path.dirname(os.path.abspath(__file__))
SOURCE_DIR = os.environ["AVIANLIDAR_SOURCE_DIR"]
OUTPUT_DIR = os.environ["AVIANLIDAR_TEST_OUTPUT_DIR"]
PLUGIN_DIR = os.path.dirname(os.environ["AVIANLIDAR_PLUGIN"])
WIDTH, HEIGHT = 1600, 1000
TIMEOUT = 240

# A panel wide enough for its texts; by default ParaView makes it as narrow as it can.
STYLE = "#propertiesPanel { min-width: 400px; }"


@contextlib.contextmanager
def running(command, **options):
    process = subprocess.Popen(command, start_new_session=True, **options)
    try:
        yield process
    finally:
        if process.poll() is None:
            os.killpg(process.pid, signal.SIGTERM)
            try:
                process.wait(20)
            except subprocess.TimeoutExpired:
                os.killpg(process.pid, signal.SIGKILL)
                process.wait()


@contextlib.contextmanager
def display(folder):
    """An X server on a free number with its picture in a file: (its name, the file)."""
    reading, writing = os.pipe()
    command = ["Xvfb", "-displayfd", str(writing), "-nocursor", "-fbdir", folder]
    command += ["-screen", "0", f"{WIDTH}x{HEIGHT}x24"]
    with running(command, pass_fds=[writing], stderr=subprocess.DEVNULL):
        os.close(writing)
        with os.fdopen(reading) as pipe:
            number = pipe.readline().strip()
        assert number, "Xvfb does not start"
        yield ":" + number, os.path.join(folder, "Xvfb_screen0")


def photograph(frame_buffer):
    """The screen as an array (rows, columns, rgb); the file is in the format of xwd."""
    with open(frame_buffer, "rb") as file:
        data = file.read()
    header = struct.unpack(">20I", data[:80])
    size, width, height, little_endian, line = header[0], header[4], header[5], header[7] == 0, header[12]
    colours = header[19]
    pixels = numpy.frombuffer(data, numpy.uint8, line * height, size + 12 * colours).reshape(height, line)
    pixels = pixels[:, : 4 * width].reshape(height, width, 4)
    return pixels[:, :, 2::-1] if little_endian else pixels[:, :, 1:]


def write_png(file_name, pixels):
    def chunk(kind, content):
        return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))

    height, width, _ = pixels.shape
    rows = b"".join(b"\0" + row.tobytes() for row in pixels)
    with open(file_name, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n")
        file.write(chunk(b"IHDR", struct.pack(">2I5B", width, height, 8, 2, 0, 0, 0)))
        file.write(chunk(b"IDAT", zlib.compress(rows, 9)) + chunk(b"IEND", b""))


def play(paraview, folder):
    """Plays the script; the photo of the window at its end."""
    macros = os.path.join(folder, "home", ".config", "ParaView", "Macros")
    os.makedirs(macros)
    shutil.copy(os.path.join(PLUGIN_DIR, "Macros", "avian_lidar_energy_colours.py"), macros)
    shutil.copy(os.path.join(HERE, "airport_gui_style.py"), macros)
    style = os.path.join(folder, "style.qss")
    with open(style, "w", encoding="utf-8") as file:
        file.write(STYLE)
    state = os.path.join(OUTPUT_DIR, "TestGui.pvsm")
    if os.path.exists(state):
        os.remove(state)
    log_name = os.path.join(OUTPUT_DIR, "TestGui.log")
    with display(folder) as (name, frame_buffer), open(log_name, "w", encoding="utf-8") as log:
        environment = dict(os.environ, DISPLAY=name, HOME=os.path.join(folder, "home"), QT_QPA_PLATFORM="xcb")
        environment.pop("XAUTHORITY", None)
        command = [paraview, "--dr", "-stylesheet", style, "-qwindowgeometry", f"{WIDTH}x{HEIGHT}+0+0"]
        command += ["--plugin-search-paths", PLUGIN_DIR, "--plugins", "AvianLidarPlugin"]
        command += ["--data-directory", os.path.join(SOURCE_DIR, "Examples", "airport", "scene")]
        command += ["--test-directory", OUTPUT_DIR, "--test-script", os.path.join(HERE, "airport_gui.xml")]
        with running(command, env=environment, stdout=log, stderr=log) as process:
            start = time.monotonic()
            while not os.path.exists(state) and not problems(log_name):
                assert process.poll() is None, "ParaView has ended"
                assert time.monotonic() - start < TIMEOUT, "the script does not come to its end"
                time.sleep(0.5)
            # The state is written in one go; let the window draw itself.
            time.sleep(3)
            picture = photograph(frame_buffer)
    assert not problems(log_name), problems(log_name)
    return picture


def problems(log_name):
    with open(log_name, encoding="utf-8", errors="replace") as log:
        return [line for line in log if re.search(r"critical:|ERR\||Traceback|Avian lidar colours:", line)]


def check_picture(picture):
    """Echoes of all colours between blue and green, on grey surfaces."""
    red, green, blue = (picture[:, :, i].astype(int) for i in range(3))
    for name, found in (
        ("blue", (blue > 200) & (red < 50) & (green < 100)),
        ("cyan", (blue > 150) & (green > 150) & (red < 50)),
        ("grey", (abs(red - green) < 12) & (abs(green - blue) < 14) & (red > 80) & (red < 200)),
    ):
        count = numpy.count_nonzero(found)
        assert count > 300, f"{count} {name} pixels"


def check_state():
    """In pvpython: the saved state and the same pipeline as a script give the same echoes."""
    from paraview import simple

    from plugin_testing import airport, assert_same, fetch, load_plugin

    load_plugin()
    simple.LoadState(os.path.join(OUTPUT_DIR, "TestGui.pvsm"))
    found = fetch(simple.FindSource("AvianLidarEchoFilter1"))
    assert len(found["energy"]) > 1000
    _, _, _, echoes = airport()
    assert_same(found, fetch(echoes))


def main(paraview, pvpython, picture_name=None):
    with tempfile.TemporaryDirectory() as folder:
        picture = play(paraview, folder)
    write_png(picture_name or os.path.join(OUTPUT_DIR, "TestGui.png"), picture)
    check_picture(picture)
    subprocess.run([pvpython, __file__, "--check-state"], check=True)


if __name__ == "__main__":
    if sys.argv[1] == "--check-state":
        check_state()
    else:
        main(*sys.argv[1:])
