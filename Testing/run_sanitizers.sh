#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The sanitizers, one after the other: AddressSanitizer and UndefinedBehaviorSanitizer on all tests of the kernel and on
# a scan of the filters, ThreadSanitizer on what runs in several threads. Run after CMake/install-packages.sh.
# usage: Testing/run_sanitizers.sh [asan] [filters] [tsan]   (all of them without arguments)
set -eu

cd "$(dirname "$0")/.."
[ $# -gt 0 ] || set -- asan filters tsan

# Tests of the collision tree's builder, of scans, and of scans lit again: those with several threads.
parallel='ParallelLoop|CollisionTreeBuilder|TestScan|StabilitySize|PlantedRace'

for which in "$@"; do
  case "$which" in
    asan)
      cmake --preset asan
      cmake --build --preset asan
      ctest --preset asan --output-on-failure
      ;;
    tsan)
      cmake --preset tsan
      cmake --build --preset tsan
      ctest --preset tsan --output-on-failure -L nightly -R "$parallel"
      ;;
    filters)
      # The libraries are not instrumented: their leaks are theirs.
      cmake --preset filters-asan
      cmake --build --preset filters-asan
      ASAN_OPTIONS=detect_leaks=0 ctest --preset filters-asan --output-on-failure -R Cxx
      ;;
    *)
      echo "unknown: $which (asan, filters, tsan)" >&2
      exit 2
      ;;
  esac
done
