#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Installs this project for all users, on a bare Debian 12 or 13: installs missing packages, builds the project, and installs
# this project's own Debian packages by apt. ParaView then has the plugin, Python has the package avianlidar, and the shell has
# the command avianlidar. Steps that need root use sudo. With the argument "all", the script also installs the packages for
# development and of the documentation.
set -eu

cd "$(dirname "$0")/.."
echo "Step 1 of 4: packages that are missing"
CMake/install-packages.sh plugin python packages

echo "Step 2 of 4: configuring"
# Without the tests, which need more packages. `cmake --preset paraview` turns the tests on again.
cmake --preset paraview -DBUILD_TESTING=OFF
echo "Step 3 of 4: building, about ten minutes on two cores"
CMake/with-progress.sh cmake --build --preset paraview
echo "Step 4 of 4: making this project's packages, and installing them"
rm -f build/paraview/packages/*.deb # packages of other versions
CMake/with-progress.sh cpack --config build/paraview/CPackConfig.cmake

as_root=
[ "$(id -u)" -eq 0 ] || as_root=sudo
cd build/paraview/packages
files="./avian-lidar_*.deb ./python3-avianlidar_*.deb"
[ "${1:-}" != all ] || files="./*.deb"
$as_root apt-get install -y --no-install-recommends $files
echo "Installed: paraview has the plugin, python3 the package avianlidar, the shell the command avianlidar."
