#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Unpacks Debian's VTK 9.1 into a folder, for the preset `vtk`. An installation would remove ParaView,
# because the Python packages of VTK and ParaView conflict.
#
#     CMake/fetch-vtk-9.1.sh [<folder>]        (default: build/vtk-9.1-sdk)
#
# The script needs apt-get, dpkg-deb and patchelf, and ends at once if the folder is complete.
set -eu

packages="
  libvtk9-dev libvtk9.1 libvtk9.1-qt libvtk9-java vtk9 python3-vtk9
  libtbb12 libtbb-dev libtbbbind-2-5 libtbbmalloc2 libhwloc15"

root=$(cd "$(dirname "$0")/.." && pwd)
folder=${1:-"$root/build/vtk-9.1-sdk"}
stamp="$folder/complete"

if [ -e "$stamp" ] && [ "$(cat "$stamp")" = "$packages" ]; then
  exit 0
fi

echo "Fetching Debian's VTK 9.1 into $folder"
rm -rf "$folder"
mkdir -p "$folder/debs"
cd "$folder/debs"
# apt-get shows the progress on a terminal, but not in a log.
quiet=
[ -t 1 ] || quiet="-q -q"
# As root, because apt's sandbox user may not have the right to write to this folder.
download() {
  apt-get -q -q --print-uris download $packages |
    awk '{ sum += $3 } END { printf "Downloading %d packages, %.0f MB\n", NR, sum / 1e6 }'
  apt-get $quiet -o APT::Sandbox::User=root download $packages
}
download || { echo "Fetching lists of packages" && apt-get $quiet update && download; }
echo "Unpacking them"
for deb in *.deb; do
  dpkg-deb -x "$deb" "$folder"
done
cd "$folder"
rm -rf debs usr/share/doc usr/share/java

# Relative search paths: the unpacked files find each other in any folder without LD_LIBRARY_PATH.
set_rpath() {
  rpath=$1
  shift
  for file in "$@"; do
    if [ ! -L "$file" ] && [ "$(head -c 4 "$file" | tail -c 3)" = ELF ]; then
      patchelf --set-rpath "$rpath" "$file"
    fi
  done
}
libraries=$(dirname usr/lib/*/libvtkCommonCore-9.1.so)
triplet=$(basename "$libraries")
set_rpath '$ORIGIN' "$libraries"/*.so*
set_rpath "\$ORIGIN/../lib/$triplet" usr/bin/*
set_rpath "\$ORIGIN/../../../$triplet" usr/lib/python3/dist-packages/vtkmodules/*.so
echo "$packages" > "$stamp"
