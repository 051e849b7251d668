#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Installs this project for all users: the packages that are missing, then a build, then this project's own Debian packages by
# apt. ParaView then has the plugin, Python the package avianlidar, and the shell the command. Works on a bare Debian 12; asks
# for your password where it needs root. Argument: "all" for the development package, too.
set -eu

cd "$(dirname "$0")/.."
CMake/install-packages.sh plugin python packages

# Without the tests, which need more packages: `cmake --preset paraview` turns them on again.
cmake --preset paraview -DBUILD_TESTING=OFF
cmake --build --preset paraview
rm -f build/paraview/packages/*.deb # of other versions
cpack --config build/paraview/CPackConfig.cmake

as_root=
[ "$(id -u)" -eq 0 ] || as_root=sudo
cd build/paraview/packages
files="./avian-lidar_*.deb ./python3-avianlidar_*.deb"
[ "${1:-}" != all ] || files="./*.deb"
$as_root apt-get install -y --no-install-recommends $files
echo "Installed: paraview has the plugin, python3 the package avianlidar, the shell the command avianlidar."
