#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# A bare Debian with today's updates, by debootstrap. Needs root and the network.
# Arguments: name of the release (bookworm, trixie), new folder.
set -eu

command -v debootstrap > /dev/null && [ "$(id -u)" -eq 0 ] || { echo "Skipped: needs debootstrap and root"; exit 77; }
mirror=http://deb.debian.org
log="$2.log"
debootstrap --variant=minbase "$1" "$2" "$mirror/debian" > "$log" || { tail "$log"; exit 1; }
cat > "$2/etc/apt/sources.list" << END
deb $mirror/debian $1 main
deb $mirror/debian $1-updates main
deb $mirror/debian-security $1-security main
END
echo force-unsafe-io > "$2/etc/dpkg/dpkg.cfg.d/unsafe-io" # nobody needs it after a crash
echo "127.0.0.1 localhost" > "$2/etc/hosts"
cat /etc/resolv.conf > "$2/etc/resolv.conf"
chroot "$2" sh -c 'apt-get -qq update && apt-get -qq -y full-upgrade' > "$log" 2>&1 || { tail "$log"; exit 1; }
