# SPDX-License-Identifier: BSD-3-Clause
"""Scripts that install say what they do: how much they download, each step, all progress on a terminal, and in a log a
line at intervals, and all output only where a command fails. A stand-in for apt answers."""
import os
import pathlib
import re
import subprocess
import tempfile
import unittest

from helpertools import from_terminal

SOURCE = pathlib.Path(os.environ["AVIANLIDAR_SOURCE_DIR"])
# Lists of packages are there once they were fetched; $BAD fails once with old ones, or for ever.
APT = """#!/bin/sh
echo "$@" >> "$HERE/calls"
case " $* " in
  *" --print-uris "*) [ -e "$HERE/lists" ] || { echo "E: no lists" >&2; exit 100; }
    echo "'https://there/a.deb' a.deb 400000000 MD5Sum:0"
    echo "'https://there/b.deb' b.deb 160400000 MD5Sum:0"; exit ;;
  *" update "*) touch "$HERE/lists" ;;
  *" --download-only "*) echo "Get:1 a"
    [ "$BAD" = once ] && [ ! -e "$HERE/once" ] && { touch "$HERE/once"; echo "E: 404" >&2; exit 100; } ;;
  *) echo "Unpacking a"; [ "$BAD" = ever ] && { echo "E: broken" >&2; exit 100; } ;;
esac
exit 0
"""
SCRIPT = [SOURCE / "CMake" / "install-packages.sh", "packages"]
PROGRESS = SOURCE / "CMake" / "with-progress.sh"
DOWNLOAD = "Downloading 2 packages, 560 MB"


class Packages(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()))
        for name, text in (("apt-get", APT), ("dpkg-query", "#!/bin/sh\n"), ("id", "#!/bin/sh\necho 0\n")):
            (self.folder / name).write_text(text, "ascii")
            (self.folder / name).chmod(0o755)

    def environment(self, bad="", lists=True):
        (self.folder / "lists").touch() if lists else None
        return {**os.environ, "PATH": f"{self.folder}:{os.environ['PATH']}", "HERE": str(self.folder), "BAD": bad}

    def test_a_log_has_a_line_for_each_step(self):
        """Lists of packages are fetched where they are needed; what apt said is shown where it fails."""
        for bad, lists, code, words in (("", True, 0, [DOWNLOAD, "Installing what was downloaded"]),
                                        ("", False, 0,
                                         ["Fetching lists of packages", DOWNLOAD, "Installing what was downloaded"]),
                                        ("once", True, 0, [DOWNLOAD, "Get:1 a", "E: 404", "Fetching lists of packages",
                                                           DOWNLOAD, "Installing what was downloaded"]),
                                        ("ever", True, 100,
                                         [DOWNLOAD, "Installing what was downloaded", "Unpacking a", "E: broken"])):
            with self.subTest(bad=bad, lists=lists):
                (self.folder / "lists").unlink(missing_ok=True)
                done = subprocess.run(SCRIPT, env=self.environment(bad, lists), check=False, capture_output=True,
                                      text=True)
                self.assertEqual((done.returncode, done.stdout.splitlines()[1:]), (code, words))

    def test_a_log_has_lines_on_a_long_step(self):
        """With the last line of what the command said so far, but of a compiler's output the warnings alone."""
        program = "echo one; sleep 0.5; echo two; sleep 0.5; echo 'a.c:1: warning: odd'; exit $0"
        words = [PROGRESS, "sh", "-c", program]
        environment = {**os.environ, "AVIANLIDAR_INTERVAL": "0.2"}
        for code, rest in (("0", ["a.c:1: warning: odd"]), ("3", ["one", "two", "a.c:1: warning: odd"])):
            done = subprocess.run([*words, code], env=environment, check=False, capture_output=True, text=True)
            lines = [line for line in done.stdout.splitlines() if line.startswith("  0 min ")]
            self.assertEqual((done.returncode, done.stdout.splitlines()[len(lines):]), (int(code), rest))
            self.assertLessEqual({"one", "two"}, {line.partition(" s: ")[2] for line in lines})
        text, code = from_terminal(self, [*words, "3"], env=environment)
        self.assertEqual((code, text.split()), (3, "one two a.c:1: warning: odd".split()))

    def test_scripts_that_take_minutes_show_their_progress(self):
        """The scripts for users: every step that builds or makes packages."""
        for script in ("CMake/install.sh", "Testing/run.sh",
                       *(str(one.relative_to(SOURCE)) for one in SOURCE.glob("Examples/*/run.sh"))):
            for line in (SOURCE / script).read_text("utf-8").splitlines():
                if re.match(r"[^#]*(cmake --build|cpack )", line):
                    self.assertRegex(line, "^CMake/with-progress.sh ", script)

    def test_a_terminal_sees_the_progress(self):
        text, code = from_terminal(self, SCRIPT, env=self.environment())
        self.assertEqual(code, 0)
        for words in (DOWNLOAD, "Get:1 a", "Unpacking a"):
            self.assertIn(words, text)
