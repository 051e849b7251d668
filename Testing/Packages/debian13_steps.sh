#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Run by debian13.sh in the clone: the airport's command, then the build with its tests, the plugin in pvpython, and
# some tests of each layer, which take no more than eight minutes.
set -eu

cd "$(dirname "$0")/../.."
begin=$(date +%s)
# step NAME COMMAND...: prints how long it took or, if it failed, what it printed.
step() {
  name=$1
  shift
  CMake/with-progress.sh "$@" || { echo "ERROR: $name"; exit 1; }
  echo "$name: $(($(date +%s) - begin)) s after the begin"
}

step "Debian 13, the airport" Examples/airport/run.sh
for picture in Airport16-top Airport16-close Airport16-range Airport32-top Airport32-close Airport32-range; do
  [ -s "build/airport/$picture.png" ] || { echo "ERROR: build/airport/$picture.png is missing"; exit 1; }
done
step "Debian 13, the tests' configuration" cmake --preset paraview -DBUILD_TESTING=ON
step "Debian 13, the tests' build" cmake --build --preset paraview

python='(EchoPipeline|Extracts|HelperFiles|HelperPipeline|HelperScenes|Laz|MeshFiles|PacketReader|PointCloudReader'
python="$python|SceneObjects|Sensors|SequenceReader|Sources|Stubs|Tracker)"
plugin='(ColourPreset|FirstClick|Help|Pipeline|Proxies|State|Window|Writers)'
Testing/run_ctest.sh build/paraview -LE 'nightly|bare' \
  -R "Cxx-|Kernel-InstructionSets|Python-Test$python\$|Plugin-Test$plugin\$|Parallel-TestRanks(Errors)?-2" || {
  echo "ERROR: Debian 13, tests"
  exit 1
}
