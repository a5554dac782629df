"""The tables of A and B of engines that sum GGX at 1024 points of Hammersley's set a texel."""
import numpy as np
import OpenEXR

SAMPLES = 1024


def radical_inverse(count):
    """Van der Corput's sequence of base 2."""
    bits = np.arange(count)
    return sum((bits >> k & 1) / 2.0 ** (k + 1) for k in range(count.bit_length()))


def pairs(n_dot_v, roughness, masking):
    """A and B for each perceptual roughness; `masking(n_dot_l, n_dot_v, roughness)` is G over n.l n.v."""
    first, second = np.arange(SAMPLES) / SAMPLES, radical_inverse(SAMPLES)
    alpha = roughness[:, None] ** 2
    cosine = np.sqrt((1 - second) / (1 + (alpha * alpha - 1) * second))
    sine = np.sqrt(1 - cosine**2)
    v = np.array([np.sqrt(1 - n_dot_v**2), 0, n_dot_v])
    v_dot_h = np.maximum(v[0] * sine * np.cos(2 * np.pi * first) + v[2] * cosine, 0)
    n_dot_l = np.maximum(2 * v_dot_h * cosine - n_dot_v, 0)
    visible = n_dot_l * masking(n_dot_l, n_dot_v, roughness[:, None]) * v_dot_h / np.maximum(cosine, 1e-9)
    fresnel = (1 - v_dot_h) ** 5
    return np.stack([((1 - fresnel) * visible).mean(axis=1), (fresnel * visible).mean(axis=1)], axis=-1)


def write(path, table):
    """Writes A and B, rows from the top, as an EXR of three channels."""
    image = np.concatenate([table, np.zeros((*table.shape[:2], 1))], axis=-1)
    OpenEXR.File({"type": OpenEXR.scanlineimage}, {"RGB": image.astype(np.float32)}).write(str(path))
