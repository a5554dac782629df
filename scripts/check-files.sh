#!/bin/sh
# Reads files of real programs with splitsum, and compares the numbers with right ones; each case prints a line.
#
#     sh scripts/check-files.sh [FOLDER]     # keeps the files in FOLDER
#
# OpenImageIO, OpenEXR, ffmpeg, Radiance, libultrahdr, trimesh, pygltflib and VTK come from PyPI, Babylon.js, PlayCanvas, gainmap-js and ktx-parse
# from npm, at pinned versions, in a temporary folder; the cases of exrenvmap (Debian's openexr), pfstools, node and Chromium are skipped
# without them, and with CI set they are installed. SPLITSUM names another program than target/release/splitsum. Without Python or a
# network the check is skipped: one line, exit status 77.
set -eu
cd "$(dirname "$0")/.."
. scripts/setup.sh

skip() {
    say "skipped: files of real programs: $*"
    exit 77
}

[ $# -le 1 ] || stop "usage: sh scripts/check-files.sh [FOLDER]"
has_command python3 || skip "python3 is missing"
has venv || skip "python3 has no ensurepip (Debian: apt-get install python3-venv)"
program=${SPLITSUM:-$PWD/target/release/splitsum}
[ -x "$program" ] || stop "$program is missing: cargo build --release"
[ -z "${CI:-}" ] || require exrenvmap pfsin node browser || say "the cases of exrenvmap, pfstools, node and Chromium may be skipped"

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
files=${1:-$work/files}
mkdir -p "$files"
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install -q --disable-pip-version-check OpenImageIO==3.2.2.0 OpenEXR==3.5.3 imageio-ffmpeg==0.8.1 pyradiance==1.3.1 \
    imagecodecs==2026.3.6 trimesh==5.2.0 pygltflib==1.16.5 pillow==13.0.0 vtk==9.7.1 PyOpenGL==3.1.10 ||
    skip "pip cannot install the programs (no network?)"
set -- "$program" "$files"
if has_command npm; then
    mkdir "$work/node"
    if npm install --silent --no-audit --no-fund --prefix "$work/node" ktx-parse@2.0.0 three@0.187.0 @babylonjs/core@9.35.0 playcanvas@2.23.3 \
        @monogrid/gainmap-js@3.7.3 esbuild@0.28.0 > "$work/npm.log" 2>&1; then
        set -- "$@" "$work/node"
    else
        cat "$work/npm.log"
        say "npm cannot install the programs of a browser: their cases are skipped"
    fi
fi
"$work/venv/bin/python" scripts/files/check.py "$@"
