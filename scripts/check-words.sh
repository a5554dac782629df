#!/bin/sh
# Fails if a document, a message, a comment or the name of a test has a banned phrase. Code and code spans may.
#
#     sh scripts/check-words.sh [FILE...]       # default: every text of the repository
set -eu
cd "$(dirname "$0")/.."
. scripts/setup.sh

[ $# -gt 0 ] || set -- ./*.md docs experiments cluster results src tests examples benches shaders python assets/report scripts
found=$(find "$@" -type f ! -name check-words.sh ! -name test-scripts.sh ! -path '*/target/*' ! -path '*/answers/*' ! -name summary.md \( \
    -name '*.md' -o -name '*.toml' -o -name '*.yaml' -o -name '*.rs' -o -name '*.py' -o -name '*.sh' -o -name '*.mjs' -o -name '*.js' \
    -o -name '*.html' -o -name '*.glsl' -o -name '*.comp' -o -name '*.vert' -o -name '*.frag' \) -exec awk '
    BEGIN {
        count = split("told,tells of,anew,is no,are no,was no,were no,hangs on,hang on,stands for itself,mend,mends,whoever," \
            "that of,those of,stands beside,stand beside,stands in,as it stands,held against,somebody", banned, ",")
        # Plain English that has a banned phrase.
        plain = split(" no longer, there is no , there are no , there was no , there were no ", allowed, ",")
        split("# // //! /// \\", list, " ")
        for (i in list) is_mark[list[i]] = 1
    }
    function report(    i, at, end, rest) {
        text = " " tolower(text) " "
        for (i = 1; i <= plain; i++) gsub(allowed[i], " ... ", text)
        for (i = 1; i <= count; i++) {
            for (rest = text; (at = index(rest, banned[i])); rest = substr(rest, end)) {
                end = at + length(banned[i])
                if (substr(rest, at - 1, 1) !~ /[[:alnum:]]/ && substr(rest, end, 1) !~ /[[:alnum:]]/)
                    print file ": " substr(rest, at, 60)
            }
        }
        text = ""
    }
    # A phrase may continue on the next line, but not across punctuation.
    FNR == 1 { report(); file = FILENAME; is_prose = file ~ /\.(md|toml)$/; is_rust = file ~ /\.rs$/; is_code = is_filled = 0 }
    is_prose {
        is_fence = $1 ~ /^```/
        if (is_fence) is_code = !is_code
        if (/^<!-- (csv|sentence) /) is_filled = 1
        is_skipped = is_code || is_fence || is_filled || /^    /
        if (/<!-- \//) is_filled = 0
        if (is_skipped) next
    }
    is_prose || is_rust { gsub(/`[^`]*`/, "CODE") }
    # Names of functions are words; a mark at each quote keeps code and literals apart.
    is_rust { gsub(/"/, " . "); if (/fn /) gsub(/_/, " ") }
    { for (i = 1; i <= NF; i++) if (!($i in is_mark)) text = text " " $i }
    END { report() }' {} +)
[ -z "$found" ] || stop "banned phrases:
$found"
