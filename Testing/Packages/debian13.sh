#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Builds what is here on a bare, up-to-date Debian 13, which is thrown away afterwards, by the airport's command, loads
# the plugin into pvpython and runs some tests of every layer. With arguments these are the command to run in the clone
# instead, such as Testing/run.sh. The system with its packages is kept in /var/cache/avian-lidar. It is made again when
# the list of packages has changed, and after a week. If that fails, as it does without a network, the one that is there
# is used; if there is none, it is tried three times. Needs root.
set -eu

cd "$(dirname "$0")/../.."
cache=/var/cache/avian-lidar
kind=trixie-$(sha256sum CMake/debian-packages.txt | cut -c 1-12)
system=$cache/$kind

make_system() {
  timeout 15m Testing/Packages/bare_system.sh trixie "$system.new" &&
    mkdir "$system.new/packages" &&
    cp CMake/install-packages.sh CMake/with-progress.sh CMake/debian-packages.txt "$system.new/packages" &&
    timeout 20m unshare --mount --pid --fork --kill-child chroot "$system.new" \
      sh -c 'mount -t proc proc /proc && packages/install-packages.sh && apt-get clean' &&
    rm -rf --one-file-system "$system.new/packages" &&
    touch "$system.new"
}

newest() {
  find "$cache" -maxdepth 1 -name 'trixie-????????????' -printf '%T@ %p\n' | sort -n | sed -n '$s/^[^ ]* //p'
}

for program in debootstrap unshare; do
  command -v "$program" > /dev/null || { echo "debian13.sh: the program $program is missing" >&2; exit 1; }
done
unshare --mount --pid --fork true || { echo "debian13.sh: expected root, and permission to mount" >&2; exit 1; }
mkdir -p "$cache"
exec 9> "$cache/lock"
flock 9 # until this run ends: another one must not replace the system under it
if [ -z "$(find "$system" -maxdepth 0 -mtime -7 2> /dev/null)" ]; then
  pauses='30 120 end'
  [ -z "$(newest)" ] || pauses=end
  for pause in $pauses; do
    rm -rf --one-file-system "$cache"/trixie-*.new
    if make_system; then
      old=$(newest)
      [ -z "$old" ] || rm -rf --one-file-system "$old"
      mv "$system.new" "$system"
      break
    fi
    echo "A bare Debian 13 could not be made"
    [ "$pause" = end ] || sleep "$pause"
  done
fi
system=$(newest)
[ -n "$system" ] || { echo "There is neither a network to make a bare Debian 13 from nor an older one in $cache" >&2; exit 1; }
echo "Debian $(cat "$system/etc/debian_version") of $(date -r "$system" +%F)"

folder=$(mktemp -d "${TMPDIR:-/var/tmp}/avian-lidar-debian13.XXXXXX")
trap 'rm -rf --one-file-system "$folder"' EXIT INT TERM
mkdir "$folder/given" "$folder/overlay"
git clone -q . "$folder/given/clone"
if [ -n "${AVIANLIDAR_DATA_DIR:-}" ]; then
  cp -r "$AVIANLIDAR_DATA_DIR" "$folder/given/data"
fi
AVIANLIDAR_OVERLAY="$folder/overlay" Testing/Packages/overlay.sh "$system" "$folder/given" sh -euc '
  cp -r /given/clone /root/clone
  cd /root/clone
  [ ! -d /given/data ] || export AVIANLIDAR_DATA_DIR=/given/data
  exec "$@"' sh "${@:-Testing/Packages/debian13_steps.sh}" || { echo "Debian 13: exit code $?" >&2; exit 1; }
