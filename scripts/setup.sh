# shellcheck shell=sh
# Sourced by demo.sh and test.sh: finds what a build and a Vulkan device need, and installs only what is missing.
#
# POSIX sh. Packages come from apt-get, as root or through sudo. Elsewhere the message names what to install by hand.

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

# The folders in which the Vulkan loader looks for manifests of drivers (icd.d) or layers (explicit_layer.d), one a line.
manifest_dirs() {
    data_dirs=${XDG_DATA_HOME:-${HOME:-/root}/.local/share}:${XDG_DATA_DIRS:-/usr/local/share:/usr/share}
    config_dirs=${XDG_CONFIG_HOME:-${HOME:-/root}/.config}:${XDG_CONFIG_DIRS:-/etc/xdg}:/usr/local/etc:/etc
    printf '%s\n' "$config_dirs:$data_dirs" | tr ':' '\n' | sed -e '/^$/d' -e "s|\$|/vulkan/$1|"
}

has_manifest() { # folder, pattern
    manifest_dirs "$1" | while IFS= read -r dir; do
        for file in "$dir"/$2; do
            [ ! -e "$file" ] || echo found
        done
    done | grep -q found
}

has_compiler() {
    # ${CXX} may hold arguments or a wrapper (ccache g++).
    # shellcheck disable=SC2086
    set -- ${CXX:-c++}
    has_command "$1" && has_command cc
}

has_loader() {
    # ldconfig is not on every user's path.
    if PATH=$PATH:/sbin:/usr/sbin ldconfig -p 2>/dev/null | grep -q 'libvulkan\.so\.1'; then
        return 0
    fi
    printf '%s\n' "${LD_LIBRARY_PATH:-}" | tr ':' '\n' | while IFS= read -r dir; do
        [ ! -e "$dir/libvulkan.so.1" ] || echo found
    done | grep -q found
}

# A driver's manifest, no more: whether a device answers is known after the build, from `splitsum devices`.
has_driver() {
    named=${VK_DRIVER_FILES:-${VK_ICD_FILENAMES:-}}
    if [ -z "$named" ]; then
        has_manifest icd.d '*.json'
        return
    fi
    printf '%s\n' "$named" | tr ':' '\n' | while IFS= read -r file; do
        [ ! -e "$file" ] || echo found
    done | grep -q found
}

has_validation() {
    named=${VK_LAYER_PATH:-}
    if [ -n "$named" ]; then
        printf '%s\n' "$named" | tr ':' '\n' | while IFS= read -r dir; do
            [ ! -e "$dir/VkLayer_khronos_validation.json" ] || echo found
        done | grep -q found
        return
    fi
    has_manifest explicit_layer.d '*khronos_validation*.json'
}

# What the checks look for, for messages.
describe() {
    case $1 in
        has_compiler) echo "a C++ compiler (c++ and cc)" ;;
        has_loader) echo "the Vulkan loader (libvulkan.so.1)" ;;
        has_driver) echo "a Vulkan driver (a manifest in vulkan/icd.d)" ;;
        has_validation) echo "the Vulkan validation layer" ;;
        has_browser) echo "Chromium" ;;
        has_xvfb) echo "Xvfb" ;;
        has_xdotool) echo "xdotool" ;;
        has_openbox) echo "openbox" ;;
        has_node) echo "Node.js (node)" ;;
        has_npm) echo "npm" ;;
    esac
}

# As tests/browser looks for it.
has_browser() {
    has_command chromium || has_command chromium-browser || has_command google-chrome || has_command google-chrome-stable
}

# As tests/view looks for them.
has_xvfb() {
    has_command Xvfb
}

has_xdotool() {
    has_command xdotool
}

has_openbox() {
    has_command openbox
}

has_node() {
    has_command node
}

has_npm() {
    has_command npm
}

install_packages() {
    if ! has_command apt-get; then
        stop "there is no apt-get here; please install by hand, then run this again: $*
  Debian, Ubuntu: g++ libvulkan1 mesa-vulkan-drivers vulkan-validationlayers
  Fedora:         gcc-c++ vulkan-loader mesa-vulkan-drivers vulkan-validation-layers
  Arch:           gcc vulkan-icd-loader vulkan-swrast vulkan-validation-layers"
    fi
    as_root=
    if [ "$(id -u)" -ne 0 ]; then
        has_command sudo || stop "installing needs root and there is no sudo; as root: apt-get install $*"
        as_root=sudo
        # Without a terminal nobody can type a password.
        [ -t 0 ] || as_root="sudo -n"
    fi
    say "installing with apt-get: $*"
    # The package lists of a fresh machine are empty or old; they are fetched only when the first try fails.
    # shellcheck disable=SC2086
    if ! $as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -q --no-install-recommends "$@" </dev/null; then
        say "updating the package lists"
        $as_root apt-get update -q </dev/null || stop "apt-get update failed"
        $as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -q --no-install-recommends "$@" </dev/null ||
            stop "apt-get could not install: $*"
    fi
}

# Installs the packages of the checks that fail: pairs of check and Debian package.
require() {
    packages=
    failed=
    while [ $# -gt 0 ]; do
        if ! "$1"; then
            say "missing: $(describe "$1")"
            packages="$packages $2"
            failed="$failed $1"
        fi
        shift 2
    done
    [ -n "$packages" ] || return 0
    # shellcheck disable=SC2086
    install_packages $packages
    for check in $failed; do
        "$check" || stop "apt-get reports success, but $(describe "$check") is still missing
  files may have been moved or hidden (check VK_DRIVER_FILES, VK_ICD_FILENAMES, VK_LAYER_PATH), or try: apt-get install --reinstall$packages"
    done
}

require_rust() {
    has_command cargo || PATH=$PATH:${CARGO_HOME:-${HOME:-/root}/.cargo}/bin
    has_command cargo || stop "Rust is missing: install it from https://rustup.rs, then run this again"
}

# Builds the tests and lists their binaries, a line each: name and path. Those of unit tests go by their source file.
test_binaries() { # what to build (--test NAME), or nothing for all
    cargo test --release --locked --no-run --quiet "$@" >&2 || return
    cargo test --release --locked --no-run --color never "$@" 2>&1 | sed -n \
        -e 's|^ *Executable unittests \([^ ]*\) (\(.*\))$|\1 \2|p' \
        -e 's|^ *Executable tests/\([^/ ]*\)/main\.rs (\(.*\))$|\1 \2|p' \
        -e 's|^ *Executable tests/\([^/ ]*\)\.rs (\(.*\))$|\1 \2|p'
}

# After the build: a manifest may stand for hardware that is not there. Then the software driver helps.
require_device() {
    # The features of the build are several words.
    # shellcheck disable=SC2086
    if cargo run --release --locked --quiet ${features:-} -- devices; then
        return 0
    fi
    if ! has_manifest icd.d 'lvp_icd*.json'; then
        say "no Vulkan device answers; the software driver lavapipe will do"
        install_packages mesa-vulkan-drivers
        # shellcheck disable=SC2086
        if cargo run --release --locked --quiet ${features:-} -- devices; then
            return 0
        fi
    fi
    stop "no Vulkan device answers although a driver is installed (the message above says why).
  Vulkan 1.3 is needed: Mesa 22.3 or newer. Unset VK_DRIVER_FILES and VK_ICD_FILENAMES if they name another driver."
}
