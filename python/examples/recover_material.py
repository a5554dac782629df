"""Recovers roughness, F0 and light from exact images of a metal sphere, by three lookups (docs/recovery.md). Needs torch."""

import matplotlib.pyplot as plt
import numpy as np
import splitsum
import splitsum.torch as st
import torch

SIDE, TURNS, F0, ITERATIONS = 32, 3, 0.9, 120
ROUGHNESSES = [0.25, 0.4, 0.55, 0.75, 1]
METHODS = {"split-sum": "textbook", "split-sum-two": "two lookups", "split-sum-four": "four lookups"}
tables = st.Tables(mapping=ROUGHNESSES, masking="correlated")


def tone(radiance):
    """Tone-maps as nvdiffrec's loss does: sRGB of log(1 + x)."""
    x = torch.log1p(radiance)
    return torch.where(x > 0.0031308, 1.055 * x.clamp(min=0.0031308) ** (1 / 2.4) - 0.055, 12.92 * x)


def fit(method, known):
    """Fits by Adam: returns the roughness of each pixel, F0 and the light's relative error."""
    guess = [torch.zeros(len(normals)), torch.tensor(1.0), torch.zeros(light.shape)]
    optimizer = torch.optim.Adam([values.requires_grad_() for values in guess], lr=0.05)
    for _ in range(ITERATIONS):
        found = light if known else guess[2].exp() / (guess[2].exp() * areas).mean()
        levels = st.prefilter(found, mapping=ROUGHNESSES, layout="equirect", size=[(64, 32)] * 5)
        roughness, f0 = 0.25 + 0.75 * torch.sigmoid(guess[0]), torch.sigmoid(guess[1])
        optimizer.zero_grad()
        (tone(st.shade(levels, n, v, roughness, f0, method, tables)) - tone(photos)).abs().mean().backward()
        optimizer.step()
    return roughness.detach().numpy(), f0.item(), ((found - light).abs() * areas).mean().item()


y, x = np.mgrid[1 - 1 / SIDE : -1 : -2 / SIDE, -1 + 1 / SIDE : 1 : 2 / SIDE]
mask = x * x + y * y < 0.98
normals = np.stack([x, y, np.sqrt(np.clip(1 - x * x - y * y, 0, 1))], -1)[mask]
truth, rim = np.where((x > 0) == (y > 0), 0.5, 0.7)[mask], normals[:, 2] < 0.4
light = torch.from_numpy(splitsum.prefilter("builtin:studio", 0.05, layout="equirect", size=(32, 16)))
areas = torch.sin((torch.arange(16) + 0.5) * np.pi / 16)[:, None, None]
areas /= (light * areas).mean()
angles = np.arange(TURNS) * 2 * np.pi / TURNS  # The light turns about y from photo to photo.
turns = np.array([[[np.cos(t), 0, -np.sin(t)], [0, 1, 0], [np.sin(t), 0, np.cos(t)]] for t in angles])
n, v = normals @ turns, np.array([[0, 0, 1.0]]) @ turns
exact = splitsum.integrate(light.numpy(), n=n, v=v, alpha=truth**2, f0=F0, masking="correlated", tolerance=1e-3)
n, v, photos = (torch.from_numpy(values).float() for values in (n, v, exact["specular"]))
_, rows = plt.subplots(2, 4, figsize=(12, 7), layout="compressed")
for axes, known in zip(rows, (True, False)):
    answers = {name: fit(method, known) for method, name in METHODS.items()}
    for panel, (name, (roughness, f0, error)) in zip(axes, {"truth": (truth, F0, 0), **answers}.items()):
        middle, edge = (np.median(abs(roughness - truth)[part]) for part in (~rim, rim))
        text = f"median error {middle:.3f}, rim {edge:.3f}\nF0 {f0:.2f}, light off by {error:.0%}"
        print(f"{name}, known light {known}:", text.replace("\n", "; "))
        np.place(shown := np.full(mask.shape, np.nan), mask, roughness)
        panel.set(title=f"{name}, light {'known' if known else 'unknown'}", xlabel=text, xticks=[], yticks=[])
        image = panel.imshow(shown, vmin=0.3, vmax=1.0)
    plt.colorbar(image, ax=axes[-1], label="roughness")
plt.savefig("recover_material.png")
