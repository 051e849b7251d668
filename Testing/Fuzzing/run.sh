#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Builds the fuzzers and runs those named (all without a name) for so many seconds each (an hour without an argument),
# all at once, at the lowest priority. What they find is left in build/fuzz/run: inputs that reach new code, crash-*,
# timeout-* and oom-* files, logs. An input that fails goes into the corpus once it is mended, and a test of what failed
# beside it. Each run adds a line to runs.csv, and the table of Documentation/evidence/reliability.md sums them up.
# usage: Testing/Fuzzing/run.sh [seconds [Geometry] [PointCloud] [SceneReader]]
set -eu

cd "$(dirname "$0")/../.."
seconds="${1:-3600}"
[ $# -eq 0 ] || shift
[ $# -gt 0 ] || set -- Geometry PointCloud SceneReader
commit=$(git describe --always --dirty --exclude='*' 2> /dev/null || echo unknown)
cmake --preset fuzz
cmake --build --preset fuzz

tests="$PWD/Testing/Fuzzing"
fuzzers="$PWD/build/fuzz/bin"
mkdir -p build/fuzz/run
cd build/fuzz/run

fuzz() {
  name=$1 dictionary='' sanitizers=allocator_may_return_null=1 found=0
  case $name in
    PointCloud) dictionary="$tests/cloud.dict" ;;
    SceneReader)
      dictionary="$tests/scene.dict"
      sanitizers="$sanitizers:detect_leaks=0:detect_container_overflow=0"
      ;;
  esac
  mkdir -p "$name"
  begin=$(date +%s)
  ASAN_OPTIONS="$sanitizers" nice -n 19 "$fuzzers/avianlidarFuzz$name" "-max_total_time=$seconds" -timeout=120 \
    -rss_limit_mb=4096 -print_final_stats=1 ${dictionary:+"-dict=$dictionary"} "-artifact_prefix=$name-" "$name" "$tests/Corpus/$name" \
    > "$name.log" 2>&1 || found=$? # the first finding ends it
  [ "$found" -ne 72 ] || return 1 # it was stopped
  [ "$found" -eq 0 ] || found=1
  minutes=$((($(date +%s) - begin + 30) / 60))
  inputs=$(sed -n 's/^stat::number_of_executed_units: *//p' "$name.log")
  [ -n "$inputs" ] || return 1 # it did not begin
  edges=$(sed -n 's/.* cov: \([0-9]*\) .*/\1/p' "$name.log" | tail -n 1)
  echo "$(date +%F),$commit,$name,$minutes,$inputs,$edges,$found" >> "$tests/runs.csv"
  return "$found"
}

running=''
for name in "$@"; do
  fuzz "$name" &
  running="$running $!"
done
status=0
for one in $running; do
  wait "$one" || status=1
done
for name in "$@"; do
  tail -n 7 "$name.log"
done
/usr/bin/python3 "$tests/../reliability_tables.py" fuzzing
exit "$status"
