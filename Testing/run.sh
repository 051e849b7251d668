#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The one command for every test: installs the packages that are missing, builds with ParaView's VTK, on Debian 12 with
# VTK 9.1, and, with the fuzzers, under the sanitizers, and runs all suites under one ctest. Works on a bare Debian 12 or 13 as
# root.
# Tests on the rich sceneries run if AVIANLIDAR_DATA_DIR names their folder. Arguments go to ctest. Tests with the labels
# `nightly` and `bare` are not for here; with --nightly only they are (run_nightly.sh). At the end: the time of each stage, the slowest
# tests.
set -eu

cd "$(dirname "$0")/.."
choice='-LE nightly|bare' kernel_tests=BITS # the others run under the sanitizers
if [ "${1:-}" = --nightly ]; then
  choice='-L nightly|bare' kernel_tests=ON
  shift
fi
all=build/all
mkdir -p "$all"
times="$PWD/$all/stages.txt"
: > "$times"

# stage NAME COMMAND...: its wall time, and the processor time of what it ran, go to the table at the end.
stage() {
  name=$1
  shift
  /usr/bin/python3 Testing/run_times.py stage "$times" "$name" "$@"
}

begin=$(date +%s)
CMake/install-packages.sh
printf 'packages\t%s\t0\n' "$(($(date +%s) - begin))" >> "$times" # what measures may not have been there
presets='paraview asan'
if grep -q '^12\|^bookworm' /etc/debian_version; then
  stage "VTK 9.1" CMake/fetch-vtk-9.1.sh
  presets='paraview vtk asan'
else
  echo "The preset vtk is left out: VTK 9.1 is Debian 12's"
fi
: > "$all/CTestTestfile.cmake"
for preset in $presets; do
  case $preset in
    paraview) options="-DAVIANLIDAR_BUILD_BENCHMARKS=ON -DAVIANLIDAR_KERNEL_TESTS=$kernel_tests" ;;
    vtk) options=-DAVIANLIDAR_KERNEL_LIBRARY=build/paraview/lib/libavianlidarKernel.a ;; # it knows no VTK
    *) options='' ;;
  esac
  stage "configure $preset" cmake --preset "$preset" -DAVIANLIDAR_DATA_DIR="${AVIANLIDAR_DATA_DIR:-}" $options
  stage "build $preset" cmake --build --preset "$preset"
  echo "subdirs(\"$PWD/build/$preset\")" >> "$all/CTestTestfile.cmake"
done

# Two at a time; of what opens windows or starts servers one, pictures alone. Threads that wait leave the core to the other test.
export OMP_WAIT_POLICY=passive
# Without -noreset the X server starts anew when its last client leaves, and turns away who comes just then.
failed=0
rm -f "$all/tests.xml"
stage "ctest" xvfb-run -a -s "-screen 0 1280x1024x24 -noreset" ctest --test-dir "$all" --no-tests=error --output-on-failure \
  --output-junit "$PWD/$all/tests.xml" $choice -j 2 "$@" || failed=$?
/usr/bin/python3 Testing/run_times.py table "$times" "$all/tests.xml"
exit "$failed"
