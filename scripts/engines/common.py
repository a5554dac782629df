"""What the renderers in Python share: the list of spheres, the pinned version, a mesh, and images as PFM."""
import json
import os
import pathlib
import sys
from importlib.metadata import PackageNotFoundError, version

import numpy as np

# The orthographic image shows the square [-EXTENT, EXTENT]² of a unit sphere, as `splitsum render` does.
EXTENT = 1.05
CANNOT_RUN = 77
SWIFTSHADER = ["/usr/lib/chromium/vk_swiftshader_icd.json", "/opt/google/chrome/vk_swiftshader_icd.json"]
# SAPIEN's cubes end at 1, so the light is dimmed and the picture brightened: light above this is cut.
SAPIEN_BRIGHTEST = 8


def stop(engine, why, code=2):
    print(f"{engine}: {why}", file=sys.stderr)
    raise SystemExit(code)


def check_version(engine, package):
    """Stops unless `package` has the version that the engine's requirements.txt pins."""
    lines = (pathlib.Path(__file__).parent / engine / "requirements.txt").read_text().splitlines()
    pinned = dict(line.split("==") for line in lines if "==" in line)[package]
    try:
        found = version(package)
    except PackageNotFoundError:
        stop(engine, f"the package {package} {pinned} is not installed", CANNOT_RUN)
    if found != pinned:
        stop(engine, f"expected {package} {pinned}, found {found}: install scripts/engines/{engine}/requirements.txt")


class Spheres:
    """The list that spheres.py wrote: `maps` by name, and one sphere a map, material and roughness.

    With the word `ours`, `bakes` has a folder a map: a bake of splitsum that the engine draws in place of its own.
    """

    def __init__(self, engine, folder, ours=None):
        self.engine, self.folder = engine, pathlib.Path(folder)
        listed = json.loads((self.folder / "spheres.json").read_text())
        self.size, self.maps, self.spheres = listed["size"], listed["maps"], listed["spheres"]
        self.bakes = self.folder / "bakes" / engine if ours else None
        self.out = self.folder / (f"{engine}-ours" if ours else engine)
        self.out.mkdir(exist_ok=True)

    def map_path(self, name, form):
        return str(self.folder / "maps" / f"{name}.{form}")

    def of_map(self, name, leave_out=()):
        """The spheres under the map, without the materials that the engine lacks; says which those are."""
        found = [sphere for sphere in self.spheres if sphere["map"] == name]
        for material in sorted({sphere["material"] for sphere in found} & set(leave_out)):
            print(f"{self.engine}: leaves out {material} under {name}: {leave_out[material]}")
        return [sphere for sphere in found if sphere["material"] not in leave_out]

    def save(self, sphere, image):
        """Writes linear RGB, first row at the top."""
        write_pfm(self.out / f"{sphere['name']}.pfm", image)


def write_pfm(path, image):
    """Writes linear RGB, float32, first row at the top."""
    height, width, _ = image.shape
    rows = np.ascontiguousarray(image[::-1], dtype="<f4")
    path.write_bytes(f"PF\n{width} {height}\n-1.0\n".encode() + rows.tobytes())


def use_swiftshader(engine):
    """Selects Chromium's Vulkan driver unless one is named: SAPIEN refuses Mesa's lavapipe up to 22.3."""
    if "VK_ICD_FILENAMES" in os.environ:
        return
    found = [path for path in SWIFTSHADER if os.path.exists(path)]
    if not found:
        stop(engine, "needs a Vulkan driver that it accepts: install Chromium or set VK_ICD_FILENAMES", CANNOT_RUN)
    os.environ["VK_ICD_FILENAMES"] = found[0]


def read_pfm(path):
    """Linear RGB, float32, first row at the top."""
    _, size, scale, texels = path.read_bytes().split(b"\n", 3)
    width, height = map(int, size.split())
    order = "<f4" if float(scale) < 0 else ">f4"
    return np.frombuffer(texels, order).reshape(height, width, 3)[::-1].astype(np.float32)


def read_hdr(path):
    """Linear RGB, float32, of a Radiance file as spheres.py writes it: rows of planes without runs."""
    head, body = pathlib.Path(path).read_bytes().split(b"+X ", 1)
    height = int(head.rsplit(b"-Y ", 1)[1])
    width, body = body.split(b"\n", 1)
    width = int(width)
    lengths = [min(128, width - at) for at in range(0, width, 128)]
    is_value = np.concatenate([[False] * 4] + [[False] + [True] * length for length in lengths * 4])
    rows = np.frombuffer(body, np.uint8).reshape(height, -1)[:, is_value].reshape(height, 4, width)
    digits, exponent = np.moveaxis(rows[:, :3], 1, -1), rows[:, 3, :, None]
    return np.ldexp(digits.astype(np.float32), exponent.astype(np.int32) - 136)


def unit_sphere(bands):
    """Positions, UV coordinates and triangles of a sphere about +y, `bands` from pole to pole; normals equal positions.

    u grows to the east, from +z over +x.
    """
    v, u = np.meshgrid(np.linspace(0, 1, bands + 1), np.linspace(0, 1, 2 * bands + 1), indexing="ij")
    theta, phi = np.pi * v, 2 * np.pi * u
    points = np.stack([np.sin(theta) * np.sin(phi), np.cos(theta), np.sin(theta) * np.cos(phi)], axis=-1)
    corner = np.arange(bands)[:, None] * (2 * bands + 1) + np.arange(2 * bands)
    below = corner + 2 * bands + 1
    quads = [[corner, below, below + 1], [corner, below + 1, corner + 1]]
    triangles = np.concatenate([np.stack(quad, axis=-1).reshape(-1, 3) for quad in quads])
    return points.reshape(-1, 3), np.stack([u, 1 - v], axis=-1).reshape(-1, 2), triangles


def write_sphere(path, bands=128):
    """Writes `unit_sphere` as OBJ."""
    points, uvs, triangles = unit_sphere(bands)
    lines = [f"v {x} {y} {z}" for x, y, z in points] + [f"vt {u} {v}" for u, v in uvs] + [f"vn {x} {y} {z}" for x, y, z in points]
    lines += ["f " + " ".join(f"{i}/{i}/{i}" for i in triangle + 1) for triangle in triangles]
    path.write_text("\n".join(lines) + "\n")
