#!/bin/sh
# Fails if a document has a measured number that is typed: a decimal number or a percentage that no block from results/ fills.
#
#     sh scripts/check-numbers.sh [FILE...]     # default: README.md and docs/
#
# These pages, or sections of pages, have numbers that no published table can fill:
#
#     docs/architecture.md                          goldens and shares of tests
#     docs/bakes.md          Files                  formats
#     docs/bakes.md          Conventions            formulas and versions of engines
#     docs/bakes.md          Scores                 definitions and limits
#     docs/bakes.md          Bakes for engines      pixel formats, by hand
#     docs/bakes.md          Checked in other programs  pictures of other programs, by scripts/check-clients.sh
#     docs/bibliography.md                          titles
#     docs/bringing-maps.md                         files and programs by hand and by scripts/check-files.sh
#     docs/columns.md                               definitions
#     docs/conventions.md                           definitions
#     docs/estimators.md                            algebra and constants of sources
#     docs/glossary.md                              definitions
#     docs/own-method.md                            ranges of inputs
#     docs/paste.md          Tables                 algebra of a clamped lookup
#     docs/python.md         PyTorch                versions and tolerances
#     docs/recovery.md       Between the published roughnesses  fits under scripts/synthetic_maps.py and built-in maps
#     docs/recovery.md       nvdiffrec's own prefilter  runs of its code, by findings/envlight-prefilter.sh
#     docs/recovery.md       Example                runs of python/examples/recover_material.py
#     docs/recovery.md       Unknown light          runs of python/examples/recovery_light.py
#     docs/recovery.md       Time and memory        a benchmark on one machine
#     docs/research.md       Taps                   constants of the fit
#     docs/research.md       Trials without a published run  trials without a published run
#     docs/running.md                               times of single commands on one machine
#     docs/source-documents.md                      sources
#     docs/testing.md        By hand                programs by hand
#     docs/testing.md        How far numbers move   runs under emulated limits
#     docs/testing.md        Missed goals           times of single commands on one machine
set -eu
cd "$(dirname "$0")/.."
. scripts/setup.sh

typed=$(sed -n 's/^# *\(docs[^ ]*\)  */\1|/p' scripts/check-numbers.sh)
[ $# -gt 0 ] || set -- README.md docs/*.md
found=$(awk -v typed="$typed" '
    BEGIN {
        count = split(typed, pages, "\n")
        for (i = 1; i <= count; i++) {
            page = section = pages[i]
            sub(/\|.*/, "", page)
            sub(/[^|]*\|/, "", section)
            # The reason alone follows a page that is excluded as a whole.
            if (sub(/  .*/, "", section)) is_typed[page "# " section] = 1; else is_typed[page] = 1
        }
        # Words before a number that is a place, a version or a level of confidence, and words that continue a list of them.
        split("alpha roughness f0 n·v mesa lavapipe rust debian apache-2 ofl version renderdoc", list, " ")
        for (i in list) is_place_word[list[i]] = 1
        split("to and or of at below above from until is are", list, " ")
        for (i in list) joins[list[i]] = 1
        joins[""] = 1
    }
    FNR == 1 { is_code = is_filled = 0; heading = "" }
    /^##? / { heading = $0; sub(/^#+ /, "", heading) }
    {
        is_fence = $1 ~ /^```/
        if (is_fence) is_code = !is_code
        if (/^<!-- (csv|sentence) /) is_filled = 1
        is_skipped = is_code || is_fence || is_filled || /^    /
        if (/<!-- \//) is_filled = 0
        if (is_skipped || FILENAME in is_typed || FILENAME "# " heading in is_typed) next
        gsub(/`[^`]*`/, "CODE")
        # Blocks within a sentence.
        while ((at = index($0, "<!-- csv ")) && (end = index(substr($0, at), "<!-- /csv -->")))
            $0 = substr($0, 1, at - 1) substr($0, at + end + 12)
        is_place = 0
        for (i = 1; i <= NF; i++) {
            bare = tolower($i)
            gsub(/^[^[:alnum:]]+|[^[:alnum:]]+$/, "", bare)
            is_number = bare ~ /^[0-9]+(\.[0-9]+)?(e-?[0-9]+)?$/
            is_share = $(i + 1) ~ /^%/ && bare != "95" && bare != "100"
            if (is_number && !is_place && (bare ~ /[.e]/ || is_share)) print FILENAME ":" FNR ": " bare
            else if (!is_number) is_place = bare in is_place_word || is_place && bare in joins
        }
    }' "$@")
[ -z "$found" ] || stop "typed numbers: fill each by a block from results/, or add its section to scripts/check-numbers.sh:
$found"
