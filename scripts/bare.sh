#!/bin/sh
# Runs both commands of the README in a bare Debian root that has Rust and nothing else, as a new user would. With CI set,
# the tests run all parts there, and then this is all that continuous integration needs.
#
# Needs root, debootstrap (installed if CI is set) and a network for apt; otherwise prints one line and exits with
# status 77. The root is a folder below target/, removed at the end. Its mounts and processes live in namespaces of
# their own, which end with this script.
set -eu
cd "$(dirname "$0")/.."
. scripts/setup.sh

skip() {
    say "skipped: the bare root ($*)"
    exit 77
}
[ "$(id -u)" -eq 0 ] || skip "it needs root"
has_command apt-get || skip "apt-get is missing"
[ -z "${CI:-}" ] || has_command debootstrap || require debootstrap
has_command debootstrap || skip "debootstrap is missing: apt-get install debootstrap"
isolated="setpriv --pdeathsig KILL unshare --mount --pid --fork --kill-child"
$isolated true 2>/dev/null || skip "this machine forbids mount and process namespaces"
require_rust
rust=$(rustc --print sysroot)

# The release and the mirrors of this machine's apt.
suite=$(. /etc/os-release && echo "${VERSION_CODENAME:-}")
# shellcheck disable=SC2016
sources=$(apt-get indextargets --format 'deb $(REPO_URI) $(RELEASE) $(COMPONENT)' 'Created-By: Packages' |
    grep -E "^deb [^ ]+ $suite(-updates|-security)? main\$") || skip "apt has no sources for '$suite'"
mirror=$(printf '%s\n' "$sources" | sed -n "s/^deb \([^ ]*\) $suite main\$/\1/p" | head -n 1)

mkdir -p target
root=$(mktemp -d "$PWD/target/bare.XXXXXX")
at_work=
finish() {
    trap - EXIT
    if [ -n "$at_work" ]; then
        kill -KILL "$at_work" 2>/dev/null || true
    fi
    # Processes of the root may write until the kernel has ended them.
    tries=50
    until rm -rf --one-file-system "$root" 2>/dev/null; do
        tries=$((tries - 1))
        [ "$tries" -gt 0 ] || stop "could not remove $root"
        sleep 0.2
    done
}
trap finish EXIT
trap 'exit 130' INT
trap 'exit 143' TERM

# Runs a command that ends with this script, however this script ends.
run() {
    # shellcheck disable=SC2086
    $isolated "$@" </dev/null &
    at_work=$!
    wait "$at_work" && ended=0 || ended=$?
    at_work=
    return "$ended"
}

began=$(date +%s)
say "making a bare root of $suite"
run debootstrap --variant=minbase "$suite" "$root" "$mirror"
printf '%s\n' "$sources" >"$root/etc/apt/sources.list"
# Proxies, certificates and time checks of this machine's apt.
apt-config dump | grep '^Acquire::' >"$root/etc/apt/apt.conf.d/99host" || true
cp /etc/resolv.conf /etc/hosts "$root/etc/"

# Rust, and the crates that are downloaded already.
cargo=${CARGO_HOME:-$HOME/.cargo}
mkdir -p "$root/opt/rust" "$root/root/.cargo/registry" "$root/root/splitsum"
for name in config.toml registry/cache registry/index; do
    [ ! -e "$cargo/$name" ] || cp -a "$cargo/$name" "$root/root/.cargo/$name"
done
[ ! -e "${SSL_CERT_FILE:-/etc/ssl/certs/ca-certificates.crt}" ] ||
    cp "${SSL_CERT_FILE:-/etc/ssl/certs/ca-certificates.crt}" "$root/root/.cargo/certificates"
tar --exclude=./target --exclude=./.git --exclude=./runs --exclude=./experiments/environments --exclude=./fuzz/target \
    -cf - . | tar -xf - -C "$root/root/splitsum"

cat >"$root/root/commands" <<'COMMANDS'
set -eu
cd splitsum
began=$(date +%s)
sh scripts/demo.sh
demo=$(date +%s)
sh scripts/test.sh
echo "splitsum: demo.sh took $((demo - began)) s, test.sh $(($(date +%s) - demo)) s"
COMMANDS
say "the root is ready after $(($(date +%s) - began)) s"
# shellcheck disable=SC2016
run sh -euc '
    root=$1
    mount --rbind /dev "$root/dev"
    mount --rbind /sys "$root/sys"
    mount -t proc proc "$root/proc"
    mount --bind "$2" "$root/opt/rust"
    mount -o remount,bind,ro "$root/opt/rust"
    path=/opt/rust/bin:/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin
    certificates=/root/.cargo/certificates
    exec chroot "$root" env -i HOME=/root PATH="$path" CI="$3" SSL_CERT_FILE=$certificates \
        NODE_EXTRA_CA_CERTS=$certificates PIP_CERT=$certificates sh -c "cd && exec sh ./commands"
' sh "$root" "$rust" "${CI:-}" || stop "FAILED in the bare root: exit status $?"
say "PASSED in the bare root, in $(($(date +%s) - began)) s"
