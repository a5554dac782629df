"""Models as trimesh and pygltflib write them: materials of the file against the same by flags."""

from pathlib import Path

import numpy as np
import OpenEXR
import pygltflib
import trimesh
from trimesh.visual import TextureVisuals
from trimesh.visual.material import PBRMaterial

from cases import Check, Wrong

COLOR, METALLIC, ROUGHNESS = (0.8, 0.4, 0.2), 0.75, 0.5
# The file's colour is linear; its texture has sRGB codes: 128 is a linear 0.21586.
CODE, LINEAR = 128, 0.21586
SIZE = "48x48"


def sphere(**material):
    """A mesh without hidden state: a sphere whose texture coordinates follow its longitude."""
    mesh = trimesh.creation.icosphere(subdivisions=4)
    x, y, z = mesh.vertices.T
    uv = np.stack([np.arctan2(x, z) / (2 * np.pi) + 0.5, np.arccos(y.clip(-1, 1)) / np.pi], -1)
    mesh.visual = TextureVisuals(uv=uv, material=PBRMaterial(**material))
    return trimesh.Trimesh(mesh.vertices, mesh.faces, vertex_normals=mesh.vertices, visual=mesh.visual, process=False)


def plain():
    return sphere(baseColorFactor=[*COLOR, 1.0], metallicFactor=METALLIC, roughnessFactor=ROUGHNESS)


def by_trimesh(name):
    def make():
        folder = Path(name.replace(".", "-"))
        folder.mkdir(exist_ok=True)
        plain().export(folder / name)
        return str(folder / name)
    return make


def textured():
    from PIL import Image
    image = Image.new("RGB", (4, 4), (CODE, CODE, CODE))
    sphere(baseColorTexture=image, metallicFactor=METALLIC, roughnessFactor=ROUGHNESS).export("textured.glb")
    return "textured.glb"


def extended(extension, members):
    """Adds an extension of materials by pygltflib."""
    def make():
        name = f"{extension}.glb"
        plain().export(name)
        model = pygltflib.GLTF2().load(name)
        model.materials[0].extensions = {extension: members}
        model.extensionsUsed = [extension]
        model.save(name)
        return name
    return make


def render(reader, scene, out, *flags):
    done = reader.run("render", "--environment", "g.exr", "--scene", scene, "--method", "split-sum", "--camera", "perspective",
                      "--size", SIZE, "--out", out, *flags)
    if done.returncode != 0:
        raise Wrong(done.stderr.strip())
    return OpenEXR.File(out).channels()["RGBA"].pixels[..., :3]


def cases(reader):
    color = ",".join(str(value) for value in COLOR)
    base = ("--metallic", str(METALLIC))

    def against(make, *flags):
        def check():
            scene = make()
            by_file = render(reader, scene, f"{scene}.file.exr")
            by_flags = render(reader, scene, f"{scene}.flags.exr", *base, *flags, "--perceptual-roughness", str(ROUGHNESS))
            off = np.abs(by_file - by_flags).max() / by_flags.mean()
            # The flags must matter: another roughness gives another picture.
            other = render(reader, scene, f"{scene}.other.exr", *base, *flags, "--perceptual-roughness", "0.3")
            if not (off < 1e-3 and np.abs(other - by_flags).max() > 0.02):
                raise Wrong(f"the picture is {off:.1e} of the mean off")
            return f"{off:.1e} of the mean off"
        return check

    colored = ("--albedo", color)
    coat = {"clearcoatFactor": 0.5, "clearcoatRoughnessFactor": 0.25}
    sheen = {"sheenColorFactor": [0.5, 0.25, 0.125], "sheenRoughnessFactor": 0.5}
    anisotropy = {"anisotropyStrength": 0.5, "anisotropyRotation": 0.25}
    return [
        Check("trimesh glb", against(by_trimesh("ball.glb"), *colored), "0 off"),
        Check("trimesh gltf", against(by_trimesh("ball.gltf"), *colored), "0 off"),
        Check("trimesh texture", against(textured, "--albedo", str(LINEAR)), "0 off"),
        Check("pygltflib ior", against(extended("KHR_materials_ior", {"ior": 1.8}), *colored, "--f0", str((0.8 / 2.8) ** 2)), "0 off"),
        Check("pygltflib clear coat", against(extended("KHR_materials_clearcoat", coat), *colored, "--coat", "0.5",
                                              "--coat-perceptual-roughness", "0.25"), "0 off"),
        Check("pygltflib sheen", against(extended("KHR_materials_sheen", sheen), *colored, "--sheen-color", "0.5,0.25,0.125",
                                         "--sheen-perceptual-roughness", "0.5"), "0 off"),
        Check("pygltflib anisotropy", against(extended("KHR_materials_anisotropy", anisotropy), *colored, "--anisotropy", "0.5",
                                              "--anisotropy-rotation-deg", str(np.degrees(0.25))), "0 off"),
    ]
