#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The one command for every table and picture of the paper: installs the packages that are missing, builds, and leaves each
# part's tables (Markdown and CSV) and pictures in a folder below build/paper, and the seconds that each took in times.csv.
#   --quick     few rays, benchmarks whose times mean nothing, and without the fits to MERL
#   --pages     also brings tables, pictures, verdicts and counts into Documentation/
#   --no-build  uses what is built in build/paraview, with its benchmarks
#   --out DIR   instead of build/paper, seen from the repository
# AVIANLIDAR_DATA_DIR names the folder of the rich sceneries and of the fits to MERL; what needs it is left out without it.
set -eu

cd "$(dirname "$0")/../../.."
out=build/paper quick='' pages='' build=yes
while [ $# -gt 0 ]; do
  case $1 in
    --quick) quick=yes ;;
    --pages) pages=yes ;;
    --no-build) build='' ;;
    --out) shift; out=${1:?--out wants a folder} ;;
    *) echo "run.sh: unknown argument '$1', expected --quick, --pages, --no-build or --out DIR" >&2; exit 2 ;;
  esac
  shift
done
if [ -n "$quick" ] && [ -n "$pages" ]; then
  echo "run.sh: --quick and --pages exclude each other: pages have the numbers of a whole run" >&2
  exit 2
fi
data=${AVIANLIDAR_DATA_DIR:-}
if [ -n "$pages" ] && [ ! -d "$data" ]; then
  echo "run.sh: --pages wants AVIANLIDAR_DATA_DIR, the folder of the rich sceneries: without it the pages would lose their rows" >&2
  exit 2
fi

mkdir -p "$out"
exec 9>"$out/lock"
flock -n 9 || { echo "run.sh: another run writes into '$out': wait for it, or name another folder by --out" >&2; exit 2; }
echo "part,seconds" >"$out/times.csv"
begin=$(date +%s)

# step NAME COMMAND...: its seconds go into times.csv; an error ends everything.
step() {
  name=$1
  shift
  echo "== $name"
  start=$(date +%s)
  "$@"
  echo "$name,$(($(date +%s) - start))" >>"$out/times.csv"
}

# study NAME ARGUMENTS...: with a display for its pictures.
study() {
  name=$1
  shift
  step "$name" xvfb-run -a /usr/bin/python3 Testing/Studies/run.py "$name" --out "$out/$name" "$@"
}

build() {
  CMake/install-packages.sh
  cmake --preset paraview -DAVIANLIDAR_BUILD_BENCHMARKS=ON -DAVIANLIDAR_DATA_DIR="$data"
  cmake --build --preset paraview --target vtkAvianLidarPython avianlidarBenchmarks
}

benchmarks() {
  if [ -n "$build" ]; then
    Testing/Benchmarks/run.sh "$@"
  else
    /usr/bin/python3 Testing/Benchmarks/run_benchmarks.py --program build/paraview/bin/avianlidarBenchmarks "$@"
  fi
}

[ -z "$build" ] || step build build
package=$(cat build/paraview/python-path)
export PYTHONPATH="$package${PYTHONPATH:+:$PYTHONPATH}"
[ -z "$data" ] || export AVIANLIDAR_SCENES_DIR="$PWD/build/paraview/Testing/Scenes"

# Fig. 9 to 11, Sec. 5.2 and 5.3: times.
step figures benchmarks --out "$out/figures" --suites machine figure9 figure10 figure11 epsilon section5 ${quick:+--smoke}
# Fig. 12 to 15, Tables 1 and 2: the corridor. Fig. 16 and 17: the airport.
study corridor
study airport
# Both scenes with the paper's configuration; the distances of clouds in Fig. 13 to 15; the unit of its attenuation.
study paper ${quick:+--reference-rays 1000 --seeds 1 --turns 1}
study protocol ${quick:+--seeds 1}
study attenuation
# Eq. 8 to the letter: what the paper's second reflection would bring.
study second_reflection ${quick:+--beams 50}
# Sec. 3.4: what is left out beyond two reflections. Sec. 1: level of detail. Table 1: the fits to MERL.
study more_reflections ${quick:+--beams 100}
if [ -n "$data" ]; then
  study detail ${quick:+--rays 300 --coarser 8}
  [ -n "$quick" ] || study check_fit
else
  echo "Left out without AVIANLIDAR_DATA_DIR: the rich airports of the figures, detail, materials." >&2
fi

echo "all,$(($(date +%s) - begin))" >>"$out/times.csv"
if [ -n "$pages" ]; then
  /usr/bin/python3 Testing/Benchmarks/report.py "$out/figures" --pages
  Testing/Studies/run.py pages --from "$out" corridor airport paper protocol attenuation second_reflection more_reflections \
    detail check_fit
  Testing/Studies/run.py verdicts || {
    [ $? -eq 1 ] || exit 2
    echo "Read the rows above again: Documentation/evidence/paper.md"
  }
fi
cat "$out/times.csv"
echo "Tables, CSV and pictures: $out"
