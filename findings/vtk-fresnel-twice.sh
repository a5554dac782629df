#!/bin/sh
# vtk 9.7.1 (PyPI): PBR interpolation under an image-based light, offscreen by EGL.
# Guess: a smooth black dielectric under a uniform white sky shows its directional albedo, F0 A + B of
#   VTK's own table: .115 at n.v .4, which is Schlick's factor too.
# Seen: .18 there, and 1.3 times the exact light over a sphere. F0 is raised by a Fresnel factor of n.v
#   before it meets the table (k_S), and B in the table has that factor already. Rougher surfaces gain
#   less (1.13 at roughness .7), roughness 1 nothing; coloured metals turn paler at their rims.
# Hurt: plastics, wet and lacquered surfaces look glossier than in glTF viewers and path tracers; who
#   sets roughness by eye in VTK, PyVista or F3D sets it too high. Lights do not show it.
# Avoid: replace k_S by F0 in the fragment shader (AddFragmentShaderReplacement).
set -eu
t=$(mktemp -d)
trap 'rm -rf "$t"' EXIT
python3 -m pip -q --disable-pip-version-check install --root-user-action ignore --target "$t/p" vtk==9.7.1 numpy || exit 77
env -u DISPLAY VTK_DEFAULT_OPENGL_WINDOW=vtkEGLRenderWindow PYTHONPATH="$t/p" nice -n 10 python3 - 2>"$t/log" <<'P' || { code=$?; tail -n 2 "$t/log"; exit $code; }
import sys

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkUnsignedCharArray, vtkVersion
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkFiltersSources import vtkSphereSource
from vtkmodules.vtkRenderingCore import vtkActor, vtkPolyDataMapper, vtkRenderer, vtkRenderWindow, vtkTexture
import vtkmodules.vtkRenderingOpenGL2

size = 400
print("vtk", vtkVersion.GetVTKVersion())
sky = vtkImageData()
sky.SetDimensions(64, 32, 1)
sky.GetPointData().SetScalars(numpy_to_vtk(np.ones((64 * 32, 3), np.float32), deep=True))
light = vtkTexture()
light.SetInputData(sky)
light.SetColorModeToDirectScalars()
light.MipmapOn()
light.InterpolateOn()
source = vtkSphereSource()
source.SetRadius(1)
source.SetThetaResolution(400)
source.SetPhiResolution(400)
mapper = vtkPolyDataMapper()
mapper.SetInputConnection(source.GetOutputPort())
actor = vtkActor()
actor.SetMapper(mapper)
prop = actor.GetProperty()
prop.SetInterpolationToPBR()
prop.SetColor(0, 0, 0)
prop.SetMetallic(0)
renderer, window = vtkRenderer(), vtkRenderWindow()
window.SetOffScreenRendering(True)
window.SetMultiSamples(0)
window.SetSize(size, size)
window.AddRenderer(renderer)
renderer.SetBackground(0, 0, 0)
renderer.AutomaticLightCreationOff()
renderer.UseImageBasedLightingOn()
renderer.SetEnvironmentTexture(light)
renderer.AddActor(actor)
camera = renderer.GetActiveCamera()
camera.ParallelProjectionOn()
camera.SetParallelScale(1)
# The direction of view comes from the camera's position, even in parallel projection.
camera.SetPosition(500, 0, 0)
renderer.ResetCameraClippingRange()


def albedo(cosine):
    """Linear radiance where n.v is the cosine: the shader writes its power of 1/2.2."""
    window.Render()
    pixels = vtkUnsignedCharArray()
    window.GetPixelData(0, 0, size - 1, size - 1, 0, pixels, 0)
    row = vtk_to_numpy(pixels).reshape(size, size, 3)[size // 2, :, 0]
    return (row[int(size / 2 * (1 + np.sqrt(1 - cosine**2)))] / 255) ** 2.2


found = {}
for roughness in [0.1, 1]:
    prop.SetRoughness(roughness)
    found[roughness] = [float(albedo(cosine)) for cosine in [0.98, 0.6, 0.4]]
    print(f"roughness {roughness}:", " ".join(f"{value:.3f}" for value in found[roughness]))
print("exact, roughness 0.1: 0.040 0.050 0.115; roughness 1: 0.012 0.018 0.025 (n.v .98, .6, .4)")
if not found[0.1][2] > 0.14:
    sys.exit("CHANGED: a smooth dielectric no longer reflects too much at grazing views")
print(f"still so: {found[0.1][2] / 0.115:.2f} times the exact reflectance at n.v .4")
P
