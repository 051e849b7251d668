#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# What must hold for every change beside the suite (run.sh): a bare Debian 13, on Debian 12 VTK 9.1, the kernel under
# the sanitizers with inputs that fuzzers found, packages, instruction sets and long statistics. Needs root. With
# --nightly instead: the tests with the labels `nightly` and `bare` of all builds, the kernel's in full.
set -eu

cd "$(dirname "$0")/.."
CMake/install-packages.sh
choice='-LE nightly|bare'
of_paraview='-L install|more -LE nightly|bare'
benchmarks=OFF
if [ "${1:-}" = --nightly ]; then
  choice='-L nightly|bare' of_paraview=$choice benchmarks=ON
else
  Testing/Packages/debian13.sh
fi
configure() {
  preset=$1
  shift
  cmake --preset "$preset" -DAVIANLIDAR_DATA_DIR="${AVIANLIDAR_DATA_DIR:-}" "$@"
  CMake/with-progress.sh cmake --build --preset "$preset"
}
failed=0
configure paraview -DAVIANLIDAR_BUILD_BENCHMARKS=$benchmarks
# Unquoted: they are words.
Testing/run_ctest.sh build/paraview $of_paraview || failed=1
if grep -q '^12\|^bookworm' /etc/debian_version; then
  CMake/fetch-vtk-9.1.sh
  configure vtk -DAVIANLIDAR_KERNEL_LIBRARY=build/paraview/lib/libavianlidarKernel.a # it knows no VTK
  Testing/run_ctest.sh build/vtk $choice || failed=1
else
  echo "The preset vtk is left out: VTK 9.1 is Debian 12's"
fi
configure asan
Testing/run_ctest.sh build/asan $choice || failed=1
exit "$failed"
