#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Installs the packages that are missing, builds, makes the sets of the bench, runs its baselines and leaves the page in build/bench/scores. Options
# go to the sets, for example --scans 100. Without AVIANLIDAR_DATA_DIR there is only Hongqiao, where everything was learned.
set -eu

cd "$(dirname "$0")/../../.."
CMake/install-packages.sh plugin python bench

# Without the tests, which need more packages: `cmake --preset paraview` turns them on again.
cmake --preset paraview -DBUILD_TESTING=OFF
cmake --build --preset paraview --target vtkAvianLidarPython

PYTHONPATH=$(cat build/paraview/python-path)
export PYTHONPATH
Testing/Studies/run.py sets "$@"
for baseline in persistence trees network; do
  Testing/Studies/run.py "$baseline"
done
sets=
for place in hongqiao honolulu neubrandenburg; do
  for set in "build/bench/sets/$place" "build/bench/sets/$place-rain"; do
    if [ -d "$set" ]; then sets="$sets $set"; fi
  done
done
# shellcheck disable=SC2086 # names without blanks
build/paraview/bin/avianlidar bench $sets --predictions build/bench/predictions/* --first 8 -o build/bench/scores
if [ -n "${AVIANLIDAR_DATA_DIR:-}" ]; then
  Testing/Studies/run.py bench_tables
fi
