#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Installs the missing packages of CMake/debian-packages.txt, from all groups or from the groups given as arguments. Uses
# sudo only if a package is missing.
set -euf

list="$(dirname "$0")/debian-packages.txt"
for group in "$@"; do
  grep -qxF "[$group]" "$list" || { echo "$list has no group [$group]" >&2; exit 1; }
done
# Debian 12 or 13. A derived system gives the name of its Debian release. Ubuntu 24.04 counts as Debian 12.
case $(cat /etc/debian_version 2> /dev/null) in
  12* | bookworm* | trixie/sid) release=12 ;;
  *) release=13 ;;
esac
wanted=$(awk -v groups=" $* " -v release="$release" '
  { sub(/#.*/, "") }
  /^\[/ { name = $1; gsub(/[][]/, "", name); next }
  split($1, entry, "@") == 2 && entry[2] != release { next }
  groups == "  " || index(groups, " " name " ") { print entry[1] }' "$list")
missing=
for entry in $wanted; do
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

echo "Missing:$missing"
as_root=
if [ "$(id -u)" -ne 0 ]; then
  if ! command -v sudo > /dev/null; then
    echo "Run as root: apt-get install --no-install-recommends$missing" >&2
    exit 1
  fi
  sudo -v # asks for the password once; a refusal ends the script
  as_root=sudo
fi
# On a terminal, apt shows its progress. In a log, each step has one line, and one line every half minute. A step that
# fails has apt's messages.
style=-q
[ ! -t 1 ] || style="-o Dpkg::Progress-Fancy=1"
apt() {
  "$(dirname "$list")/with-progress.sh" $as_root env DEBIAN_FRONTEND=noninteractive apt-get $style "$@"
}
install() { apt -y --no-install-recommends "$@" install $missing; }
uris() { apt-get -q -q --no-install-recommends --print-uris install $missing; }
download() {
  uris | awk '{ sum += $3 } END { printf "Downloading %d packages, %.0f MB\n", NR, sum / 1e6 }'
  install --download-only
}
update() { echo "Fetching lists of packages"; apt update; }
# The lists of packages are fetched only if they are absent or out of date.
if uris > /dev/null 2>&1; then
  download || { update && download; }
else
  update && download
fi
echo "Installing what was downloaded"
install
