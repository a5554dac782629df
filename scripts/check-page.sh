#!/bin/sh
# Checks the scripts of the report's page: format (prettier) and types (tsc over JSDoc). Installs axe-core for the browser
# tests.
#
# All are pinned in assets/report/package-lock.json and installed below target/, once for each lock file.
# `check-page.sh --write` formats the scripts instead.
set -eu
cd "$(dirname "$0")/.."
. scripts/setup.sh

tools=$PWD/target/page-tools
page=assets/report
if ! cmp -s "$page/package-lock.json" "$tools/installed"; then
    mkdir -p "$tools"
    cp "$page/package.json" "$page/package-lock.json" "$tools/"
    (cd "$tools" && npm ci --no-audit --no-fund --loglevel=error) || stop "npm ci could not install what checks $page"
    cp "$page/package-lock.json" "$tools/installed"
fi
cd "$page"
if [ "${1:-}" = --write ]; then
    exec "$tools/node_modules/.bin/prettier" --write "*.js"
fi
status=0
"$tools/node_modules/.bin/prettier" --check "*.js" || status=1
"$tools/node_modules/.bin/tsc" --project tsconfig.json || status=1
exit "$status"
