#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Builds the fuzzers and runs each for so many seconds (an hour without an argument), all at once, at the lowest
# priority. What they find is left in build/fuzz/run: inputs that reach new code, crash-*, timeout-* and oom-* files,
# logs. An input that fails goes into the corpus once it is mended, and a test of what failed beside it.
# usage: Testing/Fuzzing/run.sh [seconds]
set -eu

cd "$(dirname "$0")/../.."
seconds="${1:-3600}"
cmake --preset fuzz
cmake --build --preset fuzz

corpus="$PWD/Testing/Fuzzing/Corpus"
dictionaries="$PWD/Testing/Fuzzing"
fuzzers="$PWD/build/fuzz/bin"
mkdir -p build/fuzz/run/Geometry build/fuzz/run/PointCloud build/fuzz/run/SceneReader
cd build/fuzz/run
options="-max_total_time=$seconds -timeout=120 -rss_limit_mb=4096 -print_final_stats=1"

ASAN_OPTIONS=allocator_may_return_null=1 nice -n 19 "$fuzzers/avianlidarFuzzGeometry" $options \
  -artifact_prefix=Geometry- Geometry "$corpus/Geometry" > Geometry.log 2>&1 &
geometry=$!
ASAN_OPTIONS=allocator_may_return_null=1 nice -n 19 "$fuzzers/avianlidarFuzzPointCloud" $options \
  "-dict=$dictionaries/cloud.dict" -artifact_prefix=PointCloud- PointCloud "$corpus/PointCloud" > PointCloud.log 2>&1 &
clouds=$!
status=0
ASAN_OPTIONS=detect_leaks=0:detect_container_overflow=0:allocator_may_return_null=1 \
  nice -n 19 "$fuzzers/avianlidarFuzzSceneReader" $options "-dict=$dictionaries/scene.dict" \
  -artifact_prefix=SceneReader- SceneReader "$corpus/SceneReader" > SceneReader.log 2>&1 || status=1
wait "$geometry" || status=1
wait "$clouds" || status=1
tail -n 7 Geometry.log PointCloud.log SceneReader.log
exit "$status"
