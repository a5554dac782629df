"""Renders the spheres in Blender's EEVEE: its Principled BSDF, with the world as EEVEE bakes it. OpenGL by EGL, without a display.

Arguments: FOLDER of spheres.json.
"""
import os
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).parents[1]))
from common import CANNOT_RUN, Spheres, check_version, stop

check_version("eevee", "bpy")
os.environ.pop("DISPLAY", None)
os.environ.setdefault("EGL_PLATFORM", "surfaceless")
import blender

LEFT_OUT = {"anisotropic": "EEVEE draws it isotropic"}

spheres = Spheres("eevee", sys.argv[1])
scene, ball = blender.start("BLENDER_EEVEE", spheres.size)
scene.eevee.taa_render_samples, scene.render.filter_size = 8, 0
try:
    blender.draw(spheres, scene, ball, "MULTI_GGX", LEFT_OUT)
except RuntimeError as error:
    stop("eevee", f"Blender has no OpenGL here: {error}", CANNOT_RUN)
