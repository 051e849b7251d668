#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Installs the packages of /given on the system that it runs on, uses, upgrades and purges them, and compares the files
# of the system before and after. Run by overlay.sh: the system is thrown away afterwards.
# $1: "here" where everything that the packages depend on is installed; "bare" where apt fetches it, and takes it away
# at the end.
set -eu

fail() { echo "ERROR: $*" >&2; exit 1; }
# Every path where packages put files, but not apt's and dpkg's own records, caches and logs.
files() {
  find /etc /opt /srv /usr /var \( -path /var/cache -o -path /var/lib/apt -o -path /var/lib/dpkg -o -path /var/log \
    -o -path /var/tmp \) -prune -o -print | sort
}
install() { apt-get -q -y --no-install-recommends install "$@" > /tmp/apt.log 2>&1 || { cat /tmp/apt.log; fail "apt install $*"; }; }

# Whose paths count: on a bare system those of other packages come, and some stay.
ours=.
if [ "$1" = bare ]; then
  ours="avian\|paraview\.conf\|share/paraview/"
  apt-get -qq update
fi
unchanged() {
  files > /tmp/now
  ! diff "$1" /tmp/now | grep "^[<>]" | grep -i "$ours"
}
files > /tmp/before

install /given/first/*.deb
files > /tmp/installed
grep "Need to get" /tmp/apt.log
[ "$(ldconfig -p | grep -c 'libvtkAvianLidar.so.[0-9]')" = 1 ] || fail "ldconfig does not know the library"

# ParaView's programs list the plugin and have loaded it.
others=$(grep -c "<Plugin " /usr/lib/*/paraview-*/plugins/paraview.plugins.xml)
seen="AvianLidarPlugin loaded, 1000 echoes or more, $others others listed"
for program in pvpython pvbatch; do
  $program /given/plugin.py > /tmp/out 2>&1 || { cat /tmp/out; fail "$program"; }
  grep -x "$seen" /tmp/out || { cat /tmp/out; fail "$program"; }
done
port=$(python3 -c 'import socket; server = socket.socket(); server.bind(("", 0)); print(server.getsockname()[1])')
pvserver --server-port="$port" > /tmp/server.log 2>&1 &
pvpython /given/plugin.py localhost "$port" > /tmp/out 2>&1 || { cat /tmp/out /tmp/server.log; fail pvserver; }
grep -x "$seen" /tmp/out || { cat /tmp/out; fail pvserver; }
wait
plugin=$(echo /usr/lib/paraview-*/plugins/AvianLidarPlugin)
if [ -n "$DISPLAY" ]; then
  timeout 120 paraview --script=/given/plugin.py > /tmp/out 2>&1 || true
  grep -x "$seen" /tmp/out || { cat /tmp/out; fail paraview; }
fi

# Python and the command, from any folder.
cd /tmp
python3 -c 'import avianlidar; print(avianlidar.__file__)' | grep -x /usr/lib/python3/dist-packages/avianlidar/__init__.py
avianlidar scan "$plugin/Scenes/hongqiao.lidarscene.json" --out /tmp/echoes.csv
[ "$(wc -l < /tmp/echoes.csv)" -gt 1000 ] || fail "avianlidar scan wrote $(wc -l < /tmp/echoes.csv) lines"

# The development package: the example in C++.
if [ "$1" = bare ]; then
  install cmake g++ make
fi
cmake -S /given/cxx -B /tmp/cxx > /tmp/out 2>&1 && cmake --build /tmp/cxx >> /tmp/out 2>&1 || { cat /tmp/out; fail "Examples/cxx"; }
/tmp/cxx/scan_airport "$plugin/Scenes/hongqiao.lidarscene.json" /tmp/echoes.vtp 10000

# An upgrade replaces all files; purging leaves none.
install /given/second/*.deb
for package in avian-lidar python3-avianlidar libavian-lidar-dev avian-lidar-doc; do
  dpkg-query -W -f "\${Version}\n" $package | grep "later\$" || fail "$package is not upgraded"
done
unchanged /tmp/installed || fail "the upgrade left or lost files"
python3 -c 'import avianlidar'
apt-get -qq -y purge avian-lidar avian-lidar-doc > /tmp/apt.log 2>&1 || { cat /tmp/apt.log; fail purge; }
if [ "$1" = bare ]; then
  apt-get -qq -y purge cmake g++ make > /tmp/apt.log 2>&1
  apt-get -qq -y --purge autoremove > /tmp/apt.log 2>&1
fi
unchanged /tmp/before || fail "purging left files"
echo "Installed, used, upgraded, purged"
