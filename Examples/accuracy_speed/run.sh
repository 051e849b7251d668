#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The one command for Documentation/results/accuracy.md: installs the packages that are missing, builds, measures the
# trade of speed for accuracy on both airport sensors and the corridor, and puts tables and plots into the page.
# Takes about ten minutes on two cores. Arguments go to make_page.py.
set -eu

cd "$(dirname "$0")/../.."
CMake/install-packages.sh

cmake --preset paraview
cmake --build --preset paraview --target vtkAvianLidarPython

export PYTHONPATH="$(cat build/paraview/python-path)${PYTHONPATH:+:$PYTHONPATH}"
/usr/bin/python3 Examples/accuracy_speed/make_page.py --out build/accuracy_speed "$@"
echo "Tables and plots: $PWD/build/accuracy_speed"
