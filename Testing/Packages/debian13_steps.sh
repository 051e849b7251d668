#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# What debian13.sh runs in the clone: the airport's command, the plugin in pvpython, and tests of every layer that take no more than
# eight minutes together.
set -eu

cd "$(dirname "$0")/../.."
begin=$(date +%s)
done_at() { echo "Debian 13: $1 after $(($(date +%s) - begin)) s"; }

Examples/airport/run.sh > /tmp/airport.log 2>&1 || { tail -100 /tmp/airport.log; exit 1; }
tail -1 /tmp/airport.log
done_at "the airport"

cmake --preset paraview -DBUILD_TESTING=ON > /tmp/build.log 2>&1 || { tail -100 /tmp/build.log; exit 1; }
cmake --build --preset paraview > /tmp/build.log 2>&1 || { tail -100 /tmp/build.log; exit 1; }
done_at "the build with tests"
