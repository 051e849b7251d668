#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Install what CMake/debian-packages.txt lists and is not there yet. Needs root only if something is missing.
set -euf

list="$(dirname "$0")/debian-packages.txt"
missing=
for entry in $(sed 's/#.*//' "$list"); do
  package=${entry%%\?*}
  command=${entry#"$package"}
  command=${command#\?}
  if [ -n "$command" ] && command -v "$command" > /dev/null; then
    continue
  fi
  if ! dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null | grep -q '^installed'; then
    missing="$missing $package"
  fi
done
if [ -z "$missing" ]; then
  exit 0
fi

echo "Installing:$missing"
if [ "$(id -u)" -ne 0 ]; then
  echo "Run as root, or install these packages first:$missing" >&2
  exit 1
fi
export DEBIAN_FRONTEND=noninteractive
# Package lists may be absent or out of date: then, and only then, they are fetched.
install() { apt-get -q -q -y --no-install-recommends install $missing; }
install 2>/dev/null || { apt-get -q -q update && install; }
