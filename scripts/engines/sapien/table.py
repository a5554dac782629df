"""Writes the DFG table that SAPIEN 3.0.3 makes, FILE.exr: 1024 samples of GGX a texel, roughness to the right, n.v down.

Its shader, in libsvulkan2.so, has k = (roughness / 2)^2 in Schlick's masking: alpha/4, where the text that it follows has
alpha/2. Pictures in constant light confirm it. Arguments: FILE.exr.
"""
import sys

import numpy as np
import OpenEXR

SIDE = 128
SAMPLES = 1024


def radical_inverse(count):
    """Van der Corput's sequence of base 2."""
    bits = np.arange(count)
    return sum((bits >> k & 1) / 2.0 ** (k + 1) for k in range(count.bit_length()))


def row(n_dot_v, roughness):
    """A and B for each roughness."""
    first, second = np.arange(SAMPLES) / SAMPLES, radical_inverse(SAMPLES)
    a = roughness[:, None] ** 2
    cosine = np.sqrt((1 - second) / (1 + (a * a - 1) * second))
    sine = np.sqrt(1 - cosine**2)
    v = np.array([np.sqrt(1 - n_dot_v**2), 0, n_dot_v])
    v_dot_h = np.maximum(v[0] * sine * np.cos(2 * np.pi * first) + v[2] * cosine, 0)
    n_dot_l = np.maximum(2 * v_dot_h * cosine - n_dot_v, 0)
    k = (roughness[:, None] / 2) ** 2
    masking = n_dot_l / ((n_dot_l * (1 - k) + k) * (n_dot_v * (1 - k) + k))
    visible = masking * v_dot_h / np.maximum(cosine, 1e-9)
    fresnel = (1 - v_dot_h) ** 5
    return np.stack([((1 - fresnel) * visible).mean(axis=1), (fresnel * visible).mean(axis=1)], axis=-1)


centres = (np.arange(SIDE) + 0.5) / SIDE
table = np.stack([row(n_dot_v, centres) for n_dot_v in centres]).astype(np.float32)
image = np.concatenate([table, np.zeros((SIDE, SIDE, 1), np.float32)], axis=-1)
OpenEXR.File({"type": OpenEXR.scanlineimage}, {"RGB": image}).write(sys.argv[1])
