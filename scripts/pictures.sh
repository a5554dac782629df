#!/bin/sh
# Renders the pictures of the documents, with labels. Needs ImageMagick.
#
#     sh scripts/pictures.sh [PROGRAM [FOLDER]]     # default: target/release/splitsum docs
#
# docs/effect.png: one metal ball by three methods.
# docs/front.png: metal spheres by split sums and by sampling, with the FLIP of each against the reference.
set -eu
cd "$(dirname "$0")/.."
program=${1:-target/release/splitsum}
out=${2:-docs}
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

# render FILE OPTION...
render() {
    file=$folder/$1
    shift
    "$program" render --background --antialias --environment builtin:studio --rotate 120 --f0 1 --albedo 0 --diffuse none \
        --out "$file" "$@"
}

# label FILE SIZE TEXT: puts the text below the picture.
label() {
    convert "$folder/$1" -background white -fill '#222' -pointsize "$2" -gravity center label:"$3" -append "$folder/$1"
}

ball() { # METHOD LABEL OPTION...
    method=$1 text=$2
    shift 2
    render "$method.png" --method "$method" --scene shader-ball --size 400x400 --camera perspective --perceptual-roughness 0.6 "$@"
    label "$method.png" 17 "$text"
}

ball split-sum "Split sum (textbook)"
ball split-sum-two "Better split sum, two lookups"
ball reference "Reference" --samples 4096
convert "$folder/split-sum.png" "$folder/split-sum-two.png" "$folder/reference.png" +append -strip -depth 8 "$out/effect.png"

sphere() { # NAME METHOD TEXT OPTION...: at $alpha
    name=$1 method=$2 text=$3
    shift 3
    for form in png exr; do
        render "$name.$form" --method "$method" --size 144x144 --alpha "$alpha" "$@"
    done
    [ "$name" = 0 ] || text="$text
FLIP $("$program" compare --json "$folder/$name.exr" "$folder/0.exr" | sed -n 's/.*"flip": \([0-9.]\{5\}\).*/\1/p')"
    label "$name.png" 16 "$text"
}

for alpha in 0.1 0.25 0.5; do
    sphere 0 reference "reference
alpha $alpha" --samples 4096
    sphere 1 split-sum "1 lookup, textbook"
    sphere 2 split-sum-one "1 lookup, fitted"
    sphere 3 split-sum-two "2 lookups, fitted"
    sphere 4 split-sum-four "4 lookups, fitted"
    sphere 5 sampled-vndf "4 samples" --samples 4 --pixel-points owen
    sphere 6 sampled-vndf "16 samples" --samples 16 --pixel-points owen
    sphere 7 sampled-vndf "64 samples" --samples 64 --pixel-points owen
    convert "$folder/0.png" "$folder/1.png" "$folder/2.png" "$folder/3.png" "$folder/4.png" "$folder/5.png" "$folder/6.png" \
        "$folder/7.png" +append "$folder/row$alpha.png"
done
convert "$folder"/row*.png -append -strip -depth 8 "$out/front.png"
