"""Renders the spheres in Blender's Cycles: its Principled BSDF with GGX.

Arguments: FOLDER of spheres.json.
"""
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).parents[1]))
from common import Spheres, check_version

check_version("cycles", "bpy")
import blender

spheres = Spheres("cycles", sys.argv[1])
scene, ball = blender.start("CYCLES", spheres.size)
scene.cycles.samples, scene.cycles.use_denoising, scene.cycles.use_adaptive_sampling = 64, False, False
scene.cycles.pixel_filter_type, scene.cycles.filter_width = "BOX", 1
scene.cycles.max_bounces, scene.cycles.blur_glossy = 1, 0
scene.cycles.sample_clamp_direct = scene.cycles.sample_clamp_indirect = 0
# Single scattering, as in `reference` without --compensation.
blender.draw(spheres, scene, ball, "GGX")
