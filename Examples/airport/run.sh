#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The one command for the airport: installs the packages that are missing, builds, scans the airport with both
# presets and leaves pictures and files in build/airport. Works on a bare Debian 12 or 13 as root.
# Arguments go to airport.py.
set -eu

cd "$(dirname "$0")/../.."
CMake/install-packages.sh plugin python

# Without the tests, which need more packages: `cmake --preset paraview` turns them on again.
cmake --preset paraview -DBUILD_TESTING=OFF
cmake --build --preset paraview --target vtkAvianLidarPython AvianLidarPlugin

export PYTHONPATH="$(cat build/paraview/python-path)${PYTHONPATH:+:$PYTHONPATH}"
/usr/bin/python3 Examples/airport/airport.py --out build/airport "$@"
echo "Pictures and files: $PWD/build/airport"
