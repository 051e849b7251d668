#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# On a bare Debian of this system's release, with today's updates, made by debootstrap and thrown away: installs, uses,
# upgrades and purges the packages of the folder $1 (TestPackages.py fills it), then follows the README's commands in a
# clone of what is here. Needs root, the network, 9 GB in $TMPDIR and a display (xvfb-run).
set -eu

given=$(cd "$1" && pwd)
cd "$(dirname "$0")"
folder=$(mktemp -d "${TMPDIR:-/var/tmp}/avian-lidar-bare.XXXXXX")
trap 'rm -rf --one-file-system "$folder"' EXIT INT TERM
./bare_system.sh "$(. /etc/os-release; echo "$VERSION_CODENAME")" "$folder/root"

on_a_copy() {
  mkdir "$folder/copy"
  AVIANLIDAR_OVERLAY="$folder/copy" ./overlay.sh "$folder/root" "$given" "$@"
  rm -rf "$folder/copy"
}
on_a_copy sh /given/installed.sh bare
rm -rf "$given/clone"
mkdir "$given/clone"
(cd ../.. && git ls-files -z --cached --others --exclude-standard | xargs -0 cp --parents -t "$given/clone")
on_a_copy sh -c 'cp -r /given/clone /root/clone && sh /given/clone/Testing/Packages/readme.sh /root/clone bare'
