#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The one command for every test: installs the packages that are missing, builds with ParaView's VTK, on Debian 12 with
# VTK 9.1, and under the sanitizers, also the fuzzers, and runs all suites under one ctest. Works on a bare Debian 12 or 13 as root.
# Tests on the rich sceneries run if AVIANLIDAR_DATA_DIR names their folder. Arguments go to ctest. Tests with the label
# `long` (ThreadSanitizer: run_sanitizers.sh) are not for here.
set -eu

cd "$(dirname "$0")/.."
CMake/install-packages.sh
presets="paraview asan fuzz"
if grep -q "^12\|^bookworm" /etc/debian_version; then
  CMake/fetch-vtk-9.1.sh
  presets="paraview vtk asan fuzz"
else
  echo "The preset vtk is left out: VTK 9.1 is Debian 12's"
fi

all=build/all
mkdir -p "$all"
: > "$all/CTestTestfile.cmake"
for preset in $presets; do
  benchmarks=OFF
  if [ "$preset" = paraview ]; then benchmarks=ON; fi # their smoke test
  cmake --preset "$preset" -DAVIANLIDAR_DATA_DIR="${AVIANLIDAR_DATA_DIR:-}" -DAVIANLIDAR_BUILD_BENCHMARKS="$benchmarks"
  cmake --build --preset "$preset"
  echo "subdirs(\"$PWD/build/$preset\")" >> "$all/CTestTestfile.cmake"
done

# Two at a time; of what opens windows or starts servers one, pictures alone. Threads that wait leave the core to the other test.
export OMP_WAIT_POLICY=passive
# Without -noreset the X server starts anew when its last client leaves, and turns away who comes just then.
exec xvfb-run -a -s "-screen 0 1280x1024x24 -noreset" ctest --test-dir "$all" --no-tests=error --output-on-failure -LE long -j 2 "$@"
