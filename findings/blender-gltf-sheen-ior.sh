#!/bin/sh
# Sheen weight and index of refraction of an opaque material by Blender's glTF exporter, bpy 5.2.3
#   (PyPI): a plane with the Principled BSDF, one value changed, read back from the JSON.
# Guess: sheenColorFactor is tint times weight, as the extension has no weight of its own, and
#   KHR_materials_ior is written whenever the index is not its default of 1.5.
# Seen: sheenColorFactor is the tint at every weight above 0: a sheen of weight .25 is exported 4
#   times as bright. The index is dropped: 1.8 (F0 .082) and 2.4 (F0 .17) become 1.5 (F0 .04). It
#   is written beside transmission or a specular tint, so glass and tinted plastic come through.
# Hurt: velvet and cloth that look fine in Blender and glow in a viewer, gems and varnish that lose
#   half to three quarters of their reflection, and comparisons of Cycles with glTF renderers. The
#   files are valid, and the exporter says nothing.
# Avoid: put the weight into the tint; set the specular tint to .999, which writes the index.
set -eu
t=$(mktemp -d)
trap 'rm -rf "$t"' EXIT
cd "$t"
python=$(command -v python3.13) || exit 77
"$python" -m venv v 2>/dev/null || exit 77
v/bin/python -m pip -q --disable-pip-version-check install bpy==5.2.3 || exit 77
cat >run.py <<'P'
import json, pathlib, sys, warnings

warnings.simplefilter("ignore")
import bpy

def exported(sockets):
    """The material of a plane with these values of the Principled BSDF, as glTF."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.mesh.primitive_plane_add()
    material = bpy.data.materials.new("a")
    material.use_nodes = True
    bsdf = material.node_tree.nodes["Principled BSDF"]
    for name, value in sockets.items():
        bsdf.inputs[name].default_value = value
    bpy.context.object.data.materials.append(material)
    bpy.ops.export_scene.gltf(filepath="a.gltf", export_format="GLTF_SEPARATE")
    return json.loads(pathlib.Path("a.gltf").read_text())["materials"][0].get("extensions", {})

def sheen(weight):
    found = exported({"Sheen Weight": weight, "Sheen Tint": (1, 0.8, 0.6, 1)})
    return [round(x, 3) for x in found["KHR_materials_sheen"]["sheenColorFactor"]]

def ior(**more):
    found = exported({name.replace("_", " "): value for name, value in more.items()})
    return round(found.get("KHR_materials_ior", {}).get("ior", 1.5), 3)

print("bpy", bpy.app.version_string)
weak, full = sheen(0.25), sheen(1.0)
print(f"sheen of tint 1 .8 .6: weight .25 {weak} (expected .25 .2 .15), weight 1 {full}")
opaque = [ior(IOR=1.8), ior(IOR=2.4)]
glass, tinted = ior(IOR=1.8, Transmission_Weight=1.0), ior(IOR=1.8, Specular_Tint=(1, 0.5, 0.5, 1))
f0 = [((n - 1) / (n + 1)) ** 2 for n in (1.8, 2.4, 1.5)]
print(f"index of an opaque material: {opaque} for 1.8 and 2.4, F0 {f0[2]:.3f} for {f0[0]:.3f} and",
      f"{f0[1]:.3f}; with transmission {glass}, with a specular tint {tinted}")
if weak != full or opaque != [1.5, 1.5] or [glass, tinted] != [1.8, 1.8]:
    sys.exit("CHANGED: the exporter keeps the weight of sheen or the index of refraction")
print("still so: no weight of sheen and no index of an opaque material in glTF")
P
status=0
v/bin/python run.py >out 2>log || status=$?
grep '^bpy\|^sheen\|^index\|^still' out || cat log
grep '^CHANGED' log || true
exit "$status"
