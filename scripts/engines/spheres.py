"""Writes the list of spheres that the engines render, spheres.json, and the maps that light them. run.sh calls it.

Every map is stored twice with equal values: NAME.hdr for engines that read Radiance files, NAME.exr for the rest. The
values are what RGBE holds, so no engine sees a finer map than another.
"""
import argparse
import json
import pathlib
import subprocess
import tempfile

import numpy as np
import OpenEXR

# Every material has F0 0.04 where it is not a metal. Roughness is a renderer's slider, the root of alpha; `coat_roughness`
# too. `anisotropy` is the engine's own strength, along the east of the sphere.
MATERIALS = {
    "metal": {"base_color": [1, 0.5, 0.2], "metallic": 1},
    "dielectric": {"base_color": [0, 0, 0], "metallic": 0},
    "plastic": {"base_color": [0.5, 0.2, 0.1], "metallic": 0},
    "coated": {"base_color": [0.5, 0.5, 0.5], "metallic": 1, "coat": 1, "coat_roughness": 0.3},
    "anisotropic": {"base_color": [1, 0.5, 0.2], "metallic": 1, "anisotropy": 0.7},
    "white": {"base_color": [1, 1, 1], "metallic": 1},
}
# `white` is drawn if it is asked for.
DEFAULT_MATERIALS = [name for name in MATERIALS if name != "white"]
ROUGHNESS = [0.1, 0.3, 0.5, 0.7, 1]
MAPS = ["marker", "constant", "studio"]


def directions(width, height):
    """Directions of the texels' centres: row 0 is up, the centre is +z, u = 0.25 is +x."""
    phi = 2 * np.pi * (0.5 - (np.arange(width) + 0.5) / width)
    theta = np.pi * (np.arange(height)[:, None] + 0.5) / height
    return np.stack(np.broadcast_arrays(np.sin(theta) * np.sin(phi), np.cos(theta), np.sin(theta) * np.cos(phi)), axis=-1)


def marker():
    """Six wide lights of different colours on grey, and a narrow one off every axis."""
    d = directions(256, 128)
    image = np.full(d.shape, 0.125)
    for axis in range(3):
        for sign, dim in [(1, 1), (-1, 8)]:
            color = np.full(3, float(dim))
            color[axis] = 9 - dim
            image[sign * d[..., axis] > 0.9] = color
    hot = np.array([0.35, 0.6, 0.72])
    image[d @ (hot / np.linalg.norm(hot)) > 0.99] = 60
    return image


def constant():
    return np.ones((64, 128, 3))


def studio(program):
    """The built-in studio: level 0 of a bake with a texel for each texel of the map."""
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder) / "bake"
        command = [program, "bake", "builtin:studio", "--out", str(out)]
        settings = ["layout=equirect", "prefilter_size=512x256", "prefilter_level_count=2", "brdf=ggx"]
        subprocess.run(command + [part for setting in settings for part in ("--set", setting)], check=True, stdout=subprocess.DEVNULL)
        return read_exr(out / "prefiltered_ggx_0.exr")


def read_exr(path):
    with OpenEXR.File(str(path)) as file:
        return np.array(file.channels()["RGB"].pixels if "RGB" in file.channels() else file.channels()["RGBA"].pixels[..., :3])


def rgbe(image):
    """Bytes of shared-exponent texels, rounded to the nearest value."""
    exponent = np.frexp(np.maximum(image.max(axis=-1), 1e-38))[1]
    digits = np.rint(np.ldexp(image, 8 - exponent[..., None]))
    exponent = np.where(digits.max(axis=-1) > 255, exponent + 1, exponent)
    digits = np.rint(np.ldexp(image, 8 - exponent[..., None]))
    return np.concatenate([digits, exponent[..., None] + 128], axis=-1).clip(0, 255).astype(np.uint8)


def write_map(folder, name, image):
    """Writes both forms of the map."""
    packed = rgbe(np.asarray(image, np.float64))
    height, width, _ = packed.shape
    head = f"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {height} +X {width}\n"
    # A row of one plane after another: a new-style row without runs, which every reader knows.
    rows = []
    for row in packed:
        rows.append(bytes([2, 2, width >> 8, width & 255]))
        for plane in row.T:
            for at in range(0, width, 128):
                part = plane[at:at + 128].tobytes()
                rows.append(bytes([len(part)]) + part)
    (folder / f"{name}.hdr").write_bytes(head.encode() + b"".join(rows))
    values = np.ldexp(packed[..., :3].astype(np.float32), packed[..., 3:].astype(np.int32) - 136)
    OpenEXR.File({"type": OpenEXR.scanlineimage}, {"RGB": values.astype(np.float32)}).write(str(folder / f"{name}.exr"))


def main():
    parser = argparse.ArgumentParser(prog="run.sh")
    parser.add_argument("out", type=pathlib.Path)
    parser.add_argument("--splitsum", required=True)
    parser.add_argument("--size", type=int, default=96)
    parser.add_argument("--map", action="append", default=[])
    parser.add_argument("--material", type=lambda text: text.split(","), default=DEFAULT_MATERIALS)
    parser.add_argument("--roughness", type=lambda text: [float(part) for part in text.split(",")], default=ROUGHNESS)
    arguments = parser.parse_args()
    unknown = sorted(set(arguments.material) - set(MATERIALS))
    if unknown:
        parser.error(f"material {unknown[0]!r} is not one of {', '.join(MATERIALS)}")
    if not all(0 < roughness <= 1 for roughness in arguments.roughness):
        parser.error("a roughness is above 0 and at most 1")
    folder = arguments.out / "maps"
    folder.mkdir(parents=True, exist_ok=True)
    makers = {"marker": marker, "constant": constant, "studio": lambda: studio(arguments.splitsum)}
    names = []
    for wanted in arguments.map or MAPS:
        name = wanted if wanted in makers else pathlib.Path(wanted).stem
        names.append(name)
        if not (folder / f"{name}.exr").exists():
            write_map(folder, name, makers[wanted]() if wanted in makers else read_map(parser, wanted))
    spheres = [
        {"name": f"{name}-{material}-{roughness:g}", "map": name, "material": material, "roughness": roughness, **MATERIALS[material]}
        for name in names for material in arguments.material for roughness in arguments.roughness
    ]
    listed = {"size": arguments.size, "maps": names, "spheres": spheres}
    (arguments.out / "spheres.json").write_text(json.dumps(listed, indent=1) + "\n")


def read_map(parser, path):
    try:
        image = read_exr(path)
    except Exception as error:  # OpenEXR raises its own kinds
        parser.error(f"{path}: expected marker, constant, studio or an .exr: {error}")
    if not (np.isfinite(image).all() and (image >= 0).all()):
        parser.error(f"{path}: has texels that are negative or not finite")
    return image


if __name__ == "__main__":
    main()
