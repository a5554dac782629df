"""Writes MaterialX' prefiltered levels of each map, as its viewer makes them: DIR/MAP/m0.pfm and so on.

Arguments: FOLDER of spheres.json, DIR. Its renderer opens an X11 window: assets.sh starts Xvfb.
"""
import json
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).parents[1]))
from common import check_version, read_hdr, write_pfm

check_version("materialx", "MaterialX")
from glsl import context, gen, generator, image_of, library, mx, render, renderer_of
import numpy as np

folder, out = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
# Fills the picture; the shader computes a direction from the pixel.
QUAD = "v -2 -2 0\nv 2 -2 0\nv 2 2 0\nv -2 2 0\nvt 0 0\nvn 0 0 1\nf 1/1/1 2/1/1 3/1/1\nf 1/1/1 3/1/1 4/1/1\n"


def prefilter():
    """The shader that filters a level."""
    document = mx.createDocument()
    document.setDataLibrary(library)
    node = document.addNode("gltf_pbr", "surface", "surfaceshader")
    options = context.getOptions()
    options.hwSpecularEnvironmentMethod = gen.SPECULAR_ENVIRONMENT_PREFILTER
    options.hwWriteEnvPrefilter = True
    return generator.generate("prefilter", node, context)


mesh = out / "quad.obj"
mesh.write_text(QUAD)
renderer = renderer_of(64, mesh)
camera = renderer.getCamera()
camera.setViewMatrix(mx.Matrix44.IDENTITY)
camera.setProjectionMatrix(render.Camera.createOrthographicMatrix(-1, 1, -1, 1, -1, 1))
for name in json.loads((folder / "spheres.json").read_text())["maps"]:
    image = read_hdr(folder / "maps" / f"{name}.hdr")
    height, width, _ = image.shape
    lights = render.LightHandler.create()
    lights.setEnvRadianceMap(image_of(image))
    lights.setEnvIrradianceMap(image_of(image[:1, :2]))
    renderer.setLightHandler(lights)
    renderer.createProgram(prefilter())
    (out / name).mkdir(exist_ok=True)
    write_pfm(out / name / "m0.pfm", image)
    count = int(np.log2(width)) + 1
    # mx_latlong_lod_to_alpha, of all levels but the last.
    shares = [level / (count - 1) for level in range(count - 1)]
    (out / name / "alphas").write_text(",".join(f"{x * x if x < 0.5 else 2 * (x - 0.375):g}" for x in shares))
    for level in range(1, count):
        size = max(width >> level, 1), max(height >> level, 1)
        renderer.setSize(*size)
        # As the viewer does: the value in the shader is for the first level.
        program = renderer.getProgram()
        program.bind()
        program.bindUniform("u_envPrefilterMip", mx.TypedValue_integer.createValue(level), True)
        renderer.render()
        found = renderer.captureImage(None)
        texels = [[list(found.getTexelColor(x, y))[:3] for x in range(size[0])] for y in range(size[1])]
        write_pfm(out / name / f"m{level}.pfm", np.array(texels, np.float32))
