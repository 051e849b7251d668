#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The README's two commands on a bare Debian with today's updates, made by debootstrap and thrown away: the airport,
and all tests; then again, where nothing is left to do. Their times and sizes, and checksums of results (bits.py),
become a row of Documentation/evidence/tables/two-commands.csv; checksums that differ from those of the other system at
the same commit are a failure.

Needs root, the network and 20 GB in $TMPDIR. What is not committed takes no part. AVIANLIDAR_DATA_DIR is seen there,
too."""
import argparse
import csv
import datetime
import os
import pathlib
import re
import resource
import shutil
import subprocess
import sys
import tempfile
import time

SOURCE = pathlib.Path(__file__).resolve().parents[2]
TABLE = SOURCE / "Documentation/evidence/tables/two-commands.csv"
SYSTEMS = {"bookworm": "Debian 12", "trixie": "Debian 13"}
AIRPORT, TESTS = "Examples/airport/run.sh", "Testing/run.sh"
BITS = "PYTHONPATH=$(cat build/paraview/python-path) /usr/bin/python3 Testing/Packages/bits.py"
CLONE = "/root/avian-lidar"
# A root that is a mount point, so that tests in it may mount; /dev and data are the machine's; all mounts end with the
# command.
ENTER = """mount --bind "$0" "$0"; mount -t proc proc "$0/proc"; mount --rbind /dev "$0/dev"
[ -z "$1" ] || { mkdir -p "$0$1"; mount --bind "$1" "$0$1"; }
exec chroot "$0" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LC_ALL=C.UTF-8 AVIANLIDAR_DATA_DIR="$1" \\
  sh -c "cd $2 && $3" """


class System:
    def __init__(self, release, folder):
        self.root, self.log = folder / "root", folder / "output"
        made = subprocess.run([SOURCE / "Testing/Packages/bare_system.sh", release, self.root], check=False)
        if made.returncode:
            sys.exit(made.returncode)
        subprocess.run(["git", "clone", "--quiet", SOURCE, f"{self.root}{CLONE}"], check=True)

    def run(self, command):
        """Seconds by the clock and of processors, and what was printed last. A command that fails ends the test."""
        began, before = time.monotonic(), resource.getrusage(resource.RUSAGE_CHILDREN)
        with self.log.open("wb") as log:
            done = subprocess.run(["unshare", "--mount", "--pid", "--fork", "--kill-child", "sh", "-euc", ENTER,
                                   self.root, os.environ.get("AVIANLIDAR_DATA_DIR", ""), CLONE, command],
                                  stdin=subprocess.DEVNULL, stdout=log, stderr=subprocess.STDOUT, check=False)
        seconds, after = time.monotonic() - began, resource.getrusage(resource.RUSAGE_CHILDREN)
        processors = sum(getattr(after, name) - getattr(before, name) for name in ("ru_utime", "ru_stime"))
        text = self.log.read_text(errors="replace")
        print(f"$ {command}: {seconds:.0f} s, of processors {processors:.0f} s\n{text[-3000:]}", flush=True)
        if done.returncode:
            shutil.copy(self.log, pathlib.Path.cwd() / "bare_commands_output.txt")
            sys.exit(f"ERROR: {command}: exit code {done.returncode}; bare_commands_output.txt has all that it printed")
        return seconds, processors, text

    def size(self, *folders):
        """Bytes of files."""
        paths = [f"{self.root}/{folder}" for folder in folders]
        return int(subprocess.run(["du", "-sxbc", *paths], check=True, capture_output=True,
                                  text=True).stdout.split()[-2])


def row(release, folder):
    """A row of the table."""
    system = System(release, folder)
    bare = system.size("")
    steps = {}
    for name, command in (("airport", AIRPORT), ("airport again", AIRPORT), ("tests", TESTS),
                          ("tests again", f"{TESTS} -N"), ("bits", BITS)):
        steps[name] = system.run(command)
    if not (system.root / CLONE[1:] / "build/airport").is_dir():
        sys.exit(f"ERROR: {AIRPORT} left no build/airport")
    tests, skipped = re.search(r"100% tests passed, 0 tests failed out of (\d+)(?:, (\d+) of them skipped)?\s*\Z",
                               steps["tests"][2]).groups("0")
    built = system.size(f"{CLONE[1:]}/build")
    bits = ", ".join(re.findall(r"^\w+ ([0-9a-f]{8})$", steps["bits"][2], re.MULTILINE))
    minutes = [f"{steps[name][which] / 60.0:.1f}" for name in ("airport", "tests") for which in (0, 1)]
    commit = subprocess.run(["git", "-C", SOURCE, "rev-parse", "--short", "HEAD"], check=True, capture_output=True,
                            text=True).stdout.strip()
    return [SYSTEMS[release], f"{datetime.date.today()}, {commit}", f"{minutes[0]} ({minutes[1]})",
            f"{steps['airport again'][0]:.0f}", f"{minutes[2]} ({minutes[3]})", f"{steps['tests again'][0]:.0f}",
            f"{int(tests) - int(skipped)} and {skipped}", f"{system.size('var/cache/apt/archives') / 1e6:.0f}",
            f"{(system.size('') - bare - built) / 1e9:.1f} and {built / 1e9:.1f}", bits]


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("release", choices=SYSTEMS)
    release = parser.parse_args().release
    if subprocess.run(["unshare", "--mount", "--pid", "--fork", "true"], capture_output=True, check=False).returncode:
        print("Skipped: mount namespaces are not permitted here")
        return 77
    with tempfile.TemporaryDirectory(prefix="avian-lidar-bare.", dir=os.environ.get("TMPDIR", "/var/tmp")) as folder:
        line = row(release, pathlib.Path(folder))
    print(*line, sep=", ")
    with open(TABLE, encoding="utf-8", newline="") as file:
        rows = list(csv.reader(file))
    for other in rows[1:]:
        if other[1].split()[-1] == line[1].split()[-1] and other[-1] != line[-1]:
            sys.exit(f"ERROR: other checksums than {', '.join(other)}")
    with open(TABLE, "w", encoding="utf-8", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows(line if one[0] == line[0] else one for one in rows)
    return 0


if __name__ == "__main__":
    sys.exit(main())
