"""Writes what Cycles' planes show of constant light of radiance 1: tests/golden/cycles_multiscatter.csv, metals of many F0 by
Multiscatter GGX, or tests/golden/cycles_dielectric.csv, black dielectrics of some indices by GGX.

    python3.13 -m venv VENV && VENV/bin/pip install -r scripts/engines/cycles/requirements.txt
    VENV/bin/python scripts/engines/cycles/planes.py metal > tests/golden/cycles_multiscatter.csv
    VENV/bin/python scripts/engines/cycles/planes.py dielectric > tests/golden/cycles_dielectric.csv

A row is a channel of the mean of 16x16 pixels. The plane fills the picture of an orthographic camera, so n.v is one number.
"""
import os
import pathlib
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).parents[1]))
from common import check_version

check_version("cycles", "bpy")
import bpy
import numpy as np

SAMPLES, SIZE = 1024, 16
ROUGHNESS = [0.2, 0.4, 0.6, 0.8, 1]
# Ten colours of three values: thirty F0 from 0.02 to 1.
F0 = np.linspace(0.02, 1, 30).reshape(3, 10).T.round(4)
IOR = [1.2, 1.33, 1.5, 1.8, 2.4]
N_DOT_V = [0.9, 0.3]


def scene_of_a_plane(is_metal):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.cycles.samples, scene.cycles.use_denoising, scene.cycles.use_adaptive_sampling = SAMPLES, False, False
    scene.cycles.max_bounces, scene.cycles.blur_glossy = 1, 0
    scene.cycles.sample_clamp_direct = scene.cycles.sample_clamp_indirect = 0
    scene.render.use_persistent_data = True
    scene.render.resolution_x = scene.render.resolution_y = SIZE
    scene.render.image_settings.file_format, scene.render.image_settings.color_depth = "OPEN_EXR", "32"
    scene.render.threads_mode, scene.render.threads = "FIXED", 2
    world = bpy.data.worlds.new("white")
    world.use_nodes = True
    world.node_tree.nodes["Background"].inputs["Color"].default_value = (1, 1, 1, 1)
    scene.world = world
    bpy.ops.mesh.primitive_plane_add(size=200)
    plane = bpy.context.object
    data = bpy.data.cameras.new("camera")
    data.type, data.ortho_scale = "ORTHO", 1
    camera = bpy.data.objects.new("camera", data)
    camera.location = (0, 0, 50)
    bpy.context.collection.objects.link(camera)
    scene.camera = camera
    metal = bpy.data.materials.new("metal")
    metal.use_nodes = True
    principled = metal.node_tree.nodes["Principled BSDF"]
    principled.distribution = "MULTI_GGX" if is_metal else "GGX"
    principled.inputs["Metallic"].default_value = float(is_metal)
    principled.inputs["Base Color"].default_value = (0, 0, 0, 1)
    plane.data.materials.append(metal)
    return scene, plane, principled.inputs


def radiance(scene, path):
    """The mean of the picture, RGB."""
    scene.render.filepath = path
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(path)
    mean = np.array(image.pixels[:]).reshape(-1, 4).mean(axis=0)[:3]
    bpy.data.images.remove(image)
    return mean


def rows(is_metal, inputs, shown):
    """F0 or index, and radiance, of every plane."""
    if is_metal:
        for color in F0:
            inputs["Base Color"].default_value = (*color, 1)
            yield from zip(color, shown())
    else:
        for ior in IOR:
            inputs["IOR"].default_value = ior
            yield ior, shown()[0]


if sys.argv[1:] not in (["metal"], ["dielectric"]):
    sys.exit("usage: planes.py metal|dielectric")
is_metal = sys.argv[1] == "metal"
# Blender reports each picture on standard output; the table is written to the stream that it had before.
table = os.fdopen(os.dup(1), "w")
os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
scene, plane, inputs = scene_of_a_plane(is_metal)
print(f"{'f0' if is_metal else 'ior'},perceptual_roughness,n_dot_v,radiance", file=table)
with tempfile.TemporaryDirectory() as folder:
    for n_dot_v in N_DOT_V:
        plane.rotation_euler = (np.arccos(n_dot_v), 0, 0)
        for roughness in ROUGHNESS:
            inputs["Roughness"].default_value = roughness
            for value, radiance_of_plane in rows(is_metal, inputs, lambda: radiance(scene, f"{folder}/plane.exr")):
                print(f"{value:g},{roughness:g},{n_dot_v:g},{radiance_of_plane:.6f}", file=table)
