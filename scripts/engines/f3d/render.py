"""Renders the spheres in F3D: VTK's physically based shading under F3D's own prefiltered map, offscreen.

Arguments: FOLDER of spheres.json, and the word `ours` for our bakes in its cache, which it then reads in place of its own.
"""
import hashlib
import math
import pathlib
import shutil
import sys

sys.path.insert(0, str(pathlib.Path(__file__).parents[1]))
from common import CANNOT_RUN, EXTENT, Spheres, check_version, stop, unit_sphere

check_version("f3d", "f3d")
import f3d
import numpy as np

# The shader takes the direction of view from the camera's position even in parallel projection, so the camera is far away. A
# lat-long map's centre is +x in its world, ours +z.
DISTANCE = 500
LEFT_OUT = {
    "coated": "no option sets a coat, and its reader of glTF drops it",
    "anisotropic": "no option sets anisotropy",
}
# Its picture has 8 bits of color^(1/2.2) and ends at 1. The option dims lights and map alike, so a pixel is the mean of the
# exposures that show it neither cut nor dark.
EXPOSURES = [2.0**-k for k in range(-5, 11)]
DARK, CUT = 100, 254


def add_sphere(scene):
    points, uvs, triangles = unit_sphere(96)
    flat = [values.astype(float).ravel().tolist() for values in (points, points, uvs)]
    scene.add(f3d.Mesh(*flat, [3] * len(triangles), triangles.ravel().tolist()))


def draw(engine, size):
    total, weights = np.zeros((size, size, 3)), np.zeros((size, size, 3))
    for exposure in EXPOSURES:
        engine.options["render.light.intensity"] = exposure
        image = engine.window.render_to_image()
        bits = np.frombuffer(image.content, np.uint8).reshape(size, size, -1)[::-1, :, :3]
        # Almost no weight for dark pixels: it counts where none is better.
        weight = np.where((bits >= DARK) & (bits <= CUT), 1, np.where(bits <= CUT, 1e-9 * bits / 255, 0))
        total += weight * (bits / 255) ** 2.2 / exposure
        weights += weight
    return total / np.maximum(weights, 1e-30)


def put_into_cache(bake, cache, map_path):
    """F3D looks a map up in its cache by the MD5 of the file."""
    digest = hashlib.md5(pathlib.Path(map_path).read_bytes()).hexdigest()
    shutil.copytree(bake, cache / digest)


spheres = Spheres("f3d", *sys.argv[1:])
try:
    engine = f3d.Engine.create_egl()
except RuntimeError as error:
    stop("f3d", f"cannot render offscreen here: {error}", CANNOT_RUN)
engine.window.size = (spheres.size, spheres.size)
cache = spheres.out / "cache"
engine.cache_path = str(cache)
engine.options.update({
    "render.hdri.ambient": True,
    "render.background.color": [0.0, 0.0, 0.0],
})
add_sphere(engine.scene)
# Five headlights shine beside the map. They go, not dimmed: see EXPOSURES.
engine.scene.remove_all_lights()
camera = engine.window.camera
camera.state = f3d.CameraState((DISTANCE, 0, 0), (0, 0, 0), (0, 1, 0), math.degrees(2 * math.atan(EXTENT / DISTANCE)))
for name in spheres.maps:
    if spheres.bakes:
        put_into_cache(spheres.bakes / name, cache, spheres.map_path(name, "hdr"))
    engine.options["render.hdri.file"] = spheres.map_path(name, "hdr")
    for sphere in spheres.of_map(name, LEFT_OUT):
        engine.options.update({
            # Colours are encoded with gamma 2.2.
            "model.color.rgb": [part ** (1 / 2.2) for part in sphere["base_color"]],
            "model.material.metallic": float(sphere["metallic"]),
            "model.material.roughness": float(sphere["roughness"]),
        })
        spheres.save(sphere, draw(engine, spheres.size))
