#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The one command for Documentation/results/standard-errors.md and Documentation/results/small-targets.md:
# installs the packages that are missing, builds, measures (about a quarter of an hour) and writes them. The rich sceneries take
# part if AVIANLIDAR_DATA_DIR names their folder.
set -eu

cd "$(dirname "$0")/../.."
CMake/install-packages.sh

cmake --preset paraview -DAVIANLIDAR_BUILD_BENCHMARKS=ON -DAVIANLIDAR_DATA_DIR="${AVIANLIDAR_DATA_DIR:-}"
cmake --build --preset paraview --target avianlidarAccuracy

mkdir -p build/accuracy
bars=0
build/paraview/bin/avianlidarAccuracy --suite standard_errors --out build/accuracy || bars=$?
build/paraview/bin/avianlidarAccuracy --suite small_targets --out build/accuracy || bars=$?
/usr/bin/python3 Testing/Accuracy/make_page.py build/accuracy
exit "$bars"
