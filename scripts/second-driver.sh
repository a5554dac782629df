#!/bin/sh
# Runs the device tests on a second driver: SwiftShader, which Debian's package chromium contains. Tolerances are
# the same as on the first driver.
#
# Skips with one line and exit status 77 if SwiftShader is missing. SPLITSUM_SECOND_DRIVER names another manifest
# (icd.json). Arguments go to the test binary: `sh scripts/second-driver.sh golden furnace` runs a part.
#
# Known limits of SwiftShader (from chromium 156); no tolerance hides them:
# - Vertices are rounded to 1/16 of a pixel (subPixelPrecisionBits 4, Vulkan's least; lavapipe has 8): edges of meshes
#   move by up to 1/32 pixel. tests/device/gbuffer.rs asks the device for its grid.
# - Compute shaders see black beyond the edges of a cube's faces: maps are octahedral here
#   (DeviceInfo::has_seamless_cubes).
# - Bits differ from lavapipe's. Tests compare bits between runs on one driver, never between drivers.
set -eu
cd "$(dirname "$0")/.."
. scripts/setup.sh

manifest=${SPLITSUM_SECOND_DRIVER:-}
for candidate in /usr/lib/chromium/vk_swiftshader_icd.json /usr/lib64/chromium-browser/vk_swiftshader_icd.json /opt/google/chrome/vk_swiftshader_icd.json; do
    [ -n "$manifest" ] || [ ! -e "$candidate" ] || manifest=$candidate
done
if [ -z "$manifest" ] || [ ! -e "$manifest" ]; then
    say "skipped: the device tests on a second driver (${manifest:-SwiftShader} is missing; Debian: apt-get install chromium)"
    exit 77
fi

say "device tests on a second driver: $manifest"
# VK_DRIVER_FILES would win over VK_ICD_FILENAMES where both are set.
unset VK_DRIVER_FILES
VK_ICD_FILENAMES=$manifest cargo run --release --locked --quiet -- devices
binary=$(test_binaries --test device | sed -n 's/^device //p')
[ -n "$binary" ] || stop "cargo names no test binary 'device'"
# A device that does not answer fails the tests here, where the driver is known to be there.
VK_ICD_FILENAMES=$manifest GOLDEN=require exec "$binary" "$@"
