#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Installs missing packages, builds the project, scans the airport with the presets Airport16 and Airport32, and writes
# pictures and files to build/airport. Works on a bare Debian 12 or 13 as root. Arguments are passed to airport.py.
set -eu

cd "$(dirname "$0")/../.."
CMake/install-packages.sh plugin python

# Without the tests, which need more packages. `cmake --preset paraview` turns the tests on again.
cmake --preset paraview -DBUILD_TESTING=OFF
CMake/with-progress.sh cmake --build --preset paraview --target vtkAvianLidarPython AvianLidarPlugin

export PYTHONPATH="$(cat build/paraview/python-path)${PYTHONPATH:+:$PYTHONPATH}"
/usr/bin/python3 Examples/airport/airport.py --out build/airport "$@"
echo "Pictures and files: $PWD/build/airport"
