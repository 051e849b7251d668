# SPDX-License-Identifier: BSD-3-Clause
"""ParaView's window as a client of pvserver, of one process and of two: the airport from the menus gives the echoes of
one process alone, bit for bit, and saves files and a state; a server that has not loaded the plugin can do so later.

Run by the system's Python: TestClientServer.py paraview pvpython. What it saves is in the folders TestClientServer-* in
the one for temporary files, with a photo of the window."""

import contextlib
import json
import os
import shutil
import socket
import subprocess
import sys
import tempfile
import time

from gui_testing import HERE, OUTPUT_DIR, PLUGIN_DIR, display, problems, running, wait_for, window

SIZE = (1400, 1000)
TIMEOUT = 120
# Name, processes of the server, when it loads the plugin.
CASES = (("1", 1, "start"), ("2", 2, "start"), ("later", 1, "later"))


def free_port():
    with socket.socket() as probe:
        probe.bind(("localhost", 0))
        return probe.getsockname()[1]


@contextlib.contextmanager
def server(folder, ranks, load):
    """A pvserver that waits for a client: its port."""
    port = free_port()
    command = ["pvserver", f"--server-port={port}"]
    if load == "start":
        command += ["--plugin-search-paths", PLUGIN_DIR, "--plugins", "AvianLidarPlugin"]
    if ranks > 1:
        command = ["mpiexec", "-n", str(ranks), *command]
    log_name = os.path.join(folder, "server.log")
    with display(tempfile.mkdtemp(dir=folder), 800, 600) as (name, _), open(log_name, "w", encoding="utf-8") as log:
        environment = dict(os.environ, DISPLAY=name)
        environment.pop("XAUTHORITY", None)
        with running(command, env=environment, stdout=log, stderr=log) as process:
            start = time.monotonic()
            while "Accepting connection" not in text_of(log_name):
                assert process.poll() is None, text_of(log_name)
                assert time.monotonic() - start < TIMEOUT, text_of(log_name)
                time.sleep(0.1)
            yield port


def text_of(file_name):
    with open(file_name, encoding="utf-8", errors="replace") as file:
        return file.read()


def photos_of(name):
    return os.path.join(OUTPUT_DIR, "TestClientServer-" + name)


def connect(paraview, name, ranks, load):
    """The results of client_server_steps.py."""
    photos = photos_of(name)
    shutil.rmtree(photos, ignore_errors=True)
    os.makedirs(photos)
    results, log_name = os.path.join(photos, "results.json"), os.path.join(photos, "client.log")
    environment = {"AVIANLIDAR_RESULTS": results, "AVIANLIDAR_PHOTOS": photos, "AVIANLIDAR_LOAD": load}
    environment["PYTHONPATH"] = os.pathsep.join([HERE, os.environ.get("PYTHONPATH", "")])
    with tempfile.TemporaryDirectory() as folder, server(folder, ranks, load) as port:
        arguments = [f"--server-url=cs://localhost:{port}", "--script", os.path.join(HERE, "client_server_steps.py")]
        with open(log_name, "w", encoding="utf-8") as log:
            with window(paraview, folder, log, arguments, SIZE, **environment) as (process, _):
                wait_for(results, process, log_name, TIMEOUT)
        assert not problems(log_name), problems(log_name)
        # What a server says when its client has left is no error of ours.
        wrong = [line for line in problems(os.path.join(folder, "server.log")) if "ocket" not in line]
        assert not wrong, wrong
    found = json.loads(text_of(results))
    assert not found["error"], found["error"]
    return found


def check():
    """In pvpython: what each client fetched is what one process makes, and the state brings it back."""
    import numpy
    from paraview import simple

    from plugin_testing import COSTS, airport, assert_same, fetch, load_plugin

    load_plugin()
    echoes = airport()[3]
    expected = [fetch(echoes, port) for port in (0, 1)]
    for name, _, _ in CASES:
        for port, wanted in enumerate(expected):
            loaded = dict(numpy.load(os.path.join(photos_of(name), f"port{port}.npz")))
            keys = [loaded[key] for key in ("return_number", "beam_id") if key in loaded]
            order = numpy.lexsort(keys)
            found = {key: values[order] for key, values in loaded.items() if key not in COSTS}
            assert_same(found, {key: values for key, values in wanted.items() if key != "points"})
        assert os.path.getsize(os.path.join(photos_of(name), "echoes.las")) > 10000
        simple.ResetSession()
        simple.LoadState(os.path.join(photos_of(name), "state.pvsm"))
        assert_same(fetch(simple.FindSource("AvianLidarEchoFilter1")), expected[0])


def main(paraview, pvpython):
    for name, ranks, load in CASES:
        found = connect(paraview, name, ranks, load)
        assert found["server"] == ranks and found["echoes"] > 1000, found
        # The server's progress reaches the client.
        assert any("AvianLidar" in text for text in found["progress"]), found["progress"]
        assert not found.get("without"), found
    subprocess.run([pvpython, __file__, "--check"], check=True)


if __name__ == "__main__":
    if sys.argv[1] == "--check":
        check()
    else:
        main(*sys.argv[1:])
