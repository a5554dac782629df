"""What the renderers in Blender share: the sphere, the camera, the light and the material."""
import bpy
import numpy as np
from common import EXTENT, unit_sphere

# Its lat-long maps have +x in the centre, ours -y (our +z).
ROTATION = np.pi / 2


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


def material(sphere, distribution):
    found = bpy.data.materials.new("material")
    found.use_nodes = True
    principled = found.node_tree.nodes["Principled BSDF"]
    principled.distribution = distribution
    values = {
        "Base Color": (*sphere["base_color"], 1), "Metallic": sphere["metallic"], "Roughness": sphere["roughness"], "IOR": 1.5,
        "Coat Weight": sphere.get("coat", 0), "Coat Roughness": sphere.get("coat_roughness", 0),
        "Anisotropic": sphere.get("anisotropy", 0),
    }
    for name, value in values.items():
        principled.inputs[name].default_value = value
    return found


def start(engine, size):
    """An empty scene with the sphere and the camera, whose pictures are linear EXR of `size` pixels a side."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.engine = engine
    scene.render.film_transparent, scene.render.use_persistent_data = True, True
    scene.render.resolution_x = scene.render.resolution_y = size
    scene.render.image_settings.file_format, scene.render.image_settings.color_depth = "OPEN_EXR", "32"
    scene.render.threads_mode, scene.render.threads = "FIXED", 2
    add_camera(scene)
    return scene, sphere_object()


def draw(spheres, scene, ball, distribution, leave_out=()):
    for name in spheres.maps:
        set_light(scene, spheres.map_path(name, "exr"))
        for sphere in spheres.of_map(name, leave_out):
            ball.data.materials.clear()
            ball.data.materials.append(material(sphere, distribution))
            scene.render.filepath = str(spheres.out / f"{sphere['name']}.exr")
            bpy.ops.render.render(write_still=True)
