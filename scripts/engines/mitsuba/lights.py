"""Compares direct lights of `splitsum render` with Mitsuba's directional, point and spot emitters. Argument: the program.

Mitsuba's integrator follows one ray through the centre of each pixel, as the program does. A light without size has one
direction, so neither picture has noise. The material is `roughconductor` without a Fresnel factor.
"""
import math
import pathlib
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).parents[1]))
from common import EXTENT, check_version

check_version("mitsuba", "mitsuba")
import mitsuba as mi
import numpy as np

mi.set_variant("scalar_rgb")
SIDE = 64
ALPHAS = (0.08, 0.3, 0.7)
MODELS = ("ggx", "beckmann")
# Largest relative difference of a pixel.
LIMIT = 5e-3
# Darker pixels, as a share of the brightest, and views nearer to grazing are left out: f32 has few digits there.
DARKEST = 1e-4
LEAST_N_DOT_V = 0.02
INNER_DEG, OUTER_DEG = 14, 24

DIRECTIONAL = (((0, -1, -1), 1), ((1.5, 0.5, -0.7), 12))
POINTS = (((1.2, 0.8, 1.6), 3), ((-0.5, 0.3, 1.1), 0.02), ((4, -7, 2), 900), ((0, 1.01, 0.4), 0.5))
SPOTS = (((0.5, 1.5, 3), (-0.2, -1.4, -2.6), 40), ((-2, 0.2, 1), (2, 0, -0.4), 6))


def unit(vector):
    return np.array(vector) / np.linalg.norm(vector)


def text(vector):
    return ",".join(map(str, vector))


class Light:
    """A light as both programs take it."""

    def __init__(self, name, option, emitter, cone=None):
        self.name, self.option, self.emitter, self.cone = name, option, emitter, cone


def lights():
    for direction, power in DIRECTIONAL:
        option = f"directional:direction={text(direction)}:intensity={power}"
        emitter = {"type": "directional", "direction": list(direction), "irradiance": power}
        yield Light(f"directional along {text(direction)}", option, emitter)
    for position, power in POINTS:
        option = f"point:position={text(position)}:intensity={power}"
        yield Light(f"point at {text(position)}", option, {"type": "point", "position": list(position), "intensity": power})
    for position, direction, power in SPOTS:
        option = (
            f"spot:position={text(position)}:direction={text(direction)}:intensity={power}"
            f":inner_deg={INNER_DEG}:outer_deg={OUTER_DEG}"
        )
        target = [a + b for a, b in zip(position, direction)]
        emitter = {
            "type": "spot",
            "to_world": mi.ScalarTransform4f().look_at(origin=list(position), target=target, up=[0, 1, 0.01]),
            "intensity": power,
            "beam_width": INNER_DEG,
            "cutoff_angle": OUTER_DEG,
        }
        yield Light(f"spot at {text(position)}", option, emitter, (position, direction))


def ours(program, light, model, alpha, folder):
    """Linear red and the mask."""
    path = pathlib.Path(folder) / "ours.exr"
    options = ["--method=reference", "--samples=8", "--environment=builtin:constant:radiance=0", "--scene=sphere"]
    surface = [f"--brdf={model}", f"--alpha={alpha}", "--f0=1", "--albedo=0", "--diffuse=none"]
    command = [program, "render", *options, *surface, f"--size={SIDE}x{SIDE}", f"--light={light.option}", f"--out={path}"]
    subprocess.run(command, check=True, capture_output=True)
    # Beside RGBA the file has the standard error of a reference.
    bitmap = mi.Bitmap(str(path))
    names = [field.name for field in bitmap.struct_()]
    image = np.array(bitmap, dtype=np.float64)
    return image[..., names.index("R")], image[..., names.index("A")] > 0


def centres():
    """x and y of the pixels' centres; the first row is at the top."""
    at = ((np.arange(SIDE) + 0.5) / SIDE * 2 - 1) * EXTENT
    return np.meshgrid(at, -at)


def mitsubas(light, model, alpha):
    bsdf = {"type": "roughconductor", "distribution": model, "alpha": alpha, "material": "none"}
    scene = mi.load_dict({"type": "scene", "light": light.emitter, "ball": {"type": "sphere", "bsdf": bsdf}})
    integrator = mi.load_dict({"type": "direct", "hide_emitters": True})
    sampler = mi.load_dict({"type": "independent"})
    image = np.zeros((SIDE, SIDE))
    for (row, column), x in np.ndenumerate(centres()[0]):
        ray = mi.RayDifferential3f(mi.Ray3f(o=[x, centres_y[row, column], 5], d=[0, 0, -1]))
        radiance, is_hit, _ = integrator.sample(scene, sampler, ray)
        image[row, column] = radiance[0] if is_hit else 0
    return image


def off_axis_deg(cone):
    """Angle from the spot's axis of the point under each pixel."""
    position, direction = cone
    x, y = centres()
    z = np.sqrt(np.maximum(1 - x**2 - y**2, 0))
    to_point = np.stack([x, y, z], axis=-1) - np.array(position)
    cosine = to_point @ unit(direction) / np.linalg.norm(to_point, axis=-1)
    return np.degrees(np.arccos(np.clip(cosine, -1, 1)))


def report(light, model, alpha, image, truth, mask):
    """The largest difference of a pixel; of a spot, inside its inner cone."""
    x, y = centres()
    is_counted = mask & (truth > DARKEST * truth.max()) & (1 - x**2 - y**2 > LEAST_N_DOT_V**2)
    is_even = is_counted
    edge = ""
    if light.cone:
        angle = off_axis_deg(light.cone)
        is_even = is_counted & (angle < INNER_DEG)
        is_edge = mask & (angle > INNER_DEG) & (angle < OUTER_DEG) & (truth > 0)
        ratio = (image / np.where(is_edge, truth, 1))[is_edge]
        if ratio.size:
            edge = f", edge {ratio.min():.2f} to {ratio.max():.2f} times Mitsuba's"
    worst = np.max(np.abs(image / np.where(is_even, truth, 1) - 1)[is_even])
    print(f"{light.name}, {model}, alpha {alpha}: {is_even.sum()} pixels, at most {100 * worst:.4f} %{edge}")
    return worst


centres_y = centres()[1]
largest = 0
with tempfile.TemporaryDirectory() as folder:
    for light in lights():
        for model in MODELS:
            for alpha in ALPHAS:
                image, mask = ours(sys.argv[1], light, model, alpha, folder)
                largest = max(largest, report(light, model, alpha, image, mitsubas(light, model, alpha), mask))
is_equal = math.isfinite(largest) and largest <= LIMIT
print(f"largest difference of a pixel: {100 * largest:.4f} %")
sys.exit(0 if is_equal else 1)
