#!/bin/sh
# Tests the scripts of README, CI, setup and GPUs with stubs of cargo, apt-get and every other tool. Each part of the tests
# is made to fail once, on a bare machine and on a full one, for a plain user and with CI set: the last line and the exit
# status must be right each time.
set -eu
cd "$(dirname "$0")/.."
. scripts/setup.sh
scripts=$PWD/scripts
WORK=$(mktemp -d)
export WORK
trap 'rm -rf "$WORK"' EXIT
trap 'exit 130' INT
trap 'exit 143' TERM
# What the caller's environment must not change.
unset CI CXX CARGO_HOME VK_ICD_FILENAMES LD_LIBRARY_PATH SPLITSUM_SECOND_DRIVER

# Every tool is this stub under another name. It logs its call and ends as $FAIL_WITH says if the call matches a pattern
# of $FAIL.
cat >"$WORK/stub" <<'STUB'
#!/bin/sh
call="${0##*/}${*:+ $*}"
echo "$call" >>"$BOX/calls"
case $call in
    "sudo -n "*) shift && exec "$@" ;;
    "sudo "*) exec "$@" ;;
    "id -u") echo "$USER_ID" && exit ;;
    "cargo deny --version" | "cargo machete --version") [ -e "$BOX/bin/shellcheck" ] && exit || exit 101 ;;
    *" --version") exit ;;
esac
set -f
IFS=';'
for pattern in $FAIL; do
    # shellcheck disable=SC2254
    case $call in $pattern) ;; *) continue ;; esac
    case $FAIL_WITH in
        success) exit 0 ;;
        SEGV) kill -SEGV $$ ;;
        # Ends the script that called.
        TERM) kill -TERM $PPID && exit 0 ;;
        *) exit "$FAIL_WITH" ;;
    esac
done
unset IFS
set +f
bring() { # files...
    for file in "$@"; do
        ln -sf "$WORK/stub" "$BOX/$file"
    done
}
case $call in
    "apt-get update"*) : >"$BOX/lists" ;;
    "apt-get install"*)
        # A fresh machine has no package lists.
        [ -e "$BOX/lists" ] || exit 100
        for package in "$@"; do
            case $package in
                g++) bring bin/c++ bin/cc ;;
                libvulkan1) bring libvulkan.so.1 ;;
                libxkbcommon-x11-0) bring libxkbcommon-x11.so.0 ;;
                mesa-vulkan-drivers) bring driver.json ;;
                vulkan-validationlayers) bring VkLayer_khronos_validation.json ;;
                xvfb) bring bin/Xvfb ;;
                nodejs) bring bin/node ;;
                chromium | xdotool | openbox | npm | python3 | debootstrap) bring "bin/$package" ;;
            esac
        done
        ;;
    "ldconfig "*) ls "$BOX" ;;
    "cargo run"*" devices") [ -e "$BOX/driver.json" ] ;;
    "cargo test"*"--no-run --color never"*)
        cat >&2 <<'LIST'
   Compiling splitsum
  Executable unittests src/lib.rs (target/lib)
  Executable unittests src/main.rs (target/main)
  Executable tests/browser/main.rs (target/browser)
  Executable tests/cli/main.rs (target/cli)
  Executable tests/device/main.rs (target/device)
  Executable tests/numeric/main.rs (target/numeric)
  Executable tests/view/main.rs (target/view)
LIST
        ;;
esac
STUB
chmod +x "$WORK/stub"

# Makes a machine: a folder with the repository and a PATH of its own, which has Rust, and on a full machine everything
# else.
box() { # name, machine
    mkdir -p "$1/bin" "$1/scripts" "$1/src/study/questions" "$1/target/release" "$1/tmp" "$1/.cargo"
    for tool in cat cut date dirname env grep ln ls mkdir mktemp nice paste rm sed sh sort tr wc; do
        ln -s "$(command -v "$tool")" "$1/bin/$tool"
    done
    cp "$scripts/test.sh" "$scripts/demo.sh" "$scripts/bare.sh" "$scripts/setup.sh" "$1/scripts/"
    files="bin/apt-get bin/sudo bin/id bin/ldconfig bin/cargo bin/rustfmt target/release/splitsum
        scripts/test-scripts.sh scripts/check-commits.sh scripts/check-words.sh scripts/check-numbers.sh scripts/check-page.sh
        scripts/check-clients.sh scripts/check-files.sh scripts/check-package.sh scripts/check-python.sh scripts/check-shaders.sh scripts/cluster-test.sh
        scripts/second-driver.sh scripts/gpu.sh scripts/examples.sh
        target/lib target/main target/browser target/cli target/device target/numeric target/view"
    if [ "$2" = full ]; then
        mkdir -p "$1/.cargo/advisory-dbs/db/.git"
        files="$files bin/c++ bin/cc libvulkan.so.1 driver.json VkLayer_khronos_validation.json
            libxkbcommon-x11.so.0 bin/chromium bin/Xvfb bin/xdotool bin/openbox bin/node bin/npm bin/python3 bin/shellcheck"
    fi
    for file in $files; do
        ln -s "$WORK/stub" "$1/$file"
    done
}
box "$WORK/bare" bare
box "$WORK/full" full

# Runs a script on a fresh copy of a machine and compares its exit status and its last line. The copy stays at $box.
runs_as() { # machine, user or ci, what fails, how, script, expected status, expected last line without its seconds
    rm -rf "$box"
    cp -a "$WORK/$1" "$box"
    status=0
    (
        cd "$box"
        export BOX="$box" PATH="$box/bin" HOME="$box" TMPDIR="$box/tmp" FAIL="$3" FAIL_WITH="$4" USER_ID=1000
        export VK_DRIVER_FILES="$box/driver.json${DRIVER:+:$box/$DRIVER}" VK_LAYER_PATH="$box"
        export XDG_DATA_HOME="$box" XDG_DATA_DIRS="$box"
        if [ "$2" = ci ]; then
            export CI=true USER_ID=0
        fi
        exec sh "scripts/$5"
    ) >"$box/output" 2>&1 </dev/null || status=$?
    last=$(sed -n -e 's/ in [0-9]* s$//' -e 's/^splitsum: //' -e '$p' "$box/output")
    run="$5 on a $1 machine, $2, '$3' ends with $4"
    # shellcheck disable=SC2254
    case "$status: $last" in
        "$6: "$7) ;;
        *) complain "$status: $last, expected $6: $7" ;;
    esac
    # Nothing may be left behind.
    [ -z "$(ls "$box/tmp")" ] || complain "files in TMPDIR: $(ls "$box/tmp")"
}

complain() {
    printf '%s\n' "$run: $*" "--- the end of its output:"
    tail -n 12 "$box/output" | sed 's/^/    /'
    : >"$WORK/wrong"
}

has_output() { # pattern
    grep -q -e "$1" "$box/output" || complain "no line '$1'"
}

has_call() { # pattern
    grep -q -e "$1" "$box/calls" || complain "no call '$1'"
}

# Makes a part fail, and compares the name in the last line. Parts that do not depend on it still run.
part() { # MACHINE-USER..., what fails, how, name
    for where in $1; do
        case $where in *"$kind") ;; *) continue ;; esac
        runs_as "${where%-*}" "$kind" "$2" "$3" test.sh 1 "FAILED: $4"
        case $4 in
            *"$stops" | "doc tests") ;;
            *) has_output "^ok doc tests" ;;
        esac
    done
}

parts() { # user or ci
    kind=$1
    box=$WORK/$kind
    stops=", and nothing after it ran"
    bare="bare-user bare-ci"
    full="full-user full-ci"
    part "$bare $full" test-scripts.sh 1 scripts/test-scripts.sh
    part "$bare $full" check-commits.sh 1 scripts/check-commits.sh
    part "$bare $full" check-words.sh 1 scripts/check-words.sh
    part "$bare $full" check-numbers.sh 1 scripts/check-numbers.sh
    part "$bare" "apt-get install*libvulkan1*" 100 "setup$stops"
    part "$bare" "apt-get install*vulkan-validationlayers*" success "setup$stops"
    part "$bare" "apt-get update*" 100 "setup$stops"
    part "$bare $full" "cargo fmt --check" 1 "cargo fmt"
    part "$bare $full" "rustfmt --check*" 1 "rustfmt of the questions"
    part "$bare $full" "cargo build*" 101 "the build$stops"
    part "$bare $full" "cargo test*--no-run" 101 "the build$stops"
    part "$bare $full" "cargo run*devices" 1 "Vulkan devices$stops"
    part "$bare $full" "cargo test*--no-run --quiet*" 101 "the list of test binaries$stops"
    part "$bare $full" "cargo test*--no-run --color never*" success "the list of test binaries$stops"
    part "$bare $full" "cargo clippy *-D warnings" 101 "cargo clippy"
    part "$full" "cargo deny *licenses*" 4 "cargo deny: exit status 4"
    part "$full" "cargo deny *advisories" 1 "cargo deny advisories"
    part "$full" "cargo machete" 1 "cargo machete"
    part "$full" "shellcheck *" 1 "shellcheck"
    part bare-ci "apt-get install*nodejs*" 100 "installing node npm"
    part "bare-ci $full" check-page.sh 1 scripts/check-page.sh
    part bare-ci "apt-get install*chromium*" 100 "installing browser"
    part bare-ci "apt-get install*xvfb*" success "installing Xvfb xdotool openbox keyboard"
    part "$bare $full" lib 101 src/lib.rs
    part "$bare $full" main 101 src/main.rs
    for binary in browser cli device numeric view; do
        part "$bare $full" "$binary" 101 "$binary"
    done
    part "$bare $full" device SEGV "device: killed by SIGSEGV"
    part "$bare $full" numeric SEGV "numeric: killed by SIGSEGV"
    part "$bare $full" "cargo test*--doc" 101 "doc tests"
    part "$bare $full" examples.sh 1 scripts/examples.sh
    part bare-ci "apt-get install*python3*" 100 "installing python3 venv"
    part full-ci "python3 *ensurepip;apt-get install*python3-venv*" 1 "installing python3 venv"
    part "bare-ci $full" check-python.sh 1 scripts/check-python.sh
    part "bare-ci full-ci" check-clients.sh 1 scripts/check-clients.sh
    part "bare-ci full-ci" check-files.sh 1 scripts/check-files.sh
    part "bare-ci full-ci" check-package.sh 1 scripts/check-package.sh
    part "bare-ci full-ci" check-shaders.sh 1 scripts/check-shaders.sh
    part "bare-ci full-ci" "cluster-test.sh *" 1 scripts/cluster-test.sh
    part "bare-ci full-ci" "second-driver.sh *" 1 scripts/second-driver.sh
    part "bare-ci full-ci" "gpu.sh *" 1 scripts/gpu.sh

    # Ends from outside: the last line names the part, and no process or file is left.
    part "$bare $full" "cargo clippy *-D warnings" TERM "cargo clippy: killed by SIGTERM$stops"
    # Two parts, with installations between and after them.
    part "$bare $full" "cargo clippy *-D warnings;view" 101 "cargo clippy; view"
}

# Machines on which everything passes, and what they install and skip.
passes() {
    box=$WORK/passes
    runs_as bare user nothing 0 test.sh 0 PASSED
    has_call "^sudo -n env DEBIAN_FRONTEND=noninteractive apt-get install .* g++ libvulkan1 mesa-vulkan-drivers vulkan-validationlayers"
    has_call "^sudo .*apt-get install .* xvfb xdotool openbox libxkbcommon-x11-0"
    has_output "^skipped shellcheck (shellcheck is missing: apt-get install shellcheck)"
    has_output "^skipped scripts/check-page.sh (Node.js or npm is missing)"
    has_output "^skipped scripts/check-python.sh (python3 or its venv is missing)"
    runs_as bare ci nothing 0 test.sh 0 PASSED
    has_call "^apt-get install .* nodejs npm"
    has_call "^apt-get install .* python3 python3-venv"
    has_output "^ok scripts/second-driver.sh"
    runs_as full user "splitsum cost *" 2 test.sh 0 PASSED
    has_output "^skipped compiling every pipeline for AMD GPUs"
    runs_as full ci "check-clients.sh;check-files.sh;check-package.sh;check-python.sh;check-shaders.sh;cluster-test.sh *;second-driver.sh *" 77 test.sh 0 PASSED
    has_output "^skipped scripts/cluster-test.sh (the reason is above)"
    [ "$(grep -c "apt-get install" "$box/calls")" -eq 0 ] || complain "installs something"
    # A plain user is spared what cannot be installed.
    runs_as bare user "apt-get install*chromium*;apt-get install*xvfb*" 100 test.sh 0 PASSED
    has_output "^skipped the tests of the report in a browser (browser could not be installed)"
    has_output "^skipped the tests of the window (Xvfb xdotool openbox keyboard could not be installed)"

    for tool in sudo apt-get cargo; do
        mv "$WORK/bare/bin/$tool" "$WORK/"
        runs_as bare user nothing 0 test.sh 1 "FAILED: setup, and nothing after it ran"
        mv "$WORK/$tool" "$WORK/bare/bin/"
        case $tool in
            sudo) has_output "installing needs root, and sudo is missing; as root: apt-get install g++" ;;
            apt-get) has_output "apt-get is missing; please install by hand, then run this again: g++" ;;
            cargo) has_output "Rust is missing: install it from https://rustup.rs" ;;
        esac
    done
}

demo() {
    box=$WORK/demo
    runs_as bare user nothing 0 demo.sh 0 "running experiments/quick.toml"
    has_call "^cargo run --release --locked --quiet -- run experiments/quick.toml"
    runs_as bare user "cargo build*" 101 demo.sh 101 "building (the first time takes a few minutes)"
    runs_as bare user "cargo run*quick.toml" 4 demo.sh 4 "running experiments/quick.toml"
    runs_as bare user "apt-get install*" 100 demo.sh 1 "apt-get could not install: g++ libvulkan1 mesa-vulkan-drivers"
    # A manifest without a device: lavapipe is installed, and answers.
    : >"$WORK/full/other.json"
    DRIVER=other.json
    mv "$WORK/full/driver.json" "$WORK/"
    runs_as full ci nothing 0 demo.sh 0 "running experiments/quick.toml"
    has_output "no Vulkan device answers; installing the software driver lavapipe"
    mv "$WORK/driver.json" "$WORK/full/"
    DRIVER=
    # No device, for all that is installed.
    runs_as full ci "cargo run*devices" 1 demo.sh 1 "  Vulkan 1.3 is needed: Mesa 22.3 or newer. Unset VK_DRIVER_FILES and VK_ICD_FILENAMES if they name another driver."
}

# Where the bare root cannot be made.
bare() {
    box=$WORK/root
    runs_as full user nothing 0 bare.sh 77 "skipped: the bare root (it needs root)"
    runs_as full ci "apt-get install*" 100 bare.sh 1 "apt-get could not install: debootstrap"
    runs_as full ci nothing 0 bare.sh 77 "skipped: the bare root (this machine forbids mount and process namespaces)"
}

# Without Python, or a package index, neither a workflow nor the package can run.
python() {
    box=$WORK/python
    cp -a "$WORK/bare" "$WORK/no-python"
    rm "$WORK/no-python/scripts/cluster-test.sh" "$WORK/no-python/scripts/check-python.sh"
    cp "$scripts/cluster-test.sh" "$scripts/check-python.sh" "$scripts/slurm.sh" "$WORK/no-python/scripts/"
    runs_as no-python ci nothing 0 check-python.sh 77 "skipped: the Python package: python3 is missing"
    runs_as no-python ci nothing 0 cluster-test.sh 77 "skipped: the cluster test (local): Snakemake 9 needs Python 3.11"
}

# No function of setup.sh changes a variable of its caller.
variables() (
    box=$WORK/variables
    run="variables of setup.sh"
    cp -a "$WORK/bare" "$box"
    cat >"$box/script" <<'SCRIPT'
. scripts/setup.sh
everything() {
    require compiler loader driver validation browser Xvfb xdotool openbox keyboard node npm python3 venv
    require_rust
    require_device cargo run --
    test_binaries
    install_packages nothing
    require absent || true
}
# Variables that the shell and this comparison do not set.
variables() {
    set | grep -Ev '^(_|BASH.*|EPOCH.*|LINENO|OPTIND|PIPESTATUS|PPID|RANDOM|SECONDS|SRANDOM)='
}
variables >before
everything
variables >after
cmp before after || { diff before after; exit 1; }
SCRIPT
    ln -s "$(command -v cmp)" "$(command -v diff)" "$box/bin/"
    cd "$box"
    BOX=$box PATH=$box/bin HOME=$box FAIL='' FAIL_WITH=0 USER_ID=1000 \
        VK_DRIVER_FILES=$box/driver.json VK_LAYER_PATH=$box sh ./script >"$box/output" 2>&1 </dev/null || complain "changed by a function"
    has_output "but absent is still missing"
)

commits() (
    box=$WORK/commits
    run="check-commits.sh"
    mkdir -p "$box/scripts"
    cp "$scripts/check-commits.sh" "$scripts/setup.sh" "$box/scripts/"
    cd "$box"
    says() { # expected status, expected text
        status=0
        sh scripts/check-commits.sh "$base" >"$box/output" 2>&1 || status=$?
        [ "$status" -eq "$1" ] || complain "exit status $status, expected $1"
        [ -z "$2" ] || has_output "$2"
    }
    base=40b0298
    says 77 "skipped: commit subjects (the history since 40b0298 is not here)"
    has_command git || exit 0
    export GIT_CONFIG_GLOBAL=/dev/null GIT_CONFIG_SYSTEM=/dev/null
    export GIT_AUTHOR_NAME=a GIT_AUTHOR_EMAIL=a@b GIT_COMMITTER_NAME=a GIT_COMMITTER_EMAIL=a@b
    commit() {
        git commit -q --allow-empty -m "$1"
    }
    git init -q .
    commit "An old commit, of any form"
    base=$(git rev-parse HEAD)
    commit "config: report the first unclosed bracket"
    commit "docs/testing: name n·v, ε and σ in a subject with seventy-two characters"
    says 0 ''
    for subject in "Report brackets" "config: Report brackets" "config:report" "config report: a bracket" \
        "docs: write a subject of seventy-three characters, one more than is right"; do
        commit "$subject"
        says 1 "$subject"
        git reset -q --hard HEAD^
    done
)

words() (
    box=$WORK/words
    run="check-words.sh"
    mkdir -p "$box"
    cat >"$box/a.rs" <<'EOF'
/// Prints that
/// of mine, `anew`.
let told = "a \
  mend"; // anew
f("is", "no", "whoever");
fn a_name_that_is_no_fact() {}
EOF
    cat >"$box/b.md" <<'EOF'
It is
no number. Told, `anew` and

    whoever
```
mend
```
No longer is it so, and there is no
other.
EOF
    sh "$scripts/check-words.sh" "$box/a.rs" "$box/b.md" >"$box/output" 2>&1 && complain "passes"
    [ "$(grep -c "$box" "$box/output")" -eq 8 ] || complain "finds other phrases"
)

numbers() (
    box=$WORK/numbers
    run="check-numbers.sh"
    mkdir -p "$box/scripts" "$box/docs"
    cp "$scripts/check-numbers.sh" "$scripts/setup.sh" "$box/scripts/"
    cat >"$box/README.md" <<'EOF'
# A

At alpha 0.1, 0.25 and 0.5 it is 0.12. A share of 53 %, with 95 % <!-- csv a/b.csv x=0.5 -->0.7<!-- /csv -->, `0.4`.
<!-- csv a/b.csv -->
| 0.3 |
<!-- /csv -->
## B
1.5 times
EOF
    cp "$box/README.md" "$box/docs/glossary.md"
    printf '## Files\n\n0.1\n\n## Others\n\n0.2\n' >"$box/docs/bakes.md"
    sh "$box/scripts/check-numbers.sh" >"$box/output" 2>&1 && complain "passes"
    printf '%s\n' README.md:3:\ 0.12 README.md:3:\ 53 README.md:8:\ 1.5 docs/bakes.md:7:\ 0.2 >"$box/right"
    sed 1d "$box/output" | cmp -s - "$box/right" || complain "finds other numbers: $(cat "$box/output")"
)

# The archive for a GPU, with stubs of its programs: only answers under the lights of the published run are compared.
gpu_archive() (
    box=$WORK/gpu
    run="gpu.sh"
    mkdir -p "$box/bin" "$box/scripts" "$box/experiments"
    # Bare machines have neither Python nor xz.
    printf '#!/bin/sh\ncmp "$2/effect.csv" "$3/effect.csv"\n' >"$box/bin/python3"
    printf '#!/bin/sh\ncat\n' >"$box/bin/xz"
    PATH=$box/bin:$PATH
    cp "$scripts/gpu.sh" "$box/"
    cp "$scripts/lights.sh" "$box/scripts/"
    echo "name,place" >"$box/experiments/environments.csv"
    echo 1 >"$box/commit"
    printf '#!/bin/sh\n' >"$box/device"
    cat >"$box/splitsum" <<'PROGRAM'
#!/bin/sh
case $1 in
    devices) printf '| --device | name | type |\n|---|---|---|\n| 0 | software | cpu |\n' && exit ;;
esac
for out in "$@"; do
    [ "$before" != --out ] || break
    before=$out
done
case $1 in
    render) : >"$out" ;;
    run) mkdir -p "$out/answers" && printf 'value\n2\n' >"$out/answers/effect.csv" ;;
esac
PROGRAM
    chmod +x "$box/splitsum" "$box/device" "$box"/bin/*
    publishes() { # experiment, a map, the published value
        mkdir -p "$box/results/$1/answers"
        echo "{ \"$2\": 0 }" >"$box/results/$1/provenance.json"
        printf 'value\n%s\n' "$3" >"$box/results/$1/answers/effect.csv"
    }
    rehearses() { # expected status
        rm -rf "$box/results-gpu"
        status=0
        sh "$box/gpu.sh" run 1 --rehearse --out "$box/results-gpu" >"$box/output" 2>&1 || status=$?
        [ "$status" -eq "$1" ] || complain "exit status $status, expected $1"
    }
    publishes quick none 2
    publishes diffuse experiments/environments/absent_1k.hdr 7
    rehearses 0
    has_output "^compare-quick,ok,"
    has_output "diffuse: not compared (.*experiments/environments/absent_1k.hdr"
    publishes diffuse none 7
    rehearses 1
    has_output "^compare-diffuse,differs,"
    has_output "answers/effect.csv differ"
)

# Two at a time.
parts user >"$WORK/user.log" 2>&1 &
(parts ci && passes && demo && bare && python && variables && commits && words && numbers && gpu_archive) >"$WORK/ci.log" 2>&1 || : >"$WORK/wrong"
wait $! || : >"$WORK/wrong"
cat "$WORK/user.log" "$WORK/ci.log"
[ ! -e "$WORK/wrong" ]
