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

if [ "$1" = bare ]; then
  apt-get -qq update
fi
files > /tmp/before

install /given/first/*.deb
files > /tmp/installed
grep "Need to get" /tmp/apt.log
[ "$(ldconfig -p | grep -c libvtkAvianLidar.so.0.1)" = 1 ] || fail "ldconfig does not know the library"

# ParaView's programs list the plugin and have loaded it.
for program in pvpython pvbatch; do
  $program /given/plugin.py > /tmp/out 2>&1 || { cat /tmp/out; fail "$program"; }
  grep -x "AvianLidarPlugin loaded, 1000 echoes or more, 29 others listed" /tmp/out || { cat /tmp/out; fail "$program"; }
done
pvserver --server-port=22987 > /tmp/server.log 2>&1 &
pvpython /given/plugin.py localhost 22987 > /tmp/out 2>&1 || { cat /tmp/out /tmp/server.log; fail pvserver; }
grep -x "AvianLidarPlugin loaded, 1000 echoes or more, 29 others listed" /tmp/out || { cat /tmp/out; fail pvserver; }
wait
plugin=/usr/lib/paraview-5.11/plugins/AvianLidarPlugin
if [ -n "$DISPLAY" ]; then
  timeout 120 paraview --script=/given/plugin.py > /tmp/out 2>&1 || true
  grep -x "AvianLidarPlugin loaded, 1000 echoes or more, 29 others listed" /tmp/out || { cat /tmp/out; fail paraview; }
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
for package in avian-lidar python3-avianlidar libavian-lidar-dev; do
  dpkg-query -W -f "\${Version}\n" $package | grep "later\$" || fail "$package is not upgraded"
done
files | diff /tmp/installed - || fail "the upgrade left or lost files"
python3 -c 'import avianlidar'
apt-get -qq -y purge avian-lidar > /tmp/apt.log 2>&1 || { cat /tmp/apt.log; fail purge; }
if [ "$1" = bare ]; then
  apt-get -qq -y purge cmake g++ make > /tmp/apt.log 2>&1
  apt-get -qq -y --purge autoremove > /tmp/apt.log 2>&1
fi
files > /tmp/after
if [ "$1" = bare ]; then
  # Other packages leave some: none may be ours.
  diff /tmp/before /tmp/after | tee /tmp/left | head -30
  ! grep -i "avian\|paraview.conf" /tmp/left || fail "purging left files"
else
  diff /tmp/before /tmp/after || fail "purging left files"
fi
echo "Installed, used, upgraded, purged"
