#!/bin/sh
# Bakes each map for Filament: Open3D reads a finished cube and no panorama. Arguments: FOLDER.
set -eu
out=$1
rm -rf "$out/filament-bakes"
mkdir -p "$out/filament-bakes"
for map in "$out"/maps/*.exr; do
    name=$(basename "$map" .exr)
    "${SPLITSUM:?}" bake "$map" --for filament --out "$out/filament-bakes/$name" > /dev/null
    mv "$out/filament-bakes/$name/ibl.ktx" "$out/filament-bakes/${name}_ibl.ktx"
done
