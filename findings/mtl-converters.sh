#!/bin/sh
# One OBJ with MTL (Kd .5, Ks .04, Ns 10, 250, 900) to glTF by four converters: trimesh 5.2.0
#   (PyPI), obj2gltf 3.2.0, assimpjs 0.0.10 and three 0.187.0 (npm; MTLLoader to GLTFExporter).
# Guess: they differ a little in the law from Ns to roughness; colour and F0 come through.
# Seen: for Ns 250 roughness .30, .72, .98 and 1.00: alpha from .09 to 1. No two agree, and from
#   Ns 10 to 900 roughness falls by .42, .85, .03 and not at all. three takes Kd for sRGB and
#   writes .214, a diffuse colour 2.3 times darker; assimpjs writes an index of refraction of 1
#   (a Ni that the file does not hold), so that a reader of KHR_materials_ior draws no highlight.
# Hurt: material libraries moved in bulk, and comparisons of renderers "on the same OBJ": under an
#   environment the four are four materials, and every glTF is valid (three warns of the type).
# Avoid: take geometry from OBJ and materials from one's own table; compare the glTF's numbers.
set -eu
t=$(mktemp -d)
trap 'rm -rf "$t"' EXIT
cd "$t"
command -v node >/dev/null || exit 77
python3 -m pip -q --disable-pip-version-check install --root-user-action ignore --target p \
    trimesh==5.2.0 numpy==2.4.6 pillow==13.0.0 || exit 77
echo '{"type":"module"}' >package.json
npm install --silent --no-fund --no-audit obj2gltf@3.2.0 assimpjs@0.0.10 three@0.187.0 || exit 77
cat >three.mjs <<'J'
import fs from 'node:fs';
import aj from 'assimpjs';
import { OBJLoader } from 'three/addons/loaders/OBJLoader.js';
import { MTLLoader } from 'three/addons/loaders/MTLLoader.js';
import { GLTFExporter } from 'three/addons/exporters/GLTFExporter.js';
globalThis.FileReader = class { // what the exporter needs of a browser
  async readAsDataURL(blob) {
    const bytes = Buffer.from(await blob.arrayBuffer());
    this.result = 'data:application/octet-stream;base64,' + bytes.toString('base64');
    this.onloadend();
  }
};
const assimp = await aj();
for (const ns of [10, 250, 900]) {
  const files = new assimp.FileList();
  for (const f of [`${ns}.obj`, `${ns}.mtl`])
    files.AddFile(f, new Uint8Array(fs.readFileSync(f)));
  const result = assimp.ConvertFileList(files, 'gltf2');
  fs.writeFileSync(`assimpjs-${ns}.gltf`, result.GetFile(0).GetContent());
  const materials = new MTLLoader().parse(fs.readFileSync(`${ns}.mtl`, 'utf8'), '');
  materials.preload();
  const loader = new OBJLoader().setMaterials(materials);
  const scene = loader.parse(fs.readFileSync(`${ns}.obj`, 'utf8'));
  const gltf = await new GLTFExporter().parseAsync(scene, { binary: false });
  fs.writeFileSync(`three-${ns}.gltf`, JSON.stringify(gltf));
}
J
cat >run.py <<'P'
import json, pathlib, subprocess, sys
from importlib.metadata import version
import trimesh

def npm(name):
    return json.loads(pathlib.Path("node_modules", name, "package.json").read_text())["version"]

print("trimesh", version("trimesh"), *(f"{n} {npm(n)}" for n in ("obj2gltf", "assimpjs", "three")))
shininess = (10, 250, 900)
for ns in shininess:
    pathlib.Path(f"{ns}.mtl").write_text(f"newmtl a\nKd .5 .5 .5\nKs .04 .04 .04\nNs {ns}\n"
                                         "illum 2\n")
    pathlib.Path(f"{ns}.obj").write_text(
        f"mtllib {ns}.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nvt 0 0\nusemtl a\n"
        "f 1/1/1 2/1/1 3/1/1\n")
    mesh = trimesh.load_scene(f"{ns}.obj")
    files = trimesh.exchange.gltf.export_gltf(mesh)
    pathlib.Path(f"trimesh-{ns}.gltf").write_bytes(files["model.gltf"])
    subprocess.run(["node", "node_modules/obj2gltf/bin/obj2gltf.js", "-i", f"{ns}.obj", "-o",
                    f"obj2gltf-{ns}.gltf"], check=True, capture_output=True)
subprocess.run(["node", "three.mjs"], check=True, capture_output=True)
rough, colour, ior = {}, {}, {}
for tool in ("trimesh", "obj2gltf", "assimpjs", "three"):
    for ns in shininess:
        materials = json.loads(pathlib.Path(f"{tool}-{ns}.gltf").read_text())["materials"]
        pbr = materials[-1]["pbrMetallicRoughness"]
        rough[tool, ns] = pbr.get("roughnessFactor", 1.0)
        colour[tool] = pbr["baseColorFactor"][0]
        ior[tool] = materials[-1].get("extensions", {}).get("KHR_materials_ior", {}).get("ior", 1.5)
    print(f"{tool}: roughness", " ".join(f"{rough[tool, ns]:.3f}" for ns in shininess),
          f"for Ns {shininess}; base colour {colour[tool]:.3f} (expected 0.5), ior {ior[tool]}",
          "(expected 1.5)")
spread = [rough[tool, 250] for tool in colour]
if max(spread) - min(spread) < 0.5 or colour["three"] > 0.3 or ior["assimpjs"] != 1:
    sys.exit("CHANGED: the converters have come closer")
print(f"still so: one Ns is roughness {min(spread):.2f} to {max(spread):.2f}")
P
PYTHONPATH="$t/p" python3 run.py
