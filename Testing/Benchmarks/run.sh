#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The one command for every benchmark: installs the packages that are missing, builds, runs all suites and leaves CSV,
# Markdown and plots in build/benchmarks. --short takes about 10 minutes, the whole about an hour on two cores.
# The rich airports take part if AVIANLIDAR_DATA_DIR names their folder. Other arguments go to run_benchmarks.py.
set -eu

cd "$(dirname "$0")/../.."
CMake/install-packages.sh

cmake --preset paraview -DAVIANLIDAR_BUILD_BENCHMARKS=ON -DAVIANLIDAR_DATA_DIR="${AVIANLIDAR_DATA_DIR:-}"
cmake --build --preset paraview --target avianlidarBenchmarks

/usr/bin/python3 Testing/Benchmarks/run_benchmarks.py \
  --program build/paraview/bin/avianlidarBenchmarks --out build/benchmarks "$@"
echo "Tables and plots: in the folder after --out, by default $PWD/build/benchmarks"
