#!/bin/sh
# Bakes each map for an engine that draws finished bakes: FOLDER/bakes/ENGINE/MAP. run.sh --ours calls it.
# Arguments: ENGINE FOLDER. Each bake has the number of texels of the engine's own.
set -eu
engine=$1
out=$2
here=$(cd "$(dirname "$0")" && pwd)
size=128x128
maps=$out/maps
case $engine in
    babylon) for=babylon-env ;;
    playcanvas) for=playcanvas-atlas size=512x512 ;;
    f3d) for=f3d ;;
    sapien)
        # Its cubes end at 1.
        for=sapien
        maps=$out/dimmed
        "${PYTHON:?}" "$here/sapien/dim.py" "$out" ;;
    *)
        echo "splitsum: $engine draws no bake of splitsum here: expected babylon, playcanvas, f3d or sapien" >&2
        exit 2 ;;
esac
rm -rf "$out/bakes/$engine"
for map in "$maps"/*.exr; do
    "${SPLITSUM:?}" bake "$map" --for $for --set prefilter_size=$size --out "$out/bakes/$engine/$(basename "$map" .exr)" > /dev/null
done
