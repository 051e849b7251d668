#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Builds, then searches sites at Hongqiao and leaves tables, files for maps and a picture in build/siting. Works on a bare
# Debian 12 as root. Arguments go to siting.py.
set -eu

cd "$(dirname "$0")/../.."
CMake/install-packages.sh plugin python

# Without the tests, which need more packages: `cmake --preset paraview` turns them on again.
cmake --preset paraview -DBUILD_TESTING=OFF
cmake --build --preset paraview --target vtkAvianLidarPython

export PYTHONPATH="$(cat build/paraview/python-path)${PYTHONPATH:+:$PYTHONPATH}"
/usr/bin/python3 Examples/siting/siting.py -o build/siting "$@"
echo "Sites: $PWD/build/siting"
