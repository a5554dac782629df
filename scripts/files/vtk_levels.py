"""Bakes a map by VTK's own textures and reads their levels back: python vtk_levels.py MAP.hdr FOLDER

Exits with 77 without a driver of EGL. VTK's anisotropic filter also acts on explicit levels: it is off here.
"""

import os
import sys
from pathlib import Path

os.environ.pop("DISPLAY", None)
os.environ["VTK_DEFAULT_OPENGL_WINDOW"] = "vtkEGLRenderWindow"
os.environ["PYOPENGL_PLATFORM"] = "egl"

import numpy as np
import OpenEXR
import vtkmodules.vtkRenderingOpenGL2  # noqa: F401, which brings the implementations
from OpenGL import GL
from vtkmodules.vtkIOImage import vtkHDRReader
from vtkmodules.vtkRenderingCore import vtkRenderer, vtkRenderWindow, vtkTexture

FACES = ["px", "nx", "py", "ny", "pz", "nz"]


def texture(path):
    reader = vtkHDRReader()
    reader.SetFileName(path)
    found = vtkTexture()
    found.SetInputConnection(reader.GetOutputPort())
    found.SetColorModeToDirectScalars()
    found.MipmapOn()
    found.InterpolateOn()
    found.SetMaximumAnisotropicFiltering(1)
    return found


def write_level(cube, level, folder):
    GL.glBindTexture(GL.GL_TEXTURE_CUBE_MAP, cube.GetTextureObject().GetHandle())
    for face, name in enumerate(FACES):
        texels = GL.glGetTexImage(GL.GL_TEXTURE_CUBE_MAP_POSITIVE_X + face, level, GL.GL_RGB, GL.GL_FLOAT)
        texels = np.array(texels, np.float32)
        side = round((texels.size / 3) ** 0.5)
        OpenEXR.File({"type": OpenEXR.scanlineimage}, {"RGB": texels.reshape(side, side, 3)}).write(str(folder / f"m{level}_{name}.exr"))


window, renderer = vtkRenderWindow(), vtkRenderer()
window.SetOffScreenRendering(True)
window.SetMultiSamples(0)
window.SetSize(16, 16)
window.AddRenderer(renderer)
renderer.UseImageBasedLightingOn()
renderer.SetEnvironmentTexture(texture(sys.argv[1]))
levels = renderer.GetEnvMapPrefiltered()
levels.SetHalfPrecision(False)
window.Render()
if levels.GetTextureObject() is None:
    sys.exit(77)
window.MakeCurrent()
out = Path(sys.argv[2])
out.mkdir(exist_ok=True)
for level in range(levels.GetPrefilterLevels()):
    write_level(levels, level, out)
