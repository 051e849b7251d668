#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Installs missing packages, builds the project, and writes the coverage of Hongqiao for a gull to build/coverage, with
# Search905 and with the paper's receiver: a report (HTML), maps (GeoTIFF, GeoJSON), a section, clutter and shares. Options
# are passed to the commands coverage and report, for example --coverage-set species=crow.
set -eu

cd "$(dirname "$0")/../.."
CMake/install-packages.sh plugin python

# Without the tests, which need more packages. `cmake --preset paraview` turns the tests on again.
cmake --preset paraview -DBUILD_TESTING=OFF
CMake/with-progress.sh cmake --build --preset paraview --target vtkAvianLidarPython

plan=Examples/coverage/hongqiao.coverage.json
build/paraview/bin/avianlidar coverage "$plan" -o build/coverage "$@"
build/paraview/bin/avianlidar report "$plan" -o build/coverage/report.html "$@"
echo "Pictures and files: $PWD/build/coverage"
