#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Installs missing packages, builds the project, scans the corridor, and writes pictures and files to build/corridor.
# Arguments are passed to corridor.py.
set -eu

cd "$(dirname "$0")/../.."
CMake/install-packages.sh plugin python drawing
cmake --preset paraview -DBUILD_TESTING=OFF
CMake/with-progress.sh cmake --build --preset paraview --target vtkAvianLidarPython AvianLidarPlugin

export PYTHONPATH="$(cat build/paraview/python-path)${PYTHONPATH:+:$PYTHONPATH}"
xvfb-run -a /usr/bin/python3 Examples/corridor/corridor.py --out build/corridor "$@"
echo "Pictures and files: $PWD/build/corridor"
