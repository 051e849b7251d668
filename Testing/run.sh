#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The suite: installs the packages that are missing, builds with ParaView's VTK, and runs the tests. Works on a bare Debian 12 or 13
# as root. Tests on the rich sceneries run if AVIANLIDAR_DATA_DIR names their folder. Arguments go to ctest. Other builds, the
# packages and what takes long are for run_more.sh and run_nightly.sh. At the end: the time of each stage, the slowest tests.
set -eu

cd "$(dirname "$0")/.."
all=build/all
mkdir -p "$all"
times="$PWD/$all/stages.txt"
: > "$times"

# stage NAME COMMAND...: its wall time, and the processor time of what it ran, go to the table at the end.
stage() {
  name=$1
  shift
  /usr/bin/python3 Testing/run_times.py stage "$times" "$name" "$@"
}

begin=$(date +%s)
CMake/install-packages.sh
printf 'packages\t%s\t0\n' "$(($(date +%s) - begin))" >> "$times" # what measures may not have been there
stage configure cmake --preset paraview -DAVIANLIDAR_DATA_DIR="${AVIANLIDAR_DATA_DIR:-}"
stage build cmake --build --preset paraview

failed=0
stage tests Testing/run_ctest.sh build/paraview --output-junit "$PWD/$all/tests.xml" -LE 'nightly|bare|install|more' "$@" || failed=$?
/usr/bin/python3 Testing/run_times.py table "$times" "$all/tests.xml"
exit "$failed"
