#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Installs missing packages (by sudo, unless root), builds the plugin and the Python package in build/paraview, and opens
# ParaView with a scan of the airport Hongqiao. Arguments are passed to ParaView.
set -eu

cd "$(dirname "$0")/../.."
CMake/install-packages.sh plugin

# Without the tests, which need more packages. `cmake --preset paraview` turns the tests on again.
cmake --preset paraview -DBUILD_TESTING=OFF
CMake/with-progress.sh cmake --build --preset paraview

folder=$(ls -dt build/paraview/lib/paraview-*/plugins/AvianLidarPlugin | head -n 1)
echo "The plugin: $PWD/$folder/AvianLidarPlugin.so"
if [ -z "${DISPLAY:-}${WAYLAND_DISPLAY:-}" ]; then
  echo "ParaView needs a display. Examples/airport/run.sh makes pictures without a display." >&2
  exit 1
fi
exec paraview --state "$folder/States/avian_lidar_airport.py" "$@"
