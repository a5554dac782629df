#!/bin/sh
# Runs after each edit: unit tests, then the mathematics against closed forms and exact integrals, in about 25 CPU
# seconds besides the build. It needs no Vulkan device.
#
#     sh scripts/loop.sh                  # all of the above
#     sh scripts/loop.sh ladder taps      # in place of the mathematics, the numeric tests with these names
set -eu
cd "$(dirname "$0")/.."

# Without unit tests the library would be built a second time for nothing.
if grep -rq '#\[test\]' src; then
    cargo test --profile edit --lib
fi
[ $# -gt 0 ] || set -- brdf:: color:: design:: diffuse:: environment:: layering:: map_layouts:: math:: metrics:: oracle:: \
    pixels:: placement:: reference:: sequence:: table:: tonemap::
cargo test --profile edit --test numeric -- "$@"
