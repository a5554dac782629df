#!/bin/sh
# bpy 5.2.3 (PyPI): EEVEE under a world image, defaults of the world and of the renderer.
# Guess: two lamps in an environment map show as two highlights on a rough mirror, each where Cycles shows it.
# Seen: the brightest highlight lies between them, where the map is dark: 60 for 6.5 at each. All light
#   above the world's sun_threshold of 10 leaves the map and makes one sun, in the mean direction of what left. The two
#   highlights keep what is below. A single lamp stays at its place.
# Hurt: interiors and studios, whose maps have several lamps above 10: the key light of the picture comes from a place
#   without a lamp, with a shadow to match; comparisons of EEVEE and Cycles.
# Avoid: a map whose lamps are below 10 and area lights for them. A higher sun_threshold alone loses the light: the
#   world is clamped at 10 too (clamp_surface_indirect).
set -eu
t=$(mktemp -d)
trap 'rm -rf "$t"' EXIT
cd "$t"
python=$(command -v python3.13) || exit 77
"$python" -m venv v 2>/dev/null || exit 77
v/bin/python -m pip -q --disable-pip-version-check install bpy==5.2.3 || exit 77
cat >draw.py <<'P'
import os
os.environ.pop("DISPLAY", None)
os.environ.setdefault("EGL_PLATFORM", "surfaceless")
import bpy
import numpy as np
SIZE, WIDTH, HEIGHT = 64, 128, 64
LAMPS = np.array([[0.7, 0.1, 0.7], [-0.6, 0.3, 0.74]])
LAMPS /= np.linalg.norm(LAMPS, axis=1)[:, None]
phi = 2 * np.pi * (0.5 - (np.arange(WIDTH) + 0.5) / WIDTH)
theta = np.pi * (np.arange(HEIGHT)[:, None] + 0.5) / HEIGHT
# Right, up, towards the viewer.
d = np.stack(np.broadcast_arrays(np.sin(theta) * np.sin(phi), np.cos(theta), np.sin(theta) * np.cos(phi)), -1)
bpy.ops.wm.read_factory_settings(use_empty=True)
scene = bpy.context.scene
scene.render.engine = "BLENDER_EEVEE"
scene.eevee.taa_render_samples, scene.render.filter_size = 2, 0
scene.render.resolution_x = scene.render.resolution_y = SIZE
scene.render.image_settings.file_format, scene.render.image_settings.color_depth = "OPEN_EXR", "32"
camera = bpy.data.cameras.new("camera")
camera.type, camera.ortho_scale = "ORTHO", 2
scene.camera = bpy.data.objects.new("camera", camera)
scene.camera.location, scene.camera.rotation_euler = (0, -5, 0), (np.pi / 2, 0, 0)
bpy.context.collection.objects.link(scene.camera)
bpy.ops.mesh.primitive_uv_sphere_add(segments=256, ring_count=128)
ball = bpy.context.object
bpy.ops.object.shade_smooth()
metal = bpy.data.materials.new("metal")
metal.use_nodes = True
for name, value in {"Base Color": (1, 1, 1, 1), "Metallic": 1, "Roughness": 0.3}.items():
    metal.node_tree.nodes["Principled BSDF"].inputs[name].default_value = value
ball.data.materials.append(metal)


def light(lamps):
    pixels = np.full((HEIGHT, WIDTH, 4), 0.125, np.float32)
    pixels[(d @ lamps.T > 0.99).any(-1), :3] = 60
    image = bpy.data.images.new("map", WIDTH, HEIGHT, float_buffer=True)
    image.colorspace_settings.name = "Non-Color"
    image.pixels.foreach_set(pixels[::-1].ravel())
    world = bpy.data.worlds.new("world")
    world.use_nodes = True
    nodes, links = world.node_tree.nodes, world.node_tree.links
    texture, mapping, place = (nodes.new(f"ShaderNode{kind}") for kind in ("TexEnvironment", "Mapping", "TexCoord"))
    texture.image = image
    # The middle of a map is +x in Blender; here it looks at the viewer, -y.
    mapping.inputs["Rotation"].default_value = (0, 0, np.pi / 2)
    links.new(place.outputs["Generated"], mapping.inputs["Vector"])
    links.new(mapping.outputs["Vector"], texture.inputs["Vector"])
    links.new(texture.outputs["Color"], nodes["Background"].inputs["Color"])
    scene.world = world


def seen(direction):
    """The largest of 3x3 pixels whose mirror direction this is."""
    half = direction + [0, 0, 1]
    x, y = half[:2] / np.linalg.norm(half)
    column, row = int((x + 1) / 2 * SIZE), int((1 - y) / 2 * SIZE)
    return picture[row - 1:row + 2, column - 1:column + 2].max()


between = LAMPS.sum(axis=0) / np.linalg.norm(LAMPS.sum(axis=0))
print("threshold", scene.eevee.clamp_surface_indirect, bpy.data.worlds.new("w").sun_threshold)
for name, lamps in [("one lamp", LAMPS[:1]), ("two lamps", LAMPS)]:
    light(lamps)
    scene.render.filepath = os.path.abspath("out.exr")
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(scene.render.filepath, check_existing=False)
    image.colorspace_settings.name = "Non-Color"
    picture = np.array(image.pixels[:]).reshape(SIZE, SIZE, -1)[::-1, :, 0]
    print(f"{name}: at the first {seen(LAMPS[0]):.1f}, at the second {seen(LAMPS[1]):.1f}, between {seen(between):.1f}")
P
v/bin/python draw.py 2>log | grep -E '^(threshold|one|two)' >seen || { echo "EEVEE cannot draw here"; exit 77; }
cat seen
awk '/^one/ {one = ($6 > 10 * $12)} /^two/ {two = ($12 > 4 * $6 && $12 > 4 * $10)} END {exit !(one && two)}' FS='[ ,]+' seen ||
    { echo "CHANGED: two lamps no longer make one sun between them"; exit 1; }
echo "still so: the light of two lamps shows between them"
