#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# What takes too long for every change: before a release, and whenever what it tests was touched. All tests with the
# labels `nightly` and `bare` (packages and the README's commands on bare Debians, examples, the site, the probers'
# other seeds), the sanitizers on the VTK classes and on threads, and the fuzzers for so many seconds (an hour without
# an argument). usage: Testing/run_nightly.sh [seconds of fuzzing]
set -eu

cd "$(dirname "$0")/.."
status=0
Testing/run_more.sh --nightly || status=1
Testing/run_sanitizers.sh filters tsan || status=1
Testing/Fuzzing/run.sh "${1:-3600}" || status=1
exit "$status"
