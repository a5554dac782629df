# shellcheck shell=sh
# Sourced by standard-set.sh, reproduce.sh and gpu.sh: the lights under which each experiment is published.

# Prints the lights of an experiment, separated by commas: its formulas, then the measured maps. Prints nothing for an
# experiment about formulas or pictures, which names its own.
lights_of() { # experiment, maps separated by commas
    case $1 in
    front | pictures | split-sums | coat | anisotropy | anisotropy-laws | sheen | lobes | temporal) echo "$2" ;;
    break-even | better-method | level-bias | tables | ladder) echo "builtin:studio,builtin:sky${2:+,$2}" ;;
    diffuse) echo "builtin:sky,builtin:sky:elevation_deg=88,builtin:studio,builtin:checker,builtin:cap${2:+,$2}" ;;
    esac
}

# Prints the maps that the record of a published run names, one in a line: without them its answers are not comparable.
published_maps() { # name
    [ ! -f "results/$1/provenance.json" ] ||
        grep -oE 'experiments/environments/[A-Za-z0-9_/]+\.(hdr|exr)' "results/$1/provenance.json" | sort -u
}
