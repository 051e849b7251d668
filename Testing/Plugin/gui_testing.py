# SPDX-License-Identifier: BSD-3-Clause
"""What the tests of ParaView's window share: a display of its own, ParaView and servers on it. Run by the system's
Python."""

import contextlib
import json
import os
import pathlib
import re
import shutil
import signal
import socket
import subprocess
import tempfile
import time
import xml.etree.ElementTree as ElementTree

HERE = os.path.dirname(os.path.abspath(__file__))
SOURCE_DIR = os.environ["AVIANLIDAR_SOURCE_DIR"]
OUTPUT_DIR = os.environ["AVIANLIDAR_TEST_OUTPUT_DIR"]
PLUGIN_DIR = os.path.dirname(os.environ["AVIANLIDAR_PLUGIN"])
# With '=': ParaView 5.13 takes the next word for a file to open.
LOAD = (f"--plugin-search-paths={PLUGIN_DIR}", "--plugins=AvianLidarPlugin")
TIMEOUT = 800  # s, against what hangs
ATTEMPTS = 3  # at a free port


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
def display(width, height):
    """An X server on a free number: the environment of its clients."""
    reading, writing = os.pipe()
    # Without -noreset the server starts anew when its last client leaves, and turns away who comes just then.
    command = ["Xvfb", "-displayfd", str(writing), "-nocursor", "-noreset", "-screen", "0", f"{width}x{height}x24"]
    with running(command, pass_fds=[writing], stderr=subprocess.DEVNULL):
        os.close(writing)
        with os.fdopen(reading) as pipe:
            number = pipe.readline().strip()
        assert number, "Xvfb does not start"
        environment = dict(os.environ, DISPLAY=":" + number)
        environment.pop("XAUTHORITY", None)
        yield environment


def text_of(file_name):
    return pathlib.Path(file_name).read_text(encoding="utf-8", errors="replace")


@contextlib.contextmanager
def server(folder, ranks, arguments=LOAD):
    """A pvserver that waits for a client: its port."""
    log_name = os.path.join(folder, "server.log")
    with display(800, 600) as environment:
        for _ in range(ATTEMPTS):
            with socket.socket() as probe:
                probe.bind(("localhost", 0))
                port = probe.getsockname()[1]
            command = ["mpiexec", "-n", str(ranks)] if ranks > 1 else []
            command += ["pvserver", f"--server-port={port}", *arguments]
            with open(log_name, "w", encoding="utf-8") as log:
                with running(command, env=environment, stdout=log, stderr=log) as process:
                    # It ends when another program has taken its port meanwhile.
                    start = time.monotonic()
                    while process.poll() is None and "Accepting connection" not in text_of(log_name):
                        assert time.monotonic() - start < 120, text_of(log_name)
                        time.sleep(0.1)
                    if process.poll() is None:
                        yield port
                        return
        raise AssertionError(text_of(log_name))


def run_script(paraview, name, size, arguments, timeout=TIMEOUT, **environment):
    """Runs a script in ParaView's window, without anyone's settings: what it found (client_window.run). It may import
    what is in this folder.

    It leaves results.json, and what else it makes, in the folder of that name for temporary files, which is emptied;
    the log of the window is beside it."""
    folder = os.path.join(OUTPUT_DIR, name)
    shutil.rmtree(folder, ignore_errors=True)
    os.makedirs(folder)
    results, log_name = os.path.join(folder, "results.json"), folder + ".log"
    command = [paraview, "--dr", "-qwindowgeometry", f"{size[0]}x{size[1]}+0+0", *arguments]
    with tempfile.TemporaryDirectory() as home, open(log_name, "w",
                                                     encoding="utf-8") as log, display(*size) as variables:
        variables.pop("PV_MACRO_PATH", None)
        variables.update(HOME=home, QT_QPA_PLATFORM="xcb", AVIANLIDAR_PHOTOS=folder,
                         PYTHONPATH=os.pathsep.join([HERE, os.environ.get("PYTHONPATH", "")]), **environment)
        with running(command, env=variables, stdout=log, stderr=log) as process:
            start = time.monotonic()
            while not os.path.exists(results):
                said = text_of(log_name)
                assert process.poll() is None and "Traceback" not in said, said[-2000:]
                assert time.monotonic() - start < timeout, "the script does not come to its end"
                time.sleep(0.2)
    found = json.loads(pathlib.Path(results).read_text("utf-8"))
    assert not found["error"], found["error"]
    # of Qt; errors of the plugin are looked at by the script
    assert "critical:" not in text_of(log_name), text_of(log_name)
    return found


def play(paraview, events, arguments=()):
    """Starts ParaView without anyone's settings and plays events of ParaView's own player, which needs no Python.
    @return the state after the events, and the errors and warnings that ParaView has printed"""
    script = ElementTree.Element("pqevents")
    script.extend(events)
    for widget, command, value in (("menubar/menu_File", "activate", "actionFileSaveServerState"),
                                   ("FileSaveServerStateDialog", "filesSelected", "$PARAVIEW_TEST_ROOT/state.pvsm")):
        ElementTree.SubElement(script, "pqevent", object=f"pqClientMainWindow/{widget}", command=command,
                               arguments=value)
    with tempfile.TemporaryDirectory() as home, display(1280, 1024) as variables:
        for name in ("PV_MACRO_PATH", "PYTHONPATH"):
            variables.pop(name, None)
        variables.update(HOME=home, QT_QPA_PLATFORM="xcb")
        file_name = os.path.join(home, "events.xml")
        ElementTree.ElementTree(script).write(file_name)
        command = [paraview, "--dr", *LOAD, f"--test-directory={home}", f"--test-script={file_name}", "--exit",
                   *arguments]
        done = subprocess.run(command, env=variables, timeout=TIMEOUT, text=True, errors="replace",
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        assert done.returncode == 0, done.stdout
        return ElementTree.parse(os.path.join(home, "state.pvsm")), re.findall(
            r"^.*(?:ERR|WARN)\|.*(?:\n(?!.*\|).*)*", done.stdout, re.M)
