# shellcheck shell=sh
# Sourced by the other scripts: finds what a build and a Vulkan device need, and installs only what is missing.
#
# POSIX sh. Packages come from apt-get, as root or through sudo. Without apt-get a message lists the packages to install
# by hand. Functions that set variables are subshells, `name() (...)`, so that none of their variables reaches the
# caller. Only require_rust changes the caller: it extends PATH.

say() {
    printf '%s\n' "splitsum: $*"
}

stop() {
    printf '%s\n' "splitsum: $*" >&2
    exit 1
}

has_command() {
    command -v "$1" >/dev/null 2>&1
}

# Succeeds if one of the files on standard input exists: names or patterns, a line each.
any_exists() (
    IFS=
    while read -r pattern; do
        for file in $pattern; do
            [ ! -e "$file" ] || exit 0
        done
    done
    exit 1
)

# Succeeds if the Vulkan loader finds a manifest of a driver (icd.d) or of a layer (explicit_layer.d).
has_manifest() ( # folder, pattern
    data=${XDG_DATA_HOME:-${HOME:-/root}/.local/share}:${XDG_DATA_DIRS:-/usr/local/share:/usr/share}
    config=${XDG_CONFIG_HOME:-${HOME:-/root}/.config}:${XDG_CONFIG_DIRS:-/etc/xdg}:/usr/local/etc:/etc
    printf '%s\n' "$config:$data" | tr ':' '\n' | sed -e '/^$/d' -e "s|\$|/vulkan/$1/$2|" | any_exists
)

has_compiler() (
    # ${CXX} may hold arguments or a wrapper (ccache g++).
    # shellcheck disable=SC2086
    set -- ${CXX:-c++}
    has_command "$1" && has_command cc
)

has_library() { # file
    # /sbin, the folder of ldconfig, is often missing in a user's PATH.
    env PATH="$PATH:/sbin:/usr/sbin" ldconfig -p 2>/dev/null | grep -qF "$1" ||
        printf '%s\n' "${LD_LIBRARY_PATH:-}" | tr ':' '\n' | sed -e '/^$/d' -e "s|\$|/$1|" | any_exists
}

has_loader() {
    has_library libvulkan.so.1
}

# winit loads it when a window opens.
has_keyboard() {
    has_library libxkbcommon-x11.so.0
}

# Looks for a manifest only: `splitsum devices` shows after the build whether a device answers.
has_driver() {
    if [ -n "${VK_DRIVER_FILES:-${VK_ICD_FILENAMES:-}}" ]; then
        printf '%s\n' "${VK_DRIVER_FILES:-$VK_ICD_FILENAMES}" | tr ':' '\n' | any_exists
    else
        has_manifest icd.d '*.json'
    fi
}

has_validation() {
    if [ -n "${VK_LAYER_PATH:-}" ]; then
        printf '%s\n' "$VK_LAYER_PATH" | tr ':' '\n' | sed 's|$|/VkLayer_khronos_validation.json|' | any_exists
    else
        has_manifest explicit_layer.d '*khronos_validation*.json'
    fi
}

# The names that tests/browser looks for.
has_browser() {
    has_command chromium || has_command chromium-browser || has_command google-chrome || has_command google-chrome-stable
}

# Debian packs the files of virtual environments apart from Python.
has_venv() {
    has_command python3 && python3 -c 'import ensurepip' 2>/dev/null
}

# What `require` knows: compiler, loader, driver, validation, browser, keyboard, venv, and any command.
has() { # name
    case $1 in
        compiler | loader | driver | validation | browser | keyboard | venv) "has_$1" ;;
        *) has_command "$1" ;;
    esac
}

package_of() { # name
    case $1 in
        compiler) echo g++ ;;
        loader) echo libvulkan1 ;;
        driver) echo mesa-vulkan-drivers ;;
        validation) echo vulkan-validationlayers ;;
        browser) echo chromium ;;
        keyboard) echo libxkbcommon-x11-0 ;;
        node) echo nodejs ;;
        venv) echo python3-venv ;;
        xz) echo xz-utils ;;
        Xvfb) echo xvfb ;;
        exrenvmap) echo openexr ;;
        pfsin) echo pfstools ;;
        *) echo "$1" ;;
    esac
}

describe() { # name
    case $1 in
        compiler) echo "a C++ compiler (c++ and cc)" ;;
        loader) echo "the Vulkan loader (libvulkan.so.1)" ;;
        driver) echo "a Vulkan driver (a manifest in vulkan/icd.d)" ;;
        validation) echo "the Vulkan validation layer" ;;
        browser) echo "Chromium" ;;
        keyboard) echo "the keyboard library of X11 (libxkbcommon-x11.so.0)" ;;
        venv) echo "Python's virtual environments (ensurepip)" ;;
        *) echo "$1" ;;
    esac
}

# Stops the caller's subshell if the packages cannot be installed.
install_packages() (
    if ! has_command apt-get; then
        stop "apt-get is missing; please install by hand, then run this again: $*
  Debian, Ubuntu: g++ libvulkan1 mesa-vulkan-drivers vulkan-validationlayers
  Fedora:         gcc-c++ vulkan-loader mesa-vulkan-drivers vulkan-validation-layers
  Arch:           gcc vulkan-icd-loader vulkan-swrast vulkan-validation-layers"
    fi
    as_root=
    if [ "$(id -u)" -ne 0 ]; then
        has_command sudo || stop "installing needs root, and sudo is missing; as root: apt-get install $*"
        as_root=sudo
        # Without a terminal nobody can type a password.
        (: </dev/tty) 2>/dev/null || as_root="sudo -n"
    fi
    say "installing with apt-get: $*"
    # The package lists of a fresh machine are empty or old; they are fetched only if the first try fails.
    # shellcheck disable=SC2086
    if ! $as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -q --no-install-recommends "$@" </dev/null; then
        say "updating the package lists"
        $as_root apt-get update -q </dev/null || stop "apt-get update failed"
        $as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -q --no-install-recommends "$@" </dev/null ||
            stop "apt-get could not install: $*"
    fi
)

# Installs the packages of the names that are missing. Fails, with a message, if one is missing afterwards.
require() ( # name...
    missing=
    packages=
    for name in "$@"; do
        has "$name" || { missing="$missing $name" && packages="$packages $(package_of "$name")"; }
    done
    [ -n "$missing" ] || exit 0
    for name in $missing; do
        say "missing: $(describe "$name")"
    done
    # shellcheck disable=SC2086
    install_packages $packages || exit 1
    for name in $missing; do
        has "$name" || stop "apt-get reports success, but $(describe "$name") is still missing
  files may have been moved or hidden (check VK_DRIVER_FILES, VK_ICD_FILENAMES, VK_LAYER_PATH), or try: apt-get install --reinstall$packages"
    done
)

require_rust() {
    has_command cargo || PATH=$PATH:${CARGO_HOME:-${HOME:-/root}/.cargo}/bin
    has_command cargo || stop "Rust is missing: install it from https://rustup.rs, then run this again"
}

# Builds the tests and lists their binaries, a line each: name and path. Unit tests are named by their source file.
test_binaries() { # what to build (--test NAME), or nothing for all
    cargo test --release --locked --no-run --quiet "$@" >&2 || return
    cargo test --release --locked --no-run --color never "$@" 2>&1 | sed -n \
        -e 's|^ *Executable unittests \([^ ]*\) (\(.*\))$|\1 \2|p' \
        -e 's|^ *Executable tests/\([^/ ]*\)/main\.rs (\(.*\))$|\1 \2|p' \
        -e 's|^ *Executable tests/\([^/ ]*\)\.rs (\(.*\))$|\1 \2|p'
}

# After the build: a manifest may describe hardware that this machine lacks. Then the software driver is installed.
require_device() ( # the program: a path, or cargo run ... --
    ! "$@" devices || exit 0
    if ! has_manifest icd.d 'lvp_icd*.json'; then
        say "no Vulkan device answers; installing the software driver lavapipe"
        install_packages mesa-vulkan-drivers || exit 1
        ! "$@" devices || exit 0
    fi
    stop "no Vulkan device answers although a driver is installed (the message above says why).
  Vulkan 1.3 is needed: Mesa 22.3 or newer. Unset VK_DRIVER_FILES and VK_ICD_FILENAMES if they name another driver."
)
