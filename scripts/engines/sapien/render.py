"""Renders the spheres in SAPIEN: its rasterizer's default shaders under its own prefiltered cube.

Arguments: FOLDER of spheres.json, and the word `ours` for our bakes in place of its own. Needs a Vulkan driver that SAPIEN accepts:
Chromium's SwiftShader, or VK_ICD_FILENAMES.
"""
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).parents[1]))
from common import CANNOT_RUN, EXTENT, SAPIEN_BRIGHTEST as BRIGHTEST, Spheres, check_version, read_hdr, stop, use_swiftshader, write_sphere

check_version("sapien", "sapien")
use_swiftshader("sapien")
import cv2
import numpy as np
import sapien
from sapien import render

# Its cube has 8 bits of sRGB that end at 1. An .exr it holds as half floats, but its filter writes bytes into them and cuts every
# sample at 1.
SIDE = 128
# The shader takes the direction of view from the camera's position even in parallel projection, so the camera is far away.
DISTANCE = 500
LEFT_OUT = {"coated": "its material has no coat", "anisotropic": "its material has one roughness"}


def face_directions():
    """Cube directions of the texels, faces in the order +x -x +y -y +z -z, rows from the top."""
    b, a = np.meshgrid(*[(2 * np.arange(SIDE) + 1) / SIDE - 1] * 2, indexing="ij")
    one = np.ones_like(a)
    faces = [(one, -b, -a), (-one, -b, a), (a, one, b), (a, -one, -b), (a, -b, one), (-a, -b, -one)]
    found = np.stack([np.stack(face, axis=-1) for face in faces])
    return found / np.linalg.norm(found, axis=-1, keepdims=True)


def cube_of(name, image, folder):
    """Writes the map as six PNG; returns their names, by which SAPIEN caches cubes. They mirror z against ours."""
    x, y, z = np.moveaxis(face_directions() * [1, 1, -1], -1, 0)
    height, width, _ = image.shape
    column = (0.5 - np.arctan2(x, z) / (2 * np.pi)) * width - 0.5
    row = np.arccos(y) / np.pi * height - 0.5
    texels = (bilinear(image, column, row) / BRIGHTEST).clip(0, 1)
    coded = np.where(texels < 0.0031308, 12.92 * texels, 1.055 * np.maximum(texels, 1e-9) ** (1 / 2.4) - 0.055)
    names = []
    for k, face in enumerate(np.rint(255 * coded).astype(np.uint8)):
        names.append(str(folder / f"{name}-{k}.png"))
        cv2.imwrite(names[-1], face[..., ::-1])
    return names


def bilinear(image, column, row):
    height, width, _ = image.shape
    left, top = np.floor(column).astype(int), np.floor(row).astype(int)
    right, down = (column - left)[..., None], (row - top)[..., None]
    at = lambda y, x: image[np.clip(y, 0, height - 1), x % width]
    above = at(top, left) * (1 - right) + at(top, left + 1) * right
    below = at(top + 1, left) * (1 - right) + at(top + 1, left + 1) * right
    return above * (1 - down) + below * down


def say_what_is_cut(name, image):
    weights = np.sin((np.arange(len(image)) + 0.5) / len(image) * np.pi)[:, None, None]
    share = 1 - (weights * image.clip(0, BRIGHTEST)).sum() / (weights * image).sum()
    if share > 0:
        print(f"sapien: {name}: light above {BRIGHTEST} is cut, {100 * share:.0f} % of all light")


def draw(cubemap, mesh, sphere, size):
    scene = sapien.Scene()
    scene.set_ambient_light([0, 0, 0])
    scene.set_environment_map(cubemap)
    material = render.RenderMaterial(
        base_color=[*sphere["base_color"], 1], metallic=sphere["metallic"], roughness=sphere["roughness"],
        specular=0.5,  # F0 0.04
    )
    builder = scene.create_actor_builder()
    # Its own sphere has too few triangles: the rim of a dielectric is 2 % brighter.
    builder.add_visual_from_file(str(mesh), material=material)
    builder.build_static()
    camera = scene.add_camera("camera", size, size, 1, 0.1, 10)
    camera.set_orthographic_parameters(DISTANCE - 2, DISTANCE + 2, EXTENT)
    # Its world has z up: ours at +z is its -y. A camera looks along its own +x.
    camera.entity.set_pose(sapien.Pose([0, -DISTANCE, 0], [np.sqrt(0.5), 0, 0, np.sqrt(0.5)]))
    scene.update_render()
    camera.take_picture()
    # What its shading writes, before the tone curve.
    return camera.get_picture("Lighting")[..., :3] * BRIGHTEST


spheres = Spheres("sapien", *sys.argv[1:])
render.set_camera_shader_dir("default")
try:
    sapien.Scene()
except RuntimeError as error:
    stop("sapien", f"cannot render here: {error}", CANNOT_RUN)
mesh = spheres.out / "sphere.obj"
write_sphere(mesh)
for name in spheres.maps:
    image = read_hdr(spheres.map_path(name, "hdr"))
    say_what_is_cut(name, image)
    if spheres.bakes:
        cubemap = render.RenderCubemap(str(spheres.bakes / name / "environment.ktx"))
    else:
        cubemap = render.RenderCubemap(*cube_of(name, image, spheres.out))
        cubemap.export(str(spheres.out / f"{name}.ktx"))
    for sphere in spheres.of_map(name, LEFT_OUT):
        spheres.save(sphere, draw(cubemap, mesh, sphere, spheres.size))
