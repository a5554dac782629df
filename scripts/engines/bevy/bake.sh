#!/bin/sh
# Bakes each map for Bevy. Arguments: FOLDER. 77: the program that draws is not built.
set -eu
out=$1
if [ ! -x "${BEVY_PEER:?}" ]; then
    echo "bevy: needs $BEVY_PEER, which sh scripts/check-clients.sh --bevy builds in 40 CPU minutes; BEVY_PEER names another"
    exit 77
fi
rm -rf "$out/bevy-bakes"
for map in "$out"/maps/*.exr; do
    "${SPLITSUM:?}" bake "$map" --for bevy --format rgba16f --out "$out/bevy-bakes/$(basename "$map" .exr)" > /dev/null
done
