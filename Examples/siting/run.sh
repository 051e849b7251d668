#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Installs the packages that are missing, builds, searches sites at Hongqiao and leaves tables, files for maps and a picture in
# build/siting. Options go to the command, for example --siting-set spacing=100.
set -eu

cd "$(dirname "$0")/../.."
CMake/install-packages.sh plugin python

# Without the tests, which need more packages: `cmake --preset paraview` turns them on again.
cmake --preset paraview -DBUILD_TESTING=OFF
cmake --build --preset paraview --target vtkAvianLidarPython

build/paraview/bin/avianlidar siting Examples/coverage/hongqiao.coverage.json -o build/siting "$@"
echo "Sites: $PWD/build/siting"
