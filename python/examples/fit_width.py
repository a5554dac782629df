"""Fits the lookup of a prefiltered GGX map to a BRDF of your own: its width and its direction.

Replace `brdf` by yours. The fit needs no environment; docs/research.md has its objective.
"""

import matplotlib.pyplot as plt
import numpy as np
import splitsum


def brdf(l, v, alpha):
    """Returns the BRDF of Burley's distribution with exponent 1.5, for F = 1 and directions l, an array (n, 3)."""
    h = l + v
    h /= np.linalg.norm(h, axis=-1, keepdims=True)
    d = (1 + (alpha**2 - 1) * h[:, 2] ** 2) ** -1.5

    def visible(cosine):  # Schlick's masking
        return cosine / (cosine * (1 - alpha / 2) + alpha / 2)

    return d * visible(l[:, 2]) * visible(v[2]) / (4 * l[:, 2] * v[2])


def fit(n_dot_v, alpha):
    """Fits one lookup for a view."""
    v = np.array([np.sqrt(1 - n_dot_v**2), 0, n_dot_v])
    return splitsum.fit_taps(lambda l: brdf(l, v, alpha) * l[:, 2], n_dot_v, alpha, levels=6)


views = np.linspace(0.05, 0.95, 19)
_, (widths, places, gains) = plt.subplots(3, 1, sharex=True, figsize=(6, 8), layout="constrained")
for alpha in [0.2, 0.35, 0.5]:
    fits = [fit(n_dot_v, alpha) for n_dot_v in views]
    widths.plot(views, [fit.alpha[0] / alpha for fit in fits], label=f"alpha {alpha}")
    places.plot(views, [fit.place[0] for fit in fits])
    gains.plot(views, [fit.objective / fit.textbook_objective for fit in fits])
    middle = fits[len(fits) // 2]
    print(f"alpha {alpha}, n·v 0.5: look up alpha {middle.alpha[0]:.3f} at {middle.place[0]:.2f} from n (0) to r (1)")
for axes in (widths, places, gains):
    axes.axhline(1, color="black", linewidth=0.8)
widths.set_ylabel("width of the lookup / alpha")
places.set_ylabel("direction, from n (0) to r (1)")
gains.set_ylabel("objective / textbook's")
gains.set_xlabel("n·v")
widths.legend()
plt.savefig("fit_width.png")
