# SPDX-License-Identifier: BSD-3-Clause
"""What compares instruction sets and counts instructions asks loader and valgrind what is there: what they do not say
is no fault, and a valgrind that cannot start the program is a reason to skip. Stand-ins answer as they do elsewhere."""
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

SOURCE = pathlib.Path(os.environ["AVIANLIDAR_SOURCE_DIR"])
COUNTER = SOURCE / "Testing" / "Benchmarks" / "Instructions" / "check_instructions.py"
sys.path.insert(0, str(SOURCE / "Testing" / "Kernel"))
import compare_instruction_sets  # noqa: E402

HELP = """Subdirectories of glibc-hwcaps directories, in priority order:
  x86-64-v4{}
  x86-64-v3{}
  x86-64-v2 (supported, searched)
"""
HAS = " (supported, searched)"
UNKNOWN = "vex amd64->IR: unhandled instruction bytes: 0xF 0x1 0xF9 0x48 0xC1"


class InstructionScripts(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()))

    def stand_in(self, text):
        file = self.folder / "program"
        file.write_text(f"#!/bin/sh\n{text}\n", encoding="ascii")
        file.chmod(0o755)
        return str(file)

    def test_the_loader_says_what_the_processor_has(self):
        for text, expected in ((HELP.format(HAS, HAS), "x86-64-v4"), (HELP.format("", HAS), "x86-64-v3"),
                               (HELP.format("", ""), "x86-64"), ("Usage: ld.so [OPTION]", None)):
            self.assertEqual(compare_instruction_sets.set_of_this_processor(self.stand_in(f"echo '{text}'")), expected)
        self.assertIsNone(compare_instruction_sets.set_of_this_processor(str(self.folder / "none")))

    def test_nothing_is_counted_where_valgrind_cannot(self):
        cases = ((f"echo '{UNKNOWN}' >&2; kill -ILL $$", f"cannot start a Highway program .*{UNKNOWN[15:40]}"),
                 (f"case \"$*\" in *--help) echo '{HELP.format('', '')}';; esac", "AVX2"))
        for script, reason in cases:
            done = subprocess.run([sys.executable, COUNTER, "--valgrind", self.stand_in(script), "--program", "cases",
                                   "--compiler", "GNU 12.2.0"], capture_output=True, text=True, check=False)
            self.assertEqual(done.returncode, 77, done.stderr)
            self.assertRegex(done.stdout, f"^skipped: .*{reason}")

    def test_a_count_that_fails_otherwise_is_a_failure(self):
        script = f"case \"$*\" in *--help) echo '{HELP.format(HAS, HAS)}';; *callgrind*) exit 1;; esac"
        done = subprocess.run([sys.executable, COUNTER, "--valgrind", self.stand_in(script), "--program", "cases",
                               "--compiler", "GNU 12.2.0"], capture_output=True, text=True, check=False)
        self.assertEqual((done.returncode, done.stderr.split(":")[0]), (1, "trace-boxes failed under callgrind"))


if __name__ == "__main__":
    unittest.main()
