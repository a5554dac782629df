"""Recovers two metals and their light from exact photos, by four lookups (docs/recovery.md). Needs torch.

    python recovery_light.py [MAP...]    # photos under other lights than the built-in studio
"""

import sys
from functools import lru_cache

import matplotlib.pyplot as plt
import numpy as np
import splitsum
import splitsum.torch as st
import torch

DEGREE, DEGREE_JUDGED, KNOWN_F0, SMOOTHNESS = 16, 6, 0.9, 1e-4
TRUTH = np.array([0.4, 0.7, 0.9])  # Both spheres' roughness, and F0 of the second; F0 of the first is known.
METHODS = {"split-sum": "textbook", "split-sum-one": "one", "split-sum-two": "two", "split-sum-four": "four"}
DEGREES = torch.arange((DEGREE + 1) ** 2).sqrt().floor()  # of each harmonic
LEVELS, FITTED = [0.25, 0.4, 0.55, 0.75, 1], [0.25 + k / 16 for k in range(13)]  # roughness
TABLES = st.Tables(mapping=LEVELS, masking="correlated")
y, x = np.mgrid[15 / 16 : -1 : -1 / 8, -15 / 16 : 1 : 1 / 8]
normals = np.stack([x, y, np.sqrt((1 - x * x - y * y).clip(0))], -1)[x * x + y * y < 0.95]
turns = np.array([[[np.cos(t), 0, -np.sin(t)], [0, 1, 0], [np.sin(t), 0, np.cos(t)]] for t in np.arange(4) * np.pi / 2])
n, v = np.concatenate(normals @ turns), np.repeat(turns[:, 2], len(normals), 0)  # The light turns from photo to photo.
n, v = torch.from_numpy(n), torch.from_numpy(v)


@lru_cache(maxsize=None)
def levels():
    """Prefilters the harmonics, three as the channels of a map, over white light; the last channel is white alone."""
    maps = 1 + 0.3 * torch.nn.functional.pad(st.spherical_harmonics(DEGREE, (256, 128)), (0, 0, 0, 0, 0, 2))
    options = {"mapping": LEVELS, "layout": "equirect", "size": [(128, 64)] * len(LEVELS), "degree": DEGREE}
    return [st.prepare(st.prefilter(rgb, **options)) for rgb in maps.unflatten(0, (-1, 3)).movedim(1, -1)]


@lru_cache(maxsize=None)
def images(method, roughness, f0):
    """Shades a sphere under each harmonic: (pixels, harmonics)."""
    found = torch.cat([st.shade(light, n, v, roughness, f0, method, TABLES) for light in levels()], -1)
    return (found[:, :-2] - found[:, -1:]) / 0.3


def model(method, roughness, f0):
    """Returns `images` between two roughnesses of FITTED, as a line in F0. An image is linear in the light, too."""
    k = min(int(16 * (roughness - 0.25)), len(FITTED) - 2)
    ends = [(2 - 2 * f0) * images(method, r, 0.5) + (2 * f0 - 1) * images(method, r, 1.0) for r in FITTED[k : k + 2]]
    return torch.lerp(*ends, 16 * (roughness - FITTED[k]))


def explained(method, materials, photos):
    """Finds the light with which materials explain photos best: the errors that remain, and its coefficients."""
    weights = 1 / (photos.mean(1, keepdim=True) + 0.1 * photos.mean())
    rows = weights * torch.cat([model(method, materials[0], KNOWN_F0), model(method, *materials[1:])])
    smoothness = torch.diag((1 + DEGREES / 4) * SMOOTHNESS * weights.norm())
    rows, goal = torch.cat([rows, smoothness]), torch.nn.functional.pad(weights * photos, (0, 0, 0, len(smoothness)))
    light = torch.linalg.solve(rows.T @ rows, rows.T @ goal)
    return (rows @ light - goal).flatten(), light


def fit(method, photos):
    """Recovers materials by Gauss and Newton from two starts, and the light with them: materials, coefficients."""
    answers = []
    for start in ([0.35, 0.55, 0.6], [0.6, 0.9, 1.0]):
        best, (errors, light) = np.array(start), explained(method, start, photos)
        for _ in range(20):
            moved = [explained(method, best + move, photos)[0] for move in 1e-3 * np.eye(3)]
            slopes = torch.stack([(other - errors) / 1e-3 for other in moved], 1)
            step = torch.linalg.lstsq(slopes, -errors[:, None]).solution[:, 0].numpy()
            for part in 0.5 ** np.arange(6):
                tried = np.clip(best + part * step, [0.25, 0.25, 0.1], [1, 1, 3])
                if (found := explained(method, tried, photos))[0].norm() < errors.norm() * (1 - 1e-6):
                    best, (errors, light) = tried, found
                    break
            else:
                break
        answers.append((errors.norm(), best, light))
    return min(answers, key=lambda answer: answer[0])[1:]


def main(names):
    basis = st.spherical_harmonics(DEGREE, (64, 32)).flatten(1)
    areas = torch.sin((torch.arange(32) + 0.5) * np.pi / 32)[:, None].expand(32, 64).flatten()
    areas = areas * (4 * np.pi / areas.sum())
    _, rows = plt.subplots(len(names), 5, figsize=(15, 0.4 + 2.1 * len(names)), layout="compressed", squeeze=False)
    for name, panels in zip(names, rows):
        light = splitsum.prefilter(name, 0.05, layout="equirect", size=(64, 32))
        surfaces = zip(TRUTH[:2] ** 2, (KNOWN_F0, TRUTH[2]))
        known = {"n": n, "v": v, "masking": "correlated", "tolerance": 1e-3}
        exact = [splitsum.integrate(light, alpha=alpha, f0=f0, **known)["specular"] for alpha, f0 in surfaces]
        photos = torch.from_numpy(np.concatenate(exact))
        truth = (basis * areas) @ torch.from_numpy(light).double().reshape(-1, 3)
        answers = {METHODS[method]: fit(method, photos) for method in METHODS}
        for axes, (title, (materials, found)) in zip(panels, {"truth": (TRUTH, truth), **answers}.items()):
            judged = slice((DEGREE_JUDGED + 1) ** 2)
            error = ((found - truth)[judged].norm() / truth[judged].norm()).item()
            text = "roughness {:.2f} and {:.2f}, F0 {:.2f}".format(*materials) + f"\nlight off by {error:.0%}"
            print(name, title, text.replace("\n", ", "), sep=": ")
            smooth = (-((DEGREES / DEGREE_JUDGED) ** 2)).exp()[:, None] * found
            radiance = (basis.T @ smooth).reshape(32, 64, 3).clamp(min=0) / truth[0].mean()
            axes.set(title=title, xlabel=text, xticks=[], yticks=[])
            axes.imshow((radiance / (1 + radiance)).numpy() ** 0.45)
    plt.savefig("recovery_light.png", dpi=150)


if __name__ == "__main__":
    main(sys.argv[1:] or ["builtin:studio"])
