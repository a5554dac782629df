"""Renders the spheres in Mitsuba 3: its `principled` material, whose metal has Schlick's Fresnel factor as ours does.

Arguments: FOLDER of spheres.json.
"""
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).parents[1]))
from common import EXTENT, Spheres, check_version

check_version("mitsuba", "mitsuba")
import mitsuba as mi
import numpy as np

# The variant for LLVM cannot compile `principled` with the LLVM 15 of Debian 12 on CPUs with AVX-512.
mi.set_variant("scalar_rgb")
SAMPLES = 132
LEFT_OUT = {
    "coated": "its coat is Disney's (GTR 1, a quarter of the weight), not a second lobe over the base",
}


def light(path):
    """Mitsuba's first and last rows lie on the poles. Twice the rows and one more reproduce our bilinear map."""
    image = np.array(mi.Bitmap(path).convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32, False))
    height = len(image)
    row = np.clip((np.arange(2 * height + 1) - 1) / 2, 0, height - 1)
    low = np.floor(row).astype(int)
    share = (row - low)[:, None, None]
    resampled = image[low] * (1 - share) + image[np.minimum(low + 1, height - 1)] * share
    return {"type": "envmap", "bitmap": mi.Bitmap(resampled.astype(np.float32))}


def material(sphere):
    return {
        "type": "principled",
        "base_color": {"type": "rgb", "value": sphere["base_color"]},
        "metallic": float(sphere["metallic"]),
        "roughness": sphere["roughness"],
        "anisotropic": sphere.get("anisotropy", 0.0),
        "specular": 0.5,
    }


def scene(sphere, size, emitter):
    t = mi.ScalarTransform4f()
    return mi.load_dict({
        "type": "scene",
        "integrator": {"type": "direct", "hide_emitters": True},
        "sensor": {
            "type": "orthographic",
            "to_world": t.look_at(origin=[0, 0, 5], target=[0, 0, 0], up=[0, 1, 0]) @ t.scale([EXTENT, EXTENT, 1]),
            # One ray through each pixel's centre is ours; a box filter over the pixel is the nearest that Mitsuba has.
            "film": {"type": "hdrfilm", "width": size, "height": size, "rfilter": {"type": "box"}},
            "sampler": {"type": "multijitter"},
        },
        "light": emitter,
        # Its tangent runs about its own z axis, here +y.
        "ball": {"type": "sphere", "to_world": t.rotate([1, 0, 0], -90), "bsdf": material(sphere)},
    })


spheres = Spheres("mitsuba", sys.argv[1])
for name in spheres.maps:
    emitter = light(spheres.map_path(name, "exr"))
    for sphere in spheres.of_map(name, LEFT_OUT):
        image = np.array(mi.render(scene(sphere, spheres.size, emitter), spp=SAMPLES, seed=1))
        spheres.save(sphere, image[..., :3])
