# SPDX-License-Identifier: BSD-3-Clause
"""ParaView's window as a client of pvserver; server_steps.py does the steps. Two ranks load the plugin when they
start; with "later" one process loads it when asked.

Run by the system's Python: TestServer.py paraview pvpython [later]."""

import os
import re
import sys
import tempfile

from gui_testing import HERE, LOAD, run_script, server, text_of

SIZE = (1200, 900)
CLIENT_LEFT = "Could not receive|Some error in socket processing"


def main(paraview, _, later=""):
    with tempfile.TemporaryDirectory() as folder, server(folder, 1 if later else 2, () if later else LOAD) as port:
        arguments = [f"--server-url=cs://localhost:{port}", *LOAD, "--script", os.path.join(HERE, "server_steps.py")]
        run_script(paraview, "TestServer" + later, SIZE, arguments, AVIANLIDAR_LATER=later,
                   AVIANLIDAR_RANKS="1" if later else "2")
        lines = re.findall("^.*(?:ERR\\||Traceback).*$", text_of(os.path.join(folder, "server.log")), re.MULTILINE)
        if later:  # nothing fails there
            wrong = [line for line in lines if not re.search(CLIENT_LEFT, line)]
            assert not wrong, wrong


if __name__ == "__main__":
    main(*sys.argv[1:])
