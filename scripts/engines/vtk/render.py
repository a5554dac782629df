"""Renders the spheres in VTK: its physically based shading under its own prefiltered map, offscreen.

Arguments: FOLDER of spheres.json.
"""
import pathlib
import os
import sys

sys.path.insert(0, str(pathlib.Path(__file__).parents[1]))
from common import EXTENT, Spheres, check_version, unit_sphere

check_version("vtk", "vtk")
import numpy as np
# Offscreen by EGL, on the software driver.
os.environ.pop("DISPLAY", None)
os.environ.setdefault("VTK_DEFAULT_OPENGL_WINDOW", "vtkEGLRenderWindow")
from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkPoints, vtkUnsignedCharArray
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData
from vtkmodules.vtkIOImage import vtkHDRReader
from vtkmodules.vtkRenderingCore import vtkActor, vtkPolyDataMapper, vtkRenderer, vtkRenderWindow, vtkTexture
import vtkmodules.vtkRenderingOpenGL2  # noqa: F401, which brings the implementations

# A lat-long map's centre is +x in its world, ours +z. The shader takes the direction of view from the camera's position even in
# parallel projection, so the camera is far away.
CAMERA = (500, 0, 0)


def polydata():
    points, uvs, triangles = unit_sphere(256)
    data = vtkPolyData()
    held = vtkPoints()
    held.SetData(numpy_to_vtk(points.astype(np.float32), deep=True))
    data.SetPoints(held)
    cells = vtkCellArray()
    ids = np.insert(triangles, 0, 3, axis=1).astype(np.int64).ravel()
    cells.ImportLegacyFormat(numpy_to_vtkIdTypeArray(ids, deep=True))
    data.SetPolys(cells)
    for name, values, use in [
        ("normals", points, data.GetPointData().SetNormals),
        ("uv", uvs, data.GetPointData().SetTCoords),
        ("tangents", np.stack([points[:, 2], 0 * points[:, 0], -points[:, 0]], axis=1), data.GetPointData().SetTangents),
    ]:
        array = numpy_to_vtk(values.astype(np.float32), deep=True)
        array.SetName(name)
        use(array)
    return data


def texture(path):
    reader = vtkHDRReader()
    reader.SetFileName(path)
    found = vtkTexture()
    found.SetInputConnection(reader.GetOutputPort())
    found.SetColorModeToDirectScalars()
    found.MipmapOn()
    found.InterpolateOn()
    return found


def shade(actor, sphere):
    prop = actor.GetProperty()
    prop.SetInterpolationToPBR()
    prop.SetColor(*sphere["base_color"])
    prop.SetMetallic(sphere["metallic"])
    prop.SetRoughness(sphere["roughness"])
    # As every other coat; its own default is 2.
    prop.SetCoatIOR(1.5)
    prop.SetCoatStrength(sphere.get("coat", 0))
    prop.SetCoatRoughness(sphere.get("coat_roughness", 0))
    prop.SetAnisotropy(sphere.get("anisotropy", 0))


# VTK writes 8 bits of color^(1/2.2). The last lines of the shader undo the power, and write one channel's logarithm to base 2 in
# three bytes instead.
OCTAVES = 40
DIGITS = 256**3 - 1
STORE = f"""//VTK::Picking::Impl
    float value = pow(gl_FragData[0][channel], 2.2);
    float digits = floor(clamp(log2(max(value, 1e-30)) / {OCTAVES}.0 + 0.5, 0.0, 1.0) * {DIGITS}.0 + 0.5);
    vec3 bytes = mod(floor(vec3(digits, digits / 256.0, digits / 65536.0)), 256.0);
    gl_FragData[0] = vec4(bytes / 255.0, 1.0);
"""


def draw(window, actor, size):
    planes = []
    for channel in range(3):
        actor.GetShaderProperty().GetFragmentCustomUniforms().SetUniformi("channel", channel)
        window.Render()
        found = vtkUnsignedCharArray()
        window.GetPixelData(0, 0, size - 1, size - 1, 0, found, 0)
        digits = vtk_to_numpy(found).reshape(size, size, 3)[::-1] @ np.array([1, 256, 65536])
        planes.append(np.where(digits > 0, 2.0 ** ((digits / DIGITS - 0.5) * OCTAVES), 0))
    return np.stack(planes, axis=-1)


spheres = Spheres("vtk", sys.argv[1])
size = spheres.size
mapper = vtkPolyDataMapper()
mapper.SetInputData(polydata())
for name in spheres.maps:
    renderer, window, actor = vtkRenderer(), vtkRenderWindow(), vtkActor()
    window.SetOffScreenRendering(True)
    window.SetMultiSamples(0)
    window.SetSize(size, size)
    window.AddRenderer(renderer)
    renderer.SetBackground(0, 0, 0)
    renderer.AutomaticLightCreationOff()
    renderer.UseImageBasedLightingOn()
    renderer.SetEnvironmentTexture(texture(spheres.map_path(name, "hdr")))
    actor.SetMapper(mapper)
    actor.GetShaderProperty().AddFragmentShaderReplacement("//VTK::Picking::Impl", True, STORE, False)
    renderer.AddActor(actor)
    camera = renderer.GetActiveCamera()
    camera.ParallelProjectionOn()
    camera.SetParallelScale(EXTENT)
    camera.SetPosition(*CAMERA)
    camera.SetFocalPoint(0, 0, 0)
    camera.SetViewUp(0, 1, 0)
    renderer.ResetCameraClippingRange()
    for sphere in spheres.of_map(name):
        shade(actor, sphere)
        spheres.save(sphere, draw(window, actor, size))
