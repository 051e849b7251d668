#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# with-progress.sh COMMAND...: runs a command that may take minutes. A terminal shows the command's own output. A log gets
# one line every half minute, with the time and the last line of the output, and at the end the compiler's warnings. After
# a failure, or if it is stopped, the log gets the whole output. AVIANLIDAR_INTERVAL replaces the 30 s between lines.
set -u

[ ! -t 1 ] || exec "$@"
said=$(mktemp)
start=$(date +%s)
# Without the output of `sleep`, which may outlive this script and would keep a pipe open.
while sleep "${AVIANLIDAR_INTERVAL:-30}" > /dev/null 2>&1; do
  seconds=$(($(date +%s) - start))
  echo "  $((seconds / 60)) min $((seconds % 60)) s: $(tail -n 1 "$said" | cut -c 1-100)"
done &
lines=$!
trap 'kill "$lines" 2> /dev/null; rm -f "$said"' EXIT
"$@" < /dev/null > "$said" 2>&1 &
command=$!
trap 'kill "$command" 2> /dev/null; cat "$said"; exit 143' TERM HUP
trap 'kill "$command" 2> /dev/null; cat "$said"; exit 130' INT
failed=0
wait "$command" || failed=$?
if [ "$failed" -ne 0 ]; then
  cat "$said"
else
  grep -A 5 "warning:" "$said"
fi
exit "$failed"
