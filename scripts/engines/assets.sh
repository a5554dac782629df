#!/bin/sh
# Judges what engines bring or bake themselves: prefiltered levels, DFG tables and SH, by `splitsum check-bake`. Prints a verdict each,
# and leaves the files in DIR/ENGINE-assets.
#
#     sh scripts/engines/assets.sh ENGINE... --out DIR [--map NAME|FILE.exr]...
#
# three: its PMREM of each map and its table. babylon: its two tables. filament: the ten lights of Open3D against their skyboxes.
# f3d, sapien: the levels that run.sh left in DIR. sapien: its dome and its table, too. materialx: its prefiltered levels of each map.
# Babylon.js' `.env`, PlayCanvas' atlas and VTK's levels are judged by scripts/check-files.sh. 77: an engine cannot run here.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
root=$(cd "$here/../.." && pwd)
. "$root/scripts/setup.sh"
. "$here/python.sh"
program=${SPLITSUM:-$root/target/release/splitsum}
installed=${ENGINES:-$root/target/engines}
engines=
while [ $# -gt 0 ] && [ "${1#-}" = "$1" ]; do
    engines="$engines $1"
    shift
done
[ -n "$engines" ] && [ "${1:-}" = --out ] && [ $# -gt 1 ] || {
    echo "splitsum: usage: sh scripts/engines/assets.sh ENGINE... --out DIR [--map NAME|FILE.exr]..." >&2
    exit 2
}
out=$2
shift 2
mkdir -p "$out" "$installed"
out=$(cd "$out" && pwd)
python=$(python_of 3.11 '<') || stop "needs Python 3.11 or newer"
install_python tools "$here/requirements.txt" "$python" || stop "the packages of scripts/engines/requirements.txt cannot be installed"
tools=$installed/tools/bin/python
"$tools" "$here/spheres.py" "$out" --splitsum "$program" "$@"

judge() { # what, arguments of check-bake
    what=$1
    shift
    said=$out/$(echo "$what" | tr ' /' '--').txt
    if "$program" check-bake "$@" > "$said" 2>&1; then
        echo "$what: $(sed -n '/^Verdict/,$p' "$said" | tr -s '\n ' ' ')"
    else
        echo "$what: FAILED: $(cat "$said")"
        code=1
    fi
}

python_of_engine() { # engine
    version=$(sed -n 's/^# python \([0-9.]*\)$/\1/p' "$here/$1/requirements.txt")
    python=$(python_of "${version:-3.11}" "$([ -n "$version" ] && echo '!=' || echo '<')") || return 1
    install_python "$1" "$here/$1/requirements.txt" "$python"
}

maps() { # that were asked for; DIR may hold more
    "$tools" -c 'import json, sys; print(*json.load(open(sys.argv[1]))["maps"], sep="\n")' "$out/spheres.json"
}

assets_of() { # engine
    folder=$out/$1-assets
    rm -rf "$folder"
    mkdir -p "$folder"
    case $1 in
        three)
            sh "$here/browser.sh" three "$out" "$installed" assets
            "$tools" "$here/to_exr.py" "$folder"
            for map in $(maps); do
                judge "three.js PMREM of $map" "$folder/$map" --preset three-pmrem --environment "$out/maps/$map.exr"
            done
            judge "three.js table" dfg="$folder/dfg.exr" --preset three --table-axes r+n+ ;;
        babylon)
            [ -d "$installed/babylon/node_modules" ] || { echo "babylon: run scripts/engines/run.sh babylon first"; return 77; }
            "$tools" "$here/babylon/tables.py" "$installed/babylon/node_modules/@babylonjs/core/Misc/brdfTextureTools.js" "$folder"
            judge "Babylon.js table" dfg="$folder/dfg.exr" --preset babylon --table-channels bias-albedo
            judge "Babylon.js OpenPBR table" dfg="$folder/openpbr.exr" --preset babylon --table-channels bias-albedo ;;
        filament)
            python_of_engine filament || { echo "filament: its packages cannot be installed"; return 77; }
            resources=$("$installed/filament/bin/python" -c 'import importlib.util as u, pathlib as p; print(p.Path(u.find_spec("open3d").origin).parent / "resources")')
            for light in "$resources"/*_ibl.ktx; do
                name=$(basename "$light" _ibl.ktx)
                judge "Open3D $name" "$light" --preset open3d --environment "$resources/${name}_skybox.ktx"
            done ;;
        f3d)
            for map in $(maps); do
                digest=$(md5sum < "$out/maps/$map.hdr" | cut -c1-32)
                [ -d "$out/f3d/cache/$digest" ] || { echo "f3d: run scripts/engines/run.sh f3d --out $out first"; return 77; }
                judge "F3D levels of $map" "$out/f3d/cache/$digest" --preset vtk --environment "$out/maps/$map.exr"
            done ;;
        sapien)
            python_of_engine sapien || { echo "sapien: its packages cannot be installed"; return 77; }
            PYTHON=$tools
            "$PYTHON" "$here/sapien/dim.py" "$out"
            for map in $(maps); do
                [ -f "$out/sapien/$map.ktx" ] || { echo "sapien: run scripts/engines/run.sh sapien --out $out first"; return 77; }
                judge "SAPIEN levels of $map" "$out/sapien/$map.ktx" --preset sapien --alphas 0,0.0625,0.25,0.5625,1 --environment "$out/dimmed/$map.exr"
            done
            "$installed/sapien/bin/python" "$here/sapien/dome.py" "$folder" "$out" || return
            "$tools" "$here/to_exr.py" "$folder"
            judge "SAPIEN dome" "$folder/dome.ktx" --preset sapien --alphas 0,0.0625,0.25,0.5625,1 --environment "$folder/dome.exr"
            "$tools" "$here/sapien/table.py" "$folder/dfg.exr"
            judge "SAPIEN table" dfg="$folder/dfg.exr" --preset sapien ;;
        materialx)
            python_of_engine materialx || { echo "materialx: its packages cannot be installed"; return 77; }
            display=
            if [ -z "${DISPLAY:-}" ] && has_command xvfb-run; then
                display='xvfb-run -a'
            fi
            $display "$installed/materialx/bin/python" "$here/materialx/levels.py" "$out" "$folder" || return
            "$tools" "$here/to_exr.py" "$folder"
            for map in $(maps); do
                # The last level, of one texel, is left out. The preset counts levels, so the widths are listed.
                # shellcheck disable=SC2046 # names without blanks, in the order of levels
                judge "MaterialX levels of $map" $(ls -v "$folder/$map"/m*.exr | sed '$d') --preset materialx --alphas "$(cat "$folder/$map/alphas")" \
                    --environment "$out/maps/$map.exr"
            done ;;
        *)
            echo "splitsum: $1: expected three, babylon, filament, f3d, sapien or materialx" >&2
            return 2 ;;
    esac
}

code=0
for engine in $engines; do
    found=0
    assets_of "$engine" || found=$?
    case $found in
        0) ;;
        77) [ $code -ne 0 ] || code=77 ;;
        *) echo "$engine: FAILED" >&2; code=1 ;;
    esac
done
exit $code
