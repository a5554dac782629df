"""Mitsuba renders a sphere: CPU seconds and relMSE of growing sample counts, as JSON. Arguments: MAP ALPHA SIDE COUNT..."""
import json
import sys
import time

import mitsuba as mi
import numpy as np

mi.set_variant("llvm_ad_rgb")
path, alpha, side, counts = sys.argv[1], float(sys.argv[2]), int(sys.argv[3]), [int(count) for count in sys.argv[4:]]
scene = mi.load_dict({
    "type": "scene",
    "integrator": {"type": "direct", "hide_emitters": True},
    "sensor": {
        "type": "orthographic",
        "to_world": mi.ScalarTransform4f().look_at(origin=[0, 0, 5], target=[0, 0, 0], up=[0, 1, 0]),
        "film": {"type": "hdrfilm", "width": side, "height": side, "rfilter": {"type": "box"}},
        "sampler": {"type": "multijitter"},
    },
    "light": {"type": "envmap", "filename": path},
    "ball": {
        "type": "sphere",
        "bsdf": {"type": "roughconductor", "distribution": "ggx", "alpha": alpha, "material": "none"},
    },
})


def render(count, seed):
    return np.array(mi.render(scene, spp=count, seed=seed))[..., :3].astype(np.float64)


# Pixels that lie on the sphere wholly, and the mean luminance of the map.
at = (np.arange(side) + 0.5) / side * 2 - 1
inside = np.hypot(*np.meshgrid(at, at)) < 1 - 2 / side
light = np.array(mi.Bitmap(path).convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32, False), dtype=np.float64)
weight = np.sin((np.arange(light.shape[0]) + 0.5) / light.shape[0] * np.pi)
mean = np.average(light.mean(axis=1) @ [0.2126, 0.7152, 0.0722], weights=weight)
truth = np.mean([render(4096, 100 + seed) for seed in range(2)], axis=0)
rows = []
for count in counts:
    render(count, 1)  # compiles
    before = time.process_time()
    image = render(count, 2)
    seconds = time.process_time() - before
    relmse = np.mean(((image - truth) ** 2 / (truth**2 + 0.01 * mean**2))[inside])
    rows.append({"count": count, "seconds": seconds, "relmse": relmse})
print(json.dumps({"version": mi.__version__, "rows": rows}))
