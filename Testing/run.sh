#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The suite: installs the packages that are missing, builds with ParaView's VTK, and runs the tests. Works on a bare
# Debian 12 or 13 as root. Tests on the rich sceneries run if AVIANLIDAR_DATA_DIR names their folder. Arguments go to
# ctest. Other builds, the packages and what takes long are for run_more.sh and run_nightly.sh. At the end: the slowest
# tests.
set -eu

cd "$(dirname "$0")/.."
CMake/install-packages.sh
cmake --preset paraview -DAVIANLIDAR_DATA_DIR="${AVIANLIDAR_DATA_DIR:-}"
CMake/with-progress.sh cmake --build --preset paraview
tests="$PWD/build/all/tests.xml"
mkdir -p build/all
failed=0
Testing/run_ctest.sh build/paraview --output-junit "$tests" -LE 'nightly|bare|install|more' "$@" || failed=$?
/usr/bin/python3 Testing/run_times.py "$tests"
exit "$failed"
