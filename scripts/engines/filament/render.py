"""Renders the spheres in Filament, as Open3D ships it: Vulkan without a display, a linear picture.

Arguments: FOLDER of spheres.json.
"""
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).parents[1]))
from common import CANNOT_RUN, EXTENT, Spheres, check_version, stop, unit_sphere

check_version("filament", "open3d-cpu")
import numpy as np
import open3d as o3d
from open3d.visualization import rendering

# At this intensity radiance 1 is drawn as 1.
INTENSITY = 38400
# The picture has 8 bits and ends at 1: steps of a stop, of which each pixel takes the brightest that is not cut. So a value of 1/64 or
# more has a step of 0.8 % of itself at most. Radiance 1 is the code 240 of one of them, not between two.
EXPOSURES = [240 / 255 * 2.0**-k for k in range(-6, 13)]
LEFT_OUT = {"anisotropic": "Open3D gives meshes tangents of its own, not along the east"}


def mesh():
    points, _, triangles = unit_sphere(256)
    found = o3d.geometry.TriangleMesh(o3d.utility.Vector3dVector(points), o3d.utility.Vector3iVector(triangles))
    found.vertex_normals = o3d.utility.Vector3dVector(points)
    # A mesh without colours is multiplied by 0.5.
    found.paint_uniform_color([1, 1, 1])
    return found


def material(sphere):
    record = rendering.MaterialRecord()
    record.shader = "defaultLit"
    record.base_color = [*sphere["base_color"], 1]
    record.base_metallic = float(sphere["metallic"])
    record.base_roughness = sphere["roughness"]
    record.base_reflectance = 0.5  # F0 0.04
    record.base_clearcoat = float(sphere.get("coat", 0))
    record.base_clearcoat_roughness = sphere.get("coat_roughness", 0.0)
    return record


def draw(renderer, ball, sphere):
    scene = renderer.scene
    scene.clear_geometry()
    scene.add_geometry("ball", ball, material(sphere))
    image = np.zeros((size, size, 3), np.float32)
    is_open = np.ones(image.shape, bool)
    for exposure in EXPOSURES:
        scene.scene.set_indirect_light_intensity(INTENSITY * exposure)
        bits = np.asarray(renderer.render_to_image())[..., :3]
        image = np.where(is_open, bits / 255 / exposure, image)
        is_open &= bits >= 254
        if not is_open.any():
            break
    return image


spheres = Spheres("filament", sys.argv[1])
size = spheres.size
try:
    renderer = rendering.OffscreenRenderer(size, size)
except RuntimeError as error:
    stop("filament", f"Open3D cannot render offscreen here: {error}", CANNOT_RUN)
scene = renderer.scene
scene.set_background([0, 0, 0, 1])
scene.view.set_post_processing(False)
# On by default: it darkens even a lone sphere, by a tenth at n.v 0.7.
scene.view.set_ambient_occlusion(False, False)
scene.scene.enable_sun_light(False)
scene.camera.set_projection(rendering.Camera.Projection.Ortho, -EXTENT, EXTENT, -EXTENT, EXTENT, 0.1, 10)
scene.camera.look_at([0, 0, 0], [0, 0, 5], [0, 1, 0])
ball = mesh()
for name in spheres.maps:
    if not scene.scene.set_indirect_light(str(spheres.folder / "filament-bakes" / name)):
        stop("filament", f"cannot read the bake of {name}")
    for sphere in spheres.of_map(name, LEFT_OUT):
        spheres.save(sphere, draw(renderer, ball, sphere))
