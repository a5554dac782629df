#!/bin/sh
# Renders the figures of the source documents, with labels. Needs ImageMagick.
#
#     sh scripts/source-document-pictures.sh [PROGRAM [FOLDER]]     # default: target/release/splitsum docs
#
# docs/document-samples.png: a metallic model without a specular term, by 5, 30 and 100 samples, without and with the mip filter.
# docs/document-display.png: a model that reflects all light, by exposure and by contrast.
# docs/document-models.png: the grid of spheres by roughness and metallic, by the three BRDF models.
# docs/document-lights.png: direct lights alone, the environment alone, and both, by the three BRDF models.
set -eu
cd "$(dirname "$0")/.."
program=${1:-target/release/splitsum}
out=${2:-docs}
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

# render FILE TEXT OPTION...: renders a picture and puts the text below it.
render() {
    file=$folder/$1 text=$2
    shift 2
    "$program" render --background --antialias --environment builtin:studio --diffuse sh9 --out "$file" "$@" >/dev/null
    convert "$file" -background white -fill '#222' -pointsize 15 -gravity center label:"$text" -append "$file"
}

# row FILE PICTURE...: puts pictures side by side.
row() {
    file=$1
    shift
    # shellcheck disable=SC2046 # names have no blanks
    convert $(printf "$folder/%s.png " "$@") -background white +append "$folder/$file.png"
}

# column FILE ROW...: puts rows one above another.
column() {
    file=$1
    shift
    # shellcheck disable=SC2046 # names have no blanks
    convert $(printf "$folder/%s.png " "$@") -background white -append -strip -depth 8 "$out/$file.png"
}

model="--scene shader-ball --camera perspective --rotate 120 --size 200x200"
metal="$model --metallic 0.7 --albedo 0.95 --perceptual-roughness 0.35"
# shellcheck disable=SC2086 # options
{
    render none.png "no specular term" $metal --method none
    render reference.png reference $metal --method reference --samples 4096
    for count in 5 30 100; do
        render plain$count.png "$count samples" $metal --method sampled-unfiltered --samples $count
        render filtered$count.png "$count samples, filtered" $metal --method sampled --samples $count
    done
}
row plain none plain5 plain30 plain100
row filtered reference filtered5 filtered30 filtered100
column document-samples plain filtered

mirror="$model --metallic 1 --albedo 1 --perceptual-roughness 0.1 --method sampled --samples 40"
# shellcheck disable=SC2086 # options
{
    for exposure in 0.1 1 5 50 500 10000; do
        render exposure$exposure.png "exposure $exposure" $mirror --exposure $exposure
    done
    for contrast in 0.1 1 5; do
        render contrast$contrast.png "contrast $contrast" $mirror --contrast $contrast
    done
}
row low exposure0.1 exposure1 exposure5
row high exposure50 exposure500 exposure10000
row contrasts contrast0.1 contrast1 contrast5
column document-display low high contrasts

for brdf in ggx beckmann phong; do
    render $brdf.png $brdf --scene spheres --size 320x192 --brdf $brdf --method reference --samples 1024
done
column document-models ggx beckmann phong

# Lights alone are in an environment a millionth as bright.
dark="--scale 0.000001"
sun="--light directional:direction=-1,-1,-1.5:intensity=4"
point="--light point:position=1.6,1,1.6:color=1,0.6,0.3:intensity=8"
spot="--light spot:position=-1.5,2.5,3:direction=1.5,-2.4,-3:color=0.5,0.7,1:intensity=90:inner_deg=9:outer_deg=13"
body="--scene shader-ball --camera perspective --rotate 120 --size 176x176 --albedo 0.8,0.3,0.2 --metallic 0 --perceptual-roughness 0.4"
# shellcheck disable=SC2086 # options
for brdf in ggx beckmann phong; do
    render $brdf-sun.png "$brdf, directional" $body --brdf $brdf --method split-sum $dark $sun
    render $brdf-point.png "$brdf, point" $body --brdf $brdf --method split-sum $dark $point
    render $brdf-spot.png "$brdf, spot" $body --brdf $brdf --method split-sum $dark $spot
    render $brdf-image.png "$brdf, environment" $body --brdf $brdf --method split-sum
    render $brdf-both.png "$brdf, all" $body --brdf $brdf --method split-sum $sun $point $spot
    row $brdf-lights $brdf-sun $brdf-point $brdf-spot $brdf-image $brdf-both
done
column document-lights ggx-lights beckmann-lights phong-lights
