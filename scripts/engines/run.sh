#!/bin/sh
# Renders spheres in real engines, each at its pinned version, and writes linear EXR: DIR/ENGINE/MAP-MATERIAL-ROUGHNESS.exr.
# README.md beside this file says what each engine renders and how it runs.
#
#     sh scripts/engines/run.sh [--ours] ENGINE... --out DIR [--map NAME|FILE.exr]... [--material M,...] [--roughness R,...] [--size N]
#
# With --ours the engine draws a bake of `splitsum bake --for` in place of its own: DIR/ENGINE-ours. gain.py compares both.
#
# Needs Python 3.11 or newer, for Cycles and EEVEE 3.13, for the three engines in a browser node, npm and Chromium, and a network for
# the packages, which go to target/engines. 77: an engine cannot run here, and no other failed.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
root=$(cd "$here/../.." && pwd)
. "$root/scripts/setup.sh"
. "$here/python.sh"
program=${SPLITSUM:-$root/target/release/splitsum}
installed=${ENGINES:-$root/target/engines}
export BEVY_PEER="${BEVY_PEER:-$root/target/bevy/release/bevy-peer}"
refuse() {
    echo "splitsum: $*" >&2
    exit 2
}

known=$(cd "$here" && for script in */render.*; do printf '%s ' "${script%%/*}"; done)
engines=
ours=
if [ "${1:-}" = --ours ]; then
    ours=ours
    shift
fi
while [ $# -gt 0 ] && [ "${1#-}" = "$1" ]; do
    [ -f "$here/$1/render.py" ] || [ -f "$here/$1/render.js" ] || refuse "$1 is not an engine: expected $known"
    engines="$engines $1"
    shift
done
[ -n "$engines" ] && [ "${1:-}" = --out ] && [ $# -gt 1 ] ||
    refuse "usage: sh scripts/engines/run.sh [--ours] ENGINE... --out DIR [--map NAME|FILE.exr]... [--material M,...] [--roughness R,...] [--size N]"
out=$2
shift 2
mkdir -p "$out" "$installed"
out=$(cd "$out" && pwd)

render() { # engine: fails with 77 if it cannot run here
    if [ -n "$ours" ]; then
        SPLITSUM=$program PYTHON=$installed/tools/bin/python sh "$here/bakes.sh" "$1" "$out" || return
    fi
    if [ -f "$here/$1/render.js" ]; then
        # shellcheck disable=SC2086 # a word or nothing
        sh "$here/browser.sh" "$1" "$out" "$installed" $ours || return
        case $1 in
            babylon | openpbr)
                # For compare.py, whose model of the engine reads them.
                mkdir -p "$out/babylon-tables"
                "$installed/tools/bin/python" "$here/babylon/tables.py" \
                    "$installed/$1/node_modules/@babylonjs/core/Misc/brdfTextureTools.js" "$out/babylon-tables" ;;
        esac
        return
    fi
    # Comments in its requirements.txt may name a version of Python, and the engine whose environment it shares.
    version=$(sed -n 's/^# python \([0-9.]*\)$/\1/p' "$here/$1/requirements.txt")
    shared=$(sed -n 's/^# environment \([a-z]*\)$/\1/p' "$here/$1/requirements.txt")
    environment=${shared:-$1}
    python=$(python_of "${version:-3.11}" "$([ -n "$version" ] && echo '!=' || echo '<')") || {
        echo "$1: needs Python ${version:-3.11}"
        return 77
    }
    install_python "$environment" "$here/$environment/requirements.txt" "$python" || { echo "$1: its packages cannot be installed"; return 77; }
    if [ -f "$here/$1/bake.sh" ]; then
        SPLITSUM=$program sh "$here/$1/bake.sh" "$out" || return
    fi
    display=
    if [ "$1" = materialx ] && [ -z "${DISPLAY:-}" ] && has_command xvfb-run; then
        display='xvfb-run -a'
    fi
    # shellcheck disable=SC2086 # a command with a flag, and a word or nothing
    $display "$installed/$environment/bin/python" "$here/$1/render.py" "$out" $ours
}

python=$(python_of 3.11 '<') || stop "needs Python 3.11 or newer"
install_python tools "$here/requirements.txt" "$python" || stop "the packages of scripts/engines/requirements.txt cannot be installed"
"$installed/tools/bin/python" "$here/spheres.py" "$out" --splitsum "$program" "$@"
code=0
for engine in $engines; do
    pictures=$out/$engine${ours:+-ours}
    rm -rf "$pictures"
    found=0
    render "$engine" || found=$?
    case $found in
        0) "$installed/tools/bin/python" "$here/to_exr.py" "$pictures" || code=1 ;;
        77) [ $code -ne 0 ] || code=77 ;;
        *) echo "$engine: FAILED" >&2; code=1 ;;
    esac
done
exit $code
