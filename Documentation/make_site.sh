#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Makes a site with search from the pages, in build/site or in the given folder. Open its index.html in a browser without a
# server. A missing target of a link or a picture is an error. After a build, the site also has a page on the Python package.
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
