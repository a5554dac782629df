#!/bin/sh
# SAPIEN 3.0.3 (PyPI): RenderCubemap of six images and its prefilter, on Chromium's SwiftShader.
# Guess: a sky of tiles, half of them black and half white, lights a rough mirror like a sky of grey 0.5,
#   so a white metal of roughness 1 has half the radiance that it has under a white sky.
# Seen: it has 0.22 of it. The filter reads and writes the bytes as they are and takes means of sRGB codes; the
#   lookup then decodes the mean: the code 0.5 is a radiance of 0.21.
#   Under lamps of 1 on grey of 1/64 the levels keep 61 to 75 % of the light.
# Hurt: rough surfaces are too dark under every image with contrast, and robots learn from such pictures.
# Avoid: filter the map elsewhere, and load a KTX with its levels, sRGB codes too.
set -eu
t=$(mktemp -d)
trap 'rm -rf "$t"' EXIT
for icd in "${VK_ICD_FILENAMES:-}" /usr/lib/chromium/vk_swiftshader_icd.json /opt/google/chrome/vk_swiftshader_icd.json; do
    [ ! -f "$icd" ] || break
done
[ -f "$icd" ] || { echo "needs Chromium's SwiftShader, or VK_ICD_FILENAMES"; exit 77; }
python3 -m venv "$t/v"
"$t/v/bin/python" -m pip -q --disable-pip-version-check install \
    sapien==3.0.3 numpy==2.4.6 opencv-python==5.0.0.93 || exit 77
cat >"$t/draw.py" <<'P'
import sys
import cv2
import numpy as np
import sapien
from sapien import render

SIDE, SIZE = 32, 32


def picture(name, face):
    files = [f"{sys.argv[1]}/{name}{k}.png" for k in range(6)]
    for file in files:
        cv2.imwrite(file, np.repeat(face[..., None], 3, axis=2))
    scene = sapien.Scene()
    scene.set_ambient_light([0, 0, 0])
    scene.set_environment_map(render.RenderCubemap(*files))
    builder = scene.create_actor_builder()
    material = render.RenderMaterial(base_color=[1, 1, 1, 1], metallic=1, roughness=1)
    builder.add_sphere_visual(radius=1, material=material)
    builder.build_static()
    camera = scene.add_camera("camera", SIZE, SIZE, 1, 0.1, 10)
    camera.set_orthographic_parameters(0.1, 10, 1.05)
    camera.entity.set_pose(sapien.Pose([0, 5, 0], [np.sqrt(0.5), 0, 0, -np.sqrt(0.5)]))
    scene.update_render()
    camera.take_picture()
    middle = camera.get_picture("Lighting")[SIZE // 4:-SIZE // 4, SIZE // 4:-SIZE // 4, :3]
    return middle.mean()


render.set_camera_shader_dir("default")
tiles = 255 * (np.add.outer(np.arange(SIDE) // 4, np.arange(SIDE) // 4) % 2).astype(np.uint8)
share = picture("tiles", tiles) / picture("white", np.full_like(tiles, 255))
print(f"half the sky white: {share:.2f} of the radiance under a white sky; half is right")
sys.exit(not share < 0.35)
P
VK_ICD_FILENAMES=$icd "$t/v/bin/python" "$t/draw.py" "$t" 2>"$t/log" || {
    code=$?
    tail -3 "$t/log"
    exit $code
}
# half the sky white: 0.22 of the radiance under a white sky; half is right
