#!/bin/sh
# Compares direct lights with the directional, point and spot emitters of Mitsuba, at its pinned version: two models, three
# widths, eight lights of several places, directions and intensities. Prints the largest difference of a pixel for each.
#
#     sh scripts/engines/lights.sh
#
# Fails if a pixel differs by more than 0.5 %; spots are compared inside their inner cone, since Mitsuba's edge has another
# falloff. Needs Python 3.11 or newer and a network for the package, which goes to target/engines. 77: it cannot run here.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
root=$(cd "$here/../.." && pwd)
. "$root/scripts/setup.sh"
. "$here/python.sh"
program=${SPLITSUM:-$root/target/release/splitsum}
installed=${ENGINES:-$root/target/engines}
[ -x "$program" ] || stop "$program is missing: cargo build --release --features view, or set SPLITSUM"
mkdir -p "$installed"

python=$(python_of 3.11 '<') || { echo "mitsuba: needs Python 3.11 or newer"; exit 77; }
install_python mitsuba "$here/mitsuba/requirements.txt" "$python" ||
    { echo "mitsuba: its packages cannot be installed"; exit 77; }
exec "$installed/mitsuba/bin/python" "$here/mitsuba/lights.py" "$program"
