#!/bin/sh
# Renders the spheres in an engine of the browser: Chromium without a window, WebGL 2 by SwiftShader. run.sh calls it.
# Arguments: ENGINE FOLDER INSTALLED [ours | assets]. `ours`: our bakes in place of its own. `assets`: its levels and tables in place of
# spheres. 77: node, npm or Chromium is missing, or npm has no network.
set -eu
engine=$1
out=$2
here=$(cd "$(dirname "$0")" && pwd)
work=$3/$engine
ours=${4:-}
chromium=
for name in chromium chromium-browser google-chrome google-chrome-stable; do
    [ -n "$chromium" ] || chromium=$(command -v "$name" || true)
done
for name in node npm "${chromium:-chromium}"; do
    command -v "$name" > "/dev/null" || { echo "$engine: needs $name"; exit 77; }
done
mkdir -p "$work"
if ! cmp -s "$here/$engine/package.json" "$work/package.json"; then
    cp "$here/$engine/package.json" "$work/package.json"
    npm install --silent --no-audit --no-fund --prefix "$work" > "$work/npm.log" 2>&1 || {
        rm "$work/package.json"
        echo "$engine: its packages cannot be installed: $work/npm.log"
        exit 77
    }
fi
(cd "$work" && node "$here/browser.mjs" bundle "$engine" "$out" "$here" $ours)
# Virtual time ends the page as soon as it waits for nothing.
nice -n 10 "$chromium" --headless --no-sandbox --use-gl=angle --use-angle=swiftshader --enable-unsafe-swiftshader \
    --virtual-time-budget=3600000 --user-data-dir="$work/profile" --dump-dom "file://$work/page.html" > "$work/page.dump" 2> "$work/chromium.log"
node "$here/browser.mjs" pictures "$engine" "$out" "$here" $ours < "$work/page.dump"
