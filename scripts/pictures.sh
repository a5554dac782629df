#!/bin/sh
# Renders docs/effect.png, the first picture of README.md: one metal ball by three methods, side by side with labels.
# Needs ImageMagick.
#
#     sh scripts/pictures.sh [PROGRAM]     # default: target/release/splitsum
set -eu
cd "$(dirname "$0")/.."
program=${1:-target/release/splitsum}
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

# picture METHOD LABEL [OPTION...]
picture() {
    method=$1 label=$2
    shift 2
    "$program" render --method "$method" --scene shader-ball --size 400x400 --camera perspective --background --antialias \
        --environment builtin:studio --rotate 120 --perceptual-roughness 0.6 --f0 1 --albedo 0 --diffuse none \
        --out "$folder/$method.png" "$@"
    convert "$folder/$method.png" -background white -fill '#222' -pointsize 17 -gravity center \
        label:"$label" -append "$folder/$method.png"
}

picture split-sum "Split sum (textbook)"
picture split-sum-two "Better split sum, two lookups"
picture reference "Reference" --samples 4096
convert "$folder/split-sum.png" "$folder/split-sum-two.png" "$folder/reference.png" +append -strip docs/effect.png
