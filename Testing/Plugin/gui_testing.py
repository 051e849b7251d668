# SPDX-License-Identifier: BSD-3-Clause
"""What the tests of ParaView's window share: a display whose picture is a file, and ParaView on it.

Run by the system's Python. The display is an Xvfb of its own whose frame buffer is a file, so a photo shows what a user
sees, dialogs and all."""

import contextlib
import json
import os
import re
import shutil
import signal
import struct
import subprocess
import tempfile
import time
import zlib

import numpy

HERE = os.path.dirname(os.path.abspath(__file__))
SOURCE_DIR = os.environ["AVIANLIDAR_SOURCE_DIR"]
OUTPUT_DIR = os.environ["AVIANLIDAR_TEST_OUTPUT_DIR"]
PLUGIN_DIR = os.path.dirname(os.environ["AVIANLIDAR_PLUGIN"])
TIMEOUT = 800  # s, against what hangs


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
def display(folder, width, height):
    """An X server on a free number with its picture in a file: (its name, the file)."""
    reading, writing = os.pipe()
    # Without -noreset the server starts anew when its last client leaves, and turns away who comes just then.
    command = ["Xvfb", "-displayfd", str(writing), "-nocursor", "-noreset", "-fbdir", folder]
    command += ["-screen", "0", f"{width}x{height}x24"]
    with running(command, pass_fds=[writing], stderr=subprocess.DEVNULL):
        os.close(writing)
        with os.fdopen(reading) as pipe:
            number = pipe.readline().strip()
        assert number, "Xvfb does not start"
        yield ":" + number, os.path.join(folder, "Xvfb_screen0")


@contextlib.contextmanager
def window(paraview, folder, log, arguments, size, style="", plugin=True, **environment):
    """ParaView without anyone's settings, the plugin loaded or not, on a display of its own: (process, frame buffer)."""
    os.makedirs(os.path.join(folder, "home"), exist_ok=True)
    style_file = os.path.join(folder, "style.qss")
    with open(style_file, "w", encoding="utf-8") as file:
        file.write(style)
    with display(folder, *size) as (name, frame_buffer):
        variables = dict(os.environ, DISPLAY=name, HOME=os.path.join(folder, "home"), QT_QPA_PLATFORM="xcb")
        variables.pop("XAUTHORITY", None)
        variables.pop("PV_MACRO_PATH", None)
        variables.update(environment)
        command = [paraview, "--dr", "-stylesheet", style_file, "-qwindowgeometry", f"{size[0]}x{size[1]}+0+0"]
        if plugin:
            # With '=': ParaView 5.13 takes the next word for a file to open.
            command += [f"--plugin-search-paths={PLUGIN_DIR}", "--plugins=AvianLidarPlugin"]
        command += arguments
        with running(command, env=variables, stdout=log, stderr=log) as process:
            yield process, frame_buffer


def wait_for(file_name, process, log_name, timeout=TIMEOUT, expected=()):
    """Until the file is there."""
    start = time.monotonic()
    while not os.path.exists(file_name):
        assert not problems(log_name, expected), problems(log_name, expected)
        assert process.poll() is None, "ParaView has ended"
        assert time.monotonic() - start < timeout, "the script does not come to its end"
        time.sleep(0.2)


def run_script(
    paraview, script, folder, size, arguments=(), timeout=TIMEOUT, meanwhile=None, expected=(), **options
):
    """Runs a script of this folder in ParaView's window: what it found (client_window.run).

    It leaves results.json, and what else it makes, in the folder; the log of the window is beside that. An error in
    either fails, but for lines of the log with one of the expected words. meanwhile(process, log's name, frame buffer, results' name) is called while the script is at work; the
    options are those of window()."""
    os.makedirs(folder, exist_ok=True)
    results, log_name = os.path.join(folder, "results.json"), folder + ".log"
    if os.path.exists(results):
        os.remove(results)
    options["AVIANLIDAR_PHOTOS"] = folder
    options["PYTHONPATH"] = os.pathsep.join([HERE, os.environ.get("PYTHONPATH", "")])
    arguments = [*arguments, "--script", os.path.join(HERE, script)]
    with tempfile.TemporaryDirectory() as home, open(log_name, "w", encoding="utf-8") as log:
        with window(paraview, home, log, arguments, size, **options) as (process, frame_buffer):
            if meanwhile:
                meanwhile(process, log_name, frame_buffer, results)
            wait_for(results, process, log_name, timeout, expected)
    assert not problems(log_name, expected), problems(log_name, expected)
    with open(results, encoding="utf-8") as file:
        found = json.load(file)
    assert not found["error"], found["error"]
    return found


def empty(folder):
    """An empty folder."""
    shutil.rmtree(folder, ignore_errors=True)
    os.makedirs(folder)


def problems(log_name, expected=()):
    """Lines of a log that tell of an error, without those with an expected word."""
    with open(log_name, encoding="utf-8", errors="replace") as log:
        found = [line for line in log if re.search(r"critical:|ERR\||Traceback|Avian lidar [a-z ]+:", line)]
    return [line for line in found if not any(word in line for word in expected)]


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
