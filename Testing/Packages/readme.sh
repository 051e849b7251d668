#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Follows the README's commands in their order in the clone $1: ParaView, Python right after it and, if $2
# is "bare" (elsewhere that is tested already), the airport without a display and the packages. Run by
# overlay.sh: what they install and write is thrown away.
set -eu

fail() { echo "ERROR: $*" >&2; exit 1; }
cd "$1"

# Where the tree is built already, what the command must make for Python is missing.
rm -rf build/paraview/python-path build/paraview/lib/python3

# In ParaView. In place of its window: the state that the window is told to open (TestWindow.py looks into the window).
command=$(sed -n 's/^\(Examples\/paraview\/run\.sh\).*/\1/p' README.md)
mkdir /tmp/bin
cat > /tmp/bin/paraview << 'END'
#!/bin/sh
[ "$1" = --state ] && exec pvpython -c "
import runpy
from paraview import simple
runpy.run_path('$2')
print('opened with', simple.FindSource('Scan').GetDataInformation().GetNumberOfPoints(), 'echoes', flush=True)"
END
chmod 755 /tmp/bin/paraview
start=$(date +%s)
PATH="/tmp/bin:$PATH" sh -c "$command" > /tmp/out 2>&1 || { tail -50 /tmp/out; fail "$command"; }
grep "^opened with [0-9][0-9][0-9][0-9] echoes" /tmp/out || { tail -50 /tmp/out; fail "$command opened no scan"; }
echo "$command: $(($(date +%s) - start)) s"

# In Python, as printed.
awk '/^## In Python/ { here = 1 } here && /^```$/ { exit } code { print } here && /^```python/ { code = 1 }' README.md \
  > example.py
command=$(sed -n '/^## In Python/,/^## /s/^`\(PYTHONPATH=.* example\.py\)`.*/\1/p' README.md)
[ -n "$command" ] || fail "README.md prints no command for example.py"
rm -f echoes.csv range.png
sh -c "$command"
[ "$(wc -l < echoes.csv)" -gt 1000 ] && [ -s range.png ] || fail "$command"

# Without a display.
if [ "$2" = bare ]; then
  DISPLAY= Examples/airport/run.sh > /tmp/out 2>&1 || { tail -50 /tmp/out; fail "Examples/airport/run.sh"; }
  tail -1 /tmp/out
  CMake/install.sh all > /tmp/out 2>&1 || { tail -50 /tmp/out; fail "CMake/install.sh"; }
  [ "$(ls build/paraview/packages/*.deb | wc -l)" = 4 ] || fail "CMake/install.sh made no four packages"
  (cd /tmp && avianlidar sensors > /dev/null && python3 -c "import avianlidar") || fail "CMake/install.sh installed nothing"
fi
echo "The README's steps work"
