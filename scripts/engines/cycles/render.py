"""Renders the spheres in Blender's Cycles: its Principled BSDF with GGX.

Arguments: FOLDER of spheres.json.
"""
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).parents[1]))
from common import EXTENT, Spheres, check_version, unit_sphere

check_version("cycles", "bpy")
import bpy
import numpy as np

SAMPLES = 64


def sphere_object():
    """The unit sphere, turned to Blender's world with z up: our (x, y, z) is its (x, -z, y)."""
    points, uvs, triangles = unit_sphere(128)
    mesh = bpy.data.meshes.new("ball")
    turned = points[:, [0, 2, 1]] * [1, -1, 1]
    mesh.from_pydata(turned.tolist(), [], triangles.tolist())
    mesh.uv_layers.new().data.foreach_set("uv", uvs[triangles.reshape(-1)].astype(np.float32).ravel())
    mesh.normals_split_custom_set_from_vertices(turned.tolist())
    ball = bpy.data.objects.new("ball", mesh)
    bpy.context.collection.objects.link(ball)
    return ball


def add_camera(scene):
    data = bpy.data.cameras.new("camera")
    data.type, data.ortho_scale = "ORTHO", 2 * EXTENT
    camera = bpy.data.objects.new("camera", data)
    camera.location, camera.rotation_euler = (0, -5, 0), (np.pi / 2, 0, 0)
    bpy.context.collection.objects.link(camera)
    scene.camera = camera


def set_light(scene, path):
    world = bpy.data.worlds.new("world")
    world.use_nodes = True
    nodes, links = world.node_tree.nodes, world.node_tree.links
    image = nodes.new("ShaderNodeTexEnvironment")
    image.image = bpy.data.images.load(path)
    image.image.colorspace_settings.name = "Non-Color"
    mapping, position = nodes.new("ShaderNodeMapping"), nodes.new("ShaderNodeTexCoord")
    mapping.inputs["Rotation"].default_value = (0, 0, ROTATION)
    links.new(position.outputs["Generated"], mapping.inputs["Vector"])
    links.new(mapping.outputs["Vector"], image.inputs["Vector"])
    links.new(image.outputs["Color"], nodes["Background"].inputs["Color"])
    scene.world = world


def material(sphere):
    found = bpy.data.materials.new("material")
    found.use_nodes = True
    principled = found.node_tree.nodes["Principled BSDF"]
    # Single scattering, as in `reference` without --compensation.
    principled.distribution = "GGX"
    values = {
        "Base Color": (*sphere["base_color"], 1), "Metallic": sphere["metallic"], "Roughness": sphere["roughness"], "IOR": 1.5,
        "Coat Weight": sphere.get("coat", 0), "Coat Roughness": sphere.get("coat_roughness", 0),
        "Anisotropic": sphere.get("anisotropy", 0),
    }
    for name, value in values.items():
        principled.inputs[name].default_value = value
    return found


# Its lat-long maps have +x in the centre, ours -y (our +z).
ROTATION = np.pi / 2

spheres = Spheres("cycles", sys.argv[1])
bpy.ops.wm.read_factory_settings(use_empty=True)
scene = bpy.context.scene
scene.render.engine = "CYCLES"
scene.cycles.samples, scene.cycles.use_denoising, scene.cycles.use_adaptive_sampling = SAMPLES, False, False
scene.cycles.pixel_filter_type, scene.cycles.filter_width = "BOX", 1
scene.cycles.max_bounces, scene.cycles.blur_glossy = 1, 0
scene.cycles.sample_clamp_direct = scene.cycles.sample_clamp_indirect = 0
scene.render.film_transparent, scene.render.use_persistent_data = True, True
scene.render.resolution_x = scene.render.resolution_y = spheres.size
scene.render.image_settings.file_format, scene.render.image_settings.color_depth = "OPEN_EXR", "32"
scene.render.threads_mode, scene.render.threads = "FIXED", 2
ball = sphere_object()
add_camera(scene)
for name in spheres.maps:
    set_light(scene, spheres.map_path(name, "exr"))
    for sphere in spheres.of_map(name):
        ball.data.materials.clear()
        ball.data.materials.append(material(sphere))
        scene.render.filepath = str(spheres.out / f"{sphere['name']}.exr")
        bpy.ops.render.render(write_still=True)
