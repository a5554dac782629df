"""Renders a white metal in Bevy by the program of scripts/check-clients.sh --bevy, under a bake for Bevy.

Arguments: FOLDER of spheres.json; BEVY_PEER names the program.
"""
import os
import pathlib
import struct
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).parents[1]))
from common import CANNOT_RUN, Spheres, check_version, stop

check_version("bevy", "zstandard")
import numpy as np
import zstandard

HEADER, INDEX = 80, 24


def unpack(path):
    """Writes a KTX 2 without Zstandard, which the program is built without; returns its name."""
    data = path.read_bytes()
    count = struct.unpack_from("<I", data, 40)[0]
    index = [struct.unpack_from("<3Q", data, HEADER + INDEX * level) for level in range(count)]
    plain = [zstandard.decompress(data[at:at + size], max_output_size=full) for at, size, full in index]
    descriptor_at, descriptor_size = struct.unpack_from("<2I", data, 48)
    new_descriptor_at = HEADER + INDEX * count
    head = bytearray(data[:new_descriptor_at])
    # No supercompression, and neither keys nor global data.
    struct.pack_into("<I", head, 44, 0)
    struct.pack_into("<4I2Q", head, 48, new_descriptor_at, descriptor_size, 0, 0, 0, 0)
    body = data[descriptor_at:descriptor_at + descriptor_size]
    # The last level comes first.
    for level in reversed(range(count)):
        body += bytes(-(len(head) + len(body)) % 16)
        struct.pack_into("<3Q", head, HEADER + INDEX * level, len(head) + len(body), len(plain[level]), len(plain[level]))
        body += plain[level]
    out = path.with_name(f"{path.stem}-plain.ktx2")
    out.write_bytes(bytes(head) + body)
    return str(out)


def draw(cubes, sphere, size, raw):
    command = [os.environ["BEVY_PEER"], "sphere", *cubes, str(size), "ortho", str(sphere["roughness"]), str(raw)]
    subprocess.run(command, check=True, stderr=subprocess.DEVNULL)
    return np.fromfile(raw, np.float32).reshape(size, size, 4)[..., :3]


spheres = Spheres("bevy", sys.argv[1])
LEFT_OUT = {sphere["material"]: "its program draws a white metal alone" for sphere in spheres.spheres if sphere["material"] != "white"}
if len({sphere["material"] for sphere in spheres.spheres}) == len(LEFT_OUT):
    stop("bevy", "its program draws a white metal alone: --material white", CANNOT_RUN)
for name in spheres.maps:
    folder = spheres.folder / "bevy-bakes" / name
    cubes = [unpack(folder / f"{kind}.ktx2") for kind in ("specular", "diffuse")]
    for sphere in spheres.of_map(name, LEFT_OUT):
        spheres.save(sphere, draw(cubes, sphere, spheres.size, spheres.out / "picture.raw"))
