#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Installs this project for all users: the packages that are missing, then a build, then this project's own Debian packages by
# apt. ParaView then has the plugin, Python the package avianlidar, and the shell the command. Works on a bare Debian 12 or 13; asks
# for your password where it needs root. Argument: "all" for the packages for development and of the documentation, too.
set -eu

cd "$(dirname "$0")/.."
echo "Step 1 of 4: packages that are missing"
CMake/install-packages.sh plugin python packages

echo "Step 2 of 4: configuring"
# Without the tests, which need more packages: `cmake --preset paraview` turns them on again.
cmake --preset paraview -DBUILD_TESTING=OFF
echo "Step 3 of 4: building, about ten minutes on two cores"
cmake --build --preset paraview
echo "Step 4 of 4: making this project's packages, and installing them"
rm -f build/paraview/packages/*.deb # of other versions
cpack --config build/paraview/CPackConfig.cmake

as_root=
[ "$(id -u)" -eq 0 ] || as_root=sudo
cd build/paraview/packages
files="./avian-lidar_*.deb ./python3-avianlidar_*.deb"
[ "${1:-}" != all ] || files="./*.deb"
$as_root apt-get install -y --no-install-recommends $files
echo "Installed: paraview has the plugin, python3 the package avianlidar, the shell the command avianlidar."
