#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Installs the packages that are missing, builds, and leaves maps, reasons, a section and shares of Hongqiao for a gull with
# Search905 and with the paper's receiver in build/coverage. Arguments go to coverage.py.
set -eu

cd "$(dirname "$0")/../.."
CMake/install-packages.sh plugin python drawing

cmake --preset paraview -DBUILD_TESTING=OFF
cmake --build --preset paraview --target vtkAvianLidarPython

export PYTHONPATH="$(cat build/paraview/python-path)${PYTHONPATH:+:$PYTHONPATH}"
/usr/bin/python3 Examples/coverage/coverage.py Examples/coverage/hongqiao.coverage.json --out build/coverage "$@"
echo "Pictures and files: $PWD/build/coverage"
