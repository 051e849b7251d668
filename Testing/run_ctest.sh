#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# run_ctest.sh BUILD [ARGUMENTS]: the tests of a build tree under an X server of their own, two at a time; of those that open windows
# or start servers one, pictures alone.
set -eu

build=$1
shift
export OMP_WAIT_POLICY=passive # threads that wait leave the core to the other test
# Without -noreset the X server starts anew when its last client leaves, and turns away who comes just then.
exec xvfb-run -a -s "-screen 0 1280x1024x24 -noreset" ctest --test-dir "$build" --no-tests=error --output-on-failure -j 2 "$@"
