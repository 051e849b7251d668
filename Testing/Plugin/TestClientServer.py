# SPDX-License-Identifier: BSD-3-Clause
"""ParaView's window as a client of pvserver, of one process and of two: the airport from the menus gives the echoes of
one process alone, bit for bit, and saves files and a state; a server that has not loaded the plugin can do so later.

Run by the system's Python: TestClientServer.py paraview pvpython. What it saves is in the folders TestClientServer-* in
the one for temporary files, with a photo of the window."""

import contextlib
import os
import socket
import subprocess
import sys
import tempfile
import time

from gui_testing import OUTPUT_DIR, PLUGIN_DIR, display, empty, problems, run_script, running

SIZE = (1400, 1000)
TIMEOUT = 120
ATTEMPTS = 3  # at a free port
# What a server says when its client has left.
CLIENT_LEFT = ("Could not receive tag", "Could not receive length", "Some error in socket processing")
# Name, processes of the server, when it loads the plugin.
CASES = (("1", 1, "start"), ("2", 2, "start"), ("later", 1, "later"))


def free_port():
    """One that was free a moment ago."""
    with socket.socket() as probe:
        probe.bind(("localhost", 0))
        return probe.getsockname()[1]


@contextlib.contextmanager
def server(folder, ranks, load):
    """A pvserver that waits for a client: its port."""
    arguments = []
    if load == "start":
        arguments = [f"--plugin-search-paths={PLUGIN_DIR}", "--plugins=AvianLidarPlugin"]
    log_name = os.path.join(folder, "server.log")
    with display(tempfile.mkdtemp(dir=folder), 800, 600) as (name, _):
        environment = dict(os.environ, DISPLAY=name)
        environment.pop("XAUTHORITY", None)
        for _ in range(ATTEMPTS):
            port = free_port()
            command = ["mpiexec", "-n", str(ranks)] if ranks > 1 else []
            command += ["pvserver", f"--server-port={port}", *arguments]
            with open(log_name, "w", encoding="utf-8") as log:
                with running(command, env=environment, stdout=log, stderr=log) as process:
                    if accepts(process, log_name):
                        yield port
                        return
        raise AssertionError(text_of(log_name))


def accepts(process, log_name):
    """Waits for the server to wait for a client; False if it ends instead, as it does when another program has taken its
    port meanwhile."""
    start = time.monotonic()
    while "Accepting connection" not in text_of(log_name):
        if process.poll() is not None:
            return False
        assert time.monotonic() - start < TIMEOUT, text_of(log_name)
        time.sleep(0.1)
    return True


def text_of(file_name):
    with open(file_name, encoding="utf-8", errors="replace") as file:
        return file.read()


def photos_of(name):
    return os.path.join(OUTPUT_DIR, "TestClientServer-" + name)


def connect(paraview, name, ranks, load):
    """The results of client_server_steps.py."""
    photos = photos_of(name)
    empty(photos)
    with tempfile.TemporaryDirectory() as folder, server(folder, ranks, load) as port:
        url = [f"--server-url=cs://localhost:{port}"]
        # With --plugins a client loads it after the server's XML has come: without the two domains of ours.
        found = run_script(paraview, "client_server_steps.py", photos, SIZE, url, TIMEOUT,
                           expected=("Could not create object of type: vtkSMAvianLidar",), AVIANLIDAR_LOAD=load)
        lines = problems(os.path.join(folder, "server.log"))
        wrong = [line for line in lines if not any(text in line for text in CLIENT_LEFT)]
        assert not wrong, wrong
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
        assert (found["half_beamwidth"], found["beamwidth"]) == (4e-3, 11.2), found
        # The server's progress reaches the client.
        assert any("AvianLidar" in text for text in found["progress"]), found["progress"]
        assert not found.get("without"), found
        if load == "later":
            assert found["told"].startswith("Avian lidar airport: load the plugin on the server, too"), found
            assert found["made"] == 0, found
    subprocess.run([pvpython, __file__, "--check"], check=True)


if __name__ == "__main__":
    if sys.argv[1] == "--check":
        check()
    else:
        main(*sys.argv[1:])
