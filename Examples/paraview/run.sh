#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The one command for ParaView's window: installs the packages that are missing (by sudo, unless root), builds the plugin
# and the Python package in build/paraview, and opens ParaView with the airport Hongqiao scanned.
# Arguments go to ParaView.
set -eu

cd "$(dirname "$0")/../.."
CMake/install-packages.sh plugin

# Without the tests, which need more packages: `cmake --preset paraview` turns them on again.
cmake --preset paraview -DBUILD_TESTING=OFF
cmake --build --preset paraview

folder=$(ls -dt build/paraview/lib/paraview-*/plugins/AvianLidarPlugin | head -n 1)
echo "The plugin: $PWD/$folder/AvianLidarPlugin.so"
if [ -z "${DISPLAY:-}${WAYLAND_DISPLAY:-}" ]; then
  echo "There is no display to open ParaView on (for pictures without one: Examples/airport/run.sh)." >&2
  exit 1
fi
exec paraview --state "$folder/States/avian_lidar_airport.py" "$@"
