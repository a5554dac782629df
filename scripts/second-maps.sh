#!/bin/sh
# Fetches the second set of maps, held out: nothing was chosen or fitted on them:
#
#     scripts/second-maps.sh
#     splitsum run experiments/pictures.toml --clamp-invalid --set environment=experiments/environments/second/lab.exr,...
#
# They are 14 maps of the npm package @pmndrs/assets (CC0; 512x256, DWAA compression, which loses a little and leaves
# negative texels; --clamp-invalid sets those to 0). Each is checked against experiments/environments-second.csv and
# saved as experiments/environments/second/NAME.exr. Needs npm, base64 and sha256sum.
set -eu
cd "$(dirname "$0")/.."
. scripts/setup.sh

into=experiments/environments/second
command -v npm >/dev/null || {
    echo "npm is missing (Debian: apt-get install npm)" >&2
    exit 2
}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
say "fetching @pmndrs/assets 1.7.0 (14 MB)"
(cd "$work" && npm pack --silent @pmndrs/assets@1.7.0 >/dev/null && tar xzf ./*.tgz)
mkdir -p "$into"
while IFS=, read -r name hash _; do
    [ "$name" = name ] && continue
    # A module exports each file as text.
    sed "s/^.*base64,//; s/'.*$//" "$work/package/hdri/$name.exr.js" | base64 -d >"$work/$name.exr"
    [ "$(sha256sum "$work/$name.exr" | cut -d' ' -f1)" = "$hash" ] || {
        echo "$name.exr: not the file that experiments/environments-second.csv names" >&2
        exit 1
    }
    mv "$work/$name.exr" "$into/$name.exr"
done <experiments/environments-second.csv
say "saved to $into"
