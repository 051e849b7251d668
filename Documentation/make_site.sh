#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The pages as a site that can be searched, in build/site or in the folder given: open its index.html, no server is needed.
# A link or a picture that leads nowhere is an error. After a build it has a page on the Python package, too.
set -eu

site=$(realpath -m "${1:-$(dirname "$0")/../build/site}")
cd "$(dirname "$0")/.."
CMake/install-packages.sh site
if [ -f build/paraview/python-path ]; then
  PYTHONPATH="$(cat build/paraview/python-path)${PYTHONPATH:+:$PYTHONPATH}"
  export PYTHONPATH
fi
/usr/bin/python3 -m sphinx -q -W --keep-going -j 2 -c Documentation/site -E -d "$site/.cache" . "$site"
cp "$site/README.html" "$site/index.html"
