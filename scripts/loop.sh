#!/bin/sh
# Runs after each edit: unit tests, then the mathematics against closed forms and exact integrals, in about 32 CPU
# seconds besides the build. It needs no Vulkan device.
#
#     sh scripts/loop.sh                  # all of the above
#     sh scripts/loop.sh ladder taps      # in place of the mathematics, the numeric tests with these names
set -eu
cd "$(dirname "$0")/.."

cargo test --profile edit --lib
[ $# -gt 0 ] || set -- brdf:: design:: diffuse:: environment:: layering:: map_layouts:: math:: metrics:: oracle:: \
    pixels:: placement:: reference:: sequence:: tonemap::
cargo test --profile edit --test numeric -- "$@"
