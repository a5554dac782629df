#!/bin/sh
# Makes a published figure or table again and compares it with the published one, as a reviewer of an artefact does:
#
#     sh scripts/reproduce.sh              # lists the figures, their minutes on two idle cores and the pages that show them
#     sh scripts/reproduce.sh coat         # one of them, or several
#     sh scripts/reproduce.sh all          # all, in about 145 minutes
#
# A figure is a run of results/. It runs again, from results/NAME/experiment.toml into runs/reproduce/NAME, and
# scripts/compare_answers.py compares the tables of its answers, which the pages show, each number within its own error.
# `cost` counts code again, `spheres` draws the pictures of README.md, and `source-document-pictures` the pictures of
# docs/source-documents.md. Needs Python 3, the maps of experiments/environments.csv, for `pictures-second` and
# `recovery-second` the maps of scripts/second-maps.sh, and for pictures ImageMagick.
# Not here: tables of other programs (results/bakes, results/speed; scripts/bench-peers.sh makes them), and times, which depend on
# the machine (results/timing).
set -eu
cd "$(dirname "$0")/.."
. scripts/setup.sh
. scripts/lights.sh

# Name and minutes.
figures="quick 1
coat 3
anisotropy 5
anisotropy-albedo 1
anisotropy-laws 5
sheen 5
lobes 5
tables 5
better-method 3
break-even 7
cost 1
diffuse 1
exposure-and-contrast 1
front 13
ladder 20
level-bias 3
pictures 15
pictures-second 6
pictures-second-7 2
recovery 5
recovery-causes 2
recovery-second 5
source-document-0 1
printed-document-0 1
source-document-pictures 5
spheres 1
split-sums 5
temporal 15
ghosts 1"
names=$(printf '%s\n' "$figures" | cut -d' ' -f1)

# The pages that show a figure.
pages_of() { # name
    case $1 in
        spheres) shown='docs/(front|effect)\.png|\]\((front|effect)\.png' ;;
        source-document-pictures) shown='\]\(document-[a-z]*\.png' ;;
        *) shown="csv $1/|results/$1/" ;;
    esac
    grep -lE "$shown" README.md docs/*.md | paste -s -d ' ' -
}

if [ $# -eq 0 ]; then
    printf '%s\n' "$figures" | while read -r name minutes; do
        printf '%-25s %2s min  %s\n' "$name" "$minutes" "$(pages_of "$name")"
    done
    exit 0
fi
# shellcheck disable=SC2086 # names have no blanks
[ "$*" != all ] || set -- $names
for name in "$@"; do
    printf '%s\n' "$names" | grep -qxF -e "$name" || {
        echo "$name: not a figure; expected all, or some of: $(printf '%s\n' "$names" | paste -s -d ' ' -)" >&2
        exit 2
    }
done

require_rust
require compiler loader driver python3
if [ -z "${SPLITSUM:-}" ]; then
    say "building (the first time takes a few minutes)"
    cargo build --release --locked
fi
program=${SPLITSUM:-target/release/splitsum}
[ -x "$program" ] || stop "$program: not a program; expected splitsum"
for name in "$@"; do
    published_maps "$name" | while read -r map; do
        [ -f "$map" ] || stop "$name needs $map, which is missing (experiments/README.md, \"Measured maps\")"
    done
done
require_device "$program" >/dev/null
out=runs/reproduce

# Compares pictures in a folder with those in docs.
compare_pictures() { # folder picture...
    folder=$1
    shift
    for picture in "$@"; do
        # The mean difference of the channels; 1 is white against black. Half a level of 8 bits is rounding.
        mean=$(compare -metric MAE "docs/$picture" "$folder/$picture" null: 2>&1 | sed 's/.*(\(.*\)).*/\1/')
        say "docs/$picture: mean difference $mean, at most 0.002"
        awk -v mean="$mean" 'BEGIN { exit !(mean != "" && mean + 0 <= 0.002) }' || return
    done
}

# Makes a figure again and compares it.
reproduce() { # name
    mkdir -p "$out/$1"
    case $1 in
        cost)
            methods=$(cut -d, -f5 results/cost/costs.csv | sed 1d | paste -s -d, -)
            "$program" cost --family navi21 --method "$methods" --out "$out/cost/costs.csv" &&
                python3 scripts/compare_answers.py results/cost "$out/cost"
            ;;
        spheres)
            sh scripts/pictures.sh "$program" "$out/spheres" && compare_pictures "$out/spheres" effect.png front.png
            ;;
        source-document-pictures)
            sh scripts/source-document-pictures.sh "$program" "$out/$1" &&
                compare_pictures "$out/$1" document-samples.png document-display.png document-models.png
            ;;
        *)
            clamp=
            ! grep -q -e --clamp-invalid "results/$1/provenance.json" || clamp=--clamp-invalid
            "$program" run "results/$1/experiment.toml" $clamp --out "$out/$1" >/dev/null &&
                python3 scripts/compare_answers.py "results/$1/answers" "$out/$1/answers"
            ;;
    esac
}

differ=
for name in "$@"; do
    say "$name"
    began=$(date +%s)
    if reproduce "$name"; then
        say "$name: agrees ($(($(date +%s) - began)) s)"
    else
        say "$name: DIFFERS from results/$name, or cannot be made (see above)"
        differ="$differ $name"
    fi
done
[ -z "$differ" ] || stop "FAILED:$differ"
say "PASSED"
