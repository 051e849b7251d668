#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Runs a command as root on a copy of a system that is thrown away afterwards: an overlay on the folder $1, in memory or
# in the folder AVIANLIDAR_OVERLAY, in a mount namespace of its own. /dev and /sys are the machine's, files from outside
# lie in the read-only folder /given ($2). Exits with 77 where mounts are not permitted. Arguments: lower folder, folder
# to show as /given, command ...
set -eu

if [ "${AVIANLIDAR_IN_NAMESPACE:-}" != "$$" ]; then
  unshare --mount --pid --fork true 2> /dev/null || { echo "Skipped: mount namespaces are not permitted here"; exit 77; }
  exec unshare --mount --pid --fork --kill-child sh -c 'AVIANLIDAR_IN_NAMESPACE=$$ exec "$0" "$@"' "$0" "$@"
fi
lower=$1
given=$2
shift 2
work=/mnt
if [ -n "${AVIANLIDAR_OVERLAY:-}" ]; then
  mount --bind "$AVIANLIDAR_OVERLAY" "$work"
else
  mount -t tmpfs none "$work"
fi
mkdir "$work/upper" "$work/work" "$work/root"
root="$work/root"
mount -t overlay overlay -o "lowerdir=$lower,upperdir=$work/upper,workdir=$work/work" "$root" ||
  { echo "Skipped: an overlay of $lower is not permitted here"; exit 77; }
mount -t proc proc "$root/proc"
mount --rbind /dev "$root/dev"
mount --rbind /sys "$root/sys"
mount -t tmpfs none "$root/tmp"
mkdir "$root/given"
mount --bind "$given" "$root/given"
mount -o remount,ro,bind "$root/given"
if [ -n "${XAUTHORITY:-}" ]; then
  cp "$XAUTHORITY" "$root/tmp/xauthority"
fi
cd /
exec chroot "$root" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/tmp LC_ALL=C.UTF-8 DISPLAY="${DISPLAY:-}" \
  XAUTHORITY=/tmp/xauthority DEBIAN_FRONTEND=noninteractive QT_X11_NO_MITSHM=1 "$@"
