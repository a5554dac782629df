"""Renders the spheres by MaterialX' GLSL of glTF PBR, as its viewer sets it up: filtered importance sampling with 16 samples.

Arguments: FOLDER of spheres.json. Its renderer opens an X11 window: run.sh starts Xvfb.
"""
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).parents[1]))
from common import EXTENT, Spheres, check_version, read_hdr, write_sphere

check_version("materialx", "MaterialX")
from glsl import context, gen, generator, image_of, library, mx, render, renderer_of
import numpy as np

SAMPLES = 16
# The shader takes the direction of view from the camera's position even in parallel projection, so the camera is far away.
DISTANCE = 500
DIFFUSE = (64, 32)


def directions(width, height):
    """Of texels in our lat-long layout, with their solid angles."""
    phi = 2 * np.pi * (0.5 - (np.arange(width) + 0.5) / width)
    theta = np.pi * (np.arange(height)[:, None] + 0.5) / height
    found = np.stack(np.broadcast_arrays(np.sin(theta) * np.sin(phi), np.cos(theta), np.sin(theta) * np.cos(phi)), axis=-1)
    return found.reshape(-1, 3), np.repeat(np.sin(theta[:, 0]), width) * 2 * np.pi**2 / (width * height)


def irradiance_over_pi(image):
    """The viewer fits spherical harmonics; this is the integral itself, of a map of at most 128 columns."""
    step = max(1, image.shape[1] // 128)
    height, width = image.shape[0] // step, image.shape[1] // step
    small = image.reshape(height, step, width, step, 3).mean(axis=(1, 3))
    normals, _ = directions(*DIFFUSE)
    lights, solid_angles = directions(width, height)
    cosines = np.maximum(normals @ lights.T, 0) * solid_angles
    return (cosines @ small.reshape(-1, 3) / np.pi).reshape(DIFFUSE[1], DIFFUSE[0], 3)


def shader_of(sphere):
    document = mx.createDocument()
    document.setDataLibrary(library)
    node = document.addNode("gltf_pbr", "surface", "surfaceshader")
    values = {
        "metallic": sphere["metallic"], "roughness": sphere["roughness"], "clearcoat": sphere.get("coat", 0),
        "clearcoat_roughness": sphere.get("coat_roughness", 0), "anisotropy_strength": sphere.get("anisotropy", 0),
    }
    node.setInputValue("base_color", mx.Color3(*map(float, sphere["base_color"])))
    for name, value in values.items():
        node.setInputValue(name, float(value))
    document.addMaterialNode("material", node)
    context.getOptions().hwSpecularEnvironmentMethod = gen.SPECULAR_ENVIRONMENT_FIS
    return generator.generate("shader", node, context)


spheres = Spheres("materialx", sys.argv[1])
size = spheres.size
mesh = spheres.out / "sphere.obj"
write_sphere(mesh)
renderer = renderer_of(size, mesh)
camera = renderer.getCamera()
camera.setViewMatrix(render.Camera.createViewMatrix(mx.Vector3(0, 0, DISTANCE), mx.Vector3(0, 0, 0), mx.Vector3(0, 1, 0)))
camera.setProjectionMatrix(render.Camera.createOrthographicMatrix(-EXTENT, EXTENT, -EXTENT, EXTENT, DISTANCE - 2, DISTANCE + 2))
for name in spheres.maps:
    image = read_hdr(spheres.map_path(name, "hdr"))
    lights = render.LightHandler.create()
    lights.setEnvRadianceMap(image_of(image))
    lights.setEnvIrradianceMap(image_of(irradiance_over_pi(image)))
    lights.setEnvSampleCount(SAMPLES)
    renderer.setLightHandler(lights)
    for sphere in spheres.of_map(name):
        renderer.createProgram(shader_of(sphere))
        renderer.setSize(size, size)
        renderer.render()
        found = renderer.captureImage(None)
        # Its rows go up.
        picture = [[list(found.getTexelColor(x, y))[:3] for x in range(size)] for y in reversed(range(size))]
        spheres.save(sphere, np.array(picture, np.float32))
