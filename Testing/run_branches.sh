#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Which lines and branches of IO, Filters and the Python package the tests take: builds them with gcc's counters in
# build/coverage (the kernel without: its loops would take many times as long), runs the tests and writes the tables of
# Documentation/evidence/reliability.md. The kernel is built a second time with counters, for its own tests. The program
# that reads meshes ends without writing its counters. Branches of exceptions that pass through are not counted. Left
# out are tests with the labels `nightly`, `bare`, `install` (packages hold no paths of a build tree, counters do) and
# `plugin` (ParaView's windows take minutes), and those on three and four ranks. Arguments go to ctest; with --report
# nothing is built or run.
set -eu

cd "$(dirname "$0")/.."
tree=$PWD/build/coverage
package=$tree/lib/python3/dist-packages

run() {
  CMake/install-packages.sh
  cmake --preset paraview -B "$tree/kernel" -DAVIANLIDAR_KERNEL_ONLY=ON -DBUILD_TESTING=OFF
  cmake --build "$tree/kernel"
  cmake --preset paraview -B "$tree" -DAVIANLIDAR_DATA_DIR="${AVIANLIDAR_DATA_DIR:-}" -DAVIANLIDAR_KERNEL_TESTS=OFF \
    -DAVIANLIDAR_KERNEL_LIBRARY="$tree/kernel/lib/libavianlidarKernel.a" \
    -DCMAKE_CXX_FLAGS_RELEASE="-O1 -DNDEBUG --coverage -fprofile-update=atomic"
  cmake --build "$tree"
  # Threads may lose counts here, so that loops are not many times as slow: what ran is known all the same.
  cmake --preset paraview -B "$tree/kernel-counted" -DAVIANLIDAR_KERNEL_ONLY=ON -DCMAKE_CXX_FLAGS_RELEASE="-O1 -DNDEBUG --coverage"
  cmake --build "$tree/kernel-counted"
  find "$tree" -name '*.gcda' -delete
  rm -rf "$tree/python"
  mkdir "$tree/python"
  cat > "$tree/python/rc" << EOF
[run]
branch = True
concurrency = thread,multiprocessing
data_file = $tree/python/.coverage
include = $package/avianlidar/*.py, $package/avianlidar/apps/*.py, $package/avianlidar/apps/*/*.py
parallel = True
sigterm = True
EOF
  # Every Python that looks there imports it when it starts, whatever its environment. At its end the counts are
  # written, also where a test has made the disk small.
  cat > "$package/sitecustomize.py" << EOF
import atexit, os, resource
os.environ["COVERAGE_PROCESS_START"] = "$tree/python/rc"
import coverage
coverage.process_startup()
atexit.register(lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (resource.RLIM_INFINITY,) * 2) if os.getuid() == 0 else None)
EOF
  Testing/run_ctest.sh "$tree" -LE 'nightly|bare|install|plugin' -E '-[34]$' "$@" || failed=$?
  rm "$package/sitecustomize.py"
  Testing/run_ctest.sh "$tree/kernel-counted" -L kernel -LE 'nightly|more' || failed=$?
  python3-coverage combine --rcfile="$tree/python/rc"
}

failed=0
[ "${1:-}" = --report ] || run "$@"
python3-coverage json --rcfile="$tree/python/rc" -o "$tree/python.json"
# The project's copies of classes in test programs count, too.
count() {
  name=$1
  shift
  gcovr --root "$PWD" --exclude-throw-branches --exclude-unreachable-branches --gcov-ignore-parse-errors -j 2 \
    --json-summary "$tree/$name.json" --html-details "$tree/$name.html" "$@"
}
count branches --filter IO/ --filter Filters/ --exclude Filters/Kernel/ --exclude Filters/VolumeTree/ --exclude IO/MeshReader/ \
  --exclude-directories '.*/coverage/kernel.*' "$tree"
count kernel --filter Filters/Kernel/ --filter Filters/VolumeTree/ "$tree/kernel-counted"
/usr/bin/python3 Testing/reliability_tables.py branches "$tree"
exit "$failed"
