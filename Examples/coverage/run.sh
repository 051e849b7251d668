#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Installs the packages that are missing, builds, and leaves a report (HTML), maps (GeoTIFF, GeoJSON), a section, clutter and
# shares of Hongqiao for a gull, with Search905 and with the paper's receiver, in build/coverage. Options go to both commands,
# for example --coverage-set species=crow.
set -eu

cd "$(dirname "$0")/../.."
CMake/install-packages.sh plugin python

# Without the tests, which need more packages: `cmake --preset paraview` turns them on again.
cmake --preset paraview -DBUILD_TESTING=OFF
cmake --build --preset paraview --target vtkAvianLidarPython

plan=Examples/coverage/hongqiao.coverage.json
build/paraview/bin/avianlidar coverage "$plan" -o build/coverage "$@"
build/paraview/bin/avianlidar report "$plan" -o build/coverage/report.html "$@"
echo "Pictures and files: $PWD/build/coverage"
