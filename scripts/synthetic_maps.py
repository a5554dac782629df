"""Makes six environments of simple shapes, to try predictions under light that no answer rests on:

    python3 scripts/synthetic_maps.py OUT

OUT/NAME.hdr are lat-long maps of 256x128 texels: a clear and an overcast sky, a low sun, a room with windows, a hall of lamps, a
night street. docs/recovery.md says what they are for. Each texel is a formula of its direction, so every machine makes the same files.
"""

import math
import sys
from pathlib import Path

WIDTH, HEIGHT = 256, 128


def mixed(a, b, share):
    return tuple(x + share * (y - x) for x, y in zip(a, b))


def scaled(color, factor):
    return tuple(factor * x for x in color)


def added(*colors):
    return tuple(map(sum, zip(*colors)))


def unit(x, y, z):
    length = math.sqrt(x * x + y * y + z * z)
    return x / length, y / length, z / length


def lobe(direction, axis, sharpness):
    """1 towards the axis, e^-1 where 1 - cos is 1/sharpness."""
    cosine = sum(a * b for a, b in zip(direction, axis))
    return math.exp(sharpness * (cosine - 1.0))


def smooth(x, low, high):
    x = min(max((x - low) / (high - low), 0.0), 1.0)
    return x * x * (3.0 - 2.0 * x)


def clouds(direction, scale):
    """A sum of waves, about 0 to 1."""
    x, y, z = (scale * component for component in direction)
    waves = [
        math.sin(1.7 * x + 0.6 * z) * math.sin(1.1 * y + 2.0),
        0.5 * math.sin(3.1 * z - 1.3 * x + 1.0) * math.sin(2.9 * y + 0.7 * x),
        0.25 * math.sin(6.3 * x + 5.1 * y) * math.sin(5.7 * z + 0.3),
    ]
    return 0.5 + 0.5 * sum(waves) / 1.75


def ground(direction, color):
    return scaled(color, 0.7 + 0.6 * clouds(direction, 5.0))


def clear_sky(d):
    sun = unit(0.5, 0.8, -0.3)
    sky = mixed((0.9, 1.0, 1.1), (0.25, 0.45, 0.9), smooth(d[1], 0.0, 0.8))
    earth = ground(d, (0.25, 0.2, 0.12))
    glow = scaled((1.0, 0.9, 0.7), 3.0 * lobe(d, sun, 30.0) + 900.0 * lobe(d, sun, 1500.0))
    return added(mixed(earth, sky, smooth(d[1], -0.02, 0.02)), glow)


def overcast(d):
    sky = scaled((0.95, 1.0, 1.05), (1.0 + 2.0 * max(d[1], 0.0)) / 3.0 * (0.6 + 0.8 * clouds(d, 3.0)))
    return mixed(ground(d, (0.12, 0.13, 0.1)), scaled(sky, 2.0), smooth(d[1], -0.05, 0.05))


def low_sun(d):
    sun = unit(-0.9, 0.12, 0.4)
    sky = mixed((1.4, 0.6, 0.25), (0.12, 0.2, 0.5), smooth(d[1], -0.05, 0.5))
    glow = scaled((1.0, 0.6, 0.25), 4.0 * lobe(d, sun, 12.0) + 250.0 * lobe(d, sun, 1500.0))
    return added(mixed(ground(d, (0.1, 0.08, 0.07)), added(sky, glow), smooth(d[1], -0.02, 0.03)))


def room(d):
    """Two windows, a bright ceiling, a wooden floor."""
    walls = scaled((0.5, 0.45, 0.4), 0.8 + 0.4 * clouds(d, 4.0))
    azimuth = math.atan2(d[0], -d[2])
    rows = smooth(d[1], -0.1, -0.07) * (1.0 - smooth(d[1], 0.45, 0.48))
    light = walls
    for middle, width, strength in [(-1.2, 0.35, 14.0), (0.4, 0.5, 9.0)]:
        across = 1.0 - smooth(abs(azimuth - middle), width, width + 0.03)
        light = mixed(light, scaled((0.85, 0.95, 1.1), strength), across * rows)
    light = mixed(light, (0.9, 0.85, 0.75), smooth(d[1], 0.8, 0.85))
    return mixed(light, ground(d, (0.3, 0.17, 0.08)), smooth(-d[1], 0.6, 0.65))


def hall(d):
    """Twenty lamps below a ceiling."""
    light = scaled((0.3, 0.3, 0.33), 0.5 + clouds(d, 3.0))
    for i in range(20):
        lamp = unit(math.cos(2.4 * i), 0.25 + 0.045 * i, math.sin(2.4 * i))
        light = added(light, scaled((25.0, 22.0, 16.0), lobe(d, lamp, 300.0)))
    return light


def street(d):
    """A dark sky, lit walls up to a height, and a few strong lamps of several colours."""
    azimuth = math.atan2(d[0], -d[2])
    height = 0.3 + 0.15 * math.sin(3.0 * azimuth) + 0.1 * math.sin(7.0 * azimuth + 1.0)
    walls = scaled((0.25, 0.17, 0.1), 0.3 + 1.2 * clouds(d, 9.0))
    light = mixed(walls, (0.01, 0.015, 0.03), smooth(d[1], height, height + 0.03))
    light = mixed(light, scaled((0.1, 0.09, 0.08), 0.5 + clouds(d, 7.0)), smooth(-d[1], 0.05, 0.1))
    colors = [(1.0, 0.7, 0.3), (1.0, 0.75, 0.4), (0.5, 0.8, 1.0), (1.0, 0.2, 0.1), (0.9, 0.9, 0.8)]
    for i, color in enumerate(colors):
        lamp = unit(math.cos(1.3 * i + 0.5), 0.1 + 0.1 * i, math.sin(1.3 * i + 0.5))
        light = added(light, scaled(color, 60.0 * lobe(d, lamp, 500.0)))
    return light


MAPS = {
    "clear-sky": clear_sky,
    "overcast": overcast,
    "low-sun": low_sun,
    "room": room,
    "hall": hall,
    "street": street,
}


def direction(column, row):
    theta = math.pi * (row + 0.5) / HEIGHT
    phi = 2.0 * math.pi * ((column + 0.5) / WIDTH - 0.5)
    return math.sin(theta) * math.sin(phi), math.cos(theta), -math.sin(theta) * math.cos(phi)


def rgbe(color):
    largest = max(color)
    if largest < 1e-32:
        return bytes(4)
    mantissa, exponent = math.frexp(largest)
    factor = 256.0 * mantissa / largest
    return bytes([*(min(int(factor * x), 255) for x in color), exponent + 128])


def write(path, radiance):
    with open(path, "wb") as file:
        file.write(f"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {HEIGHT} +X {WIDTH}\n".encode())
        for row in range(HEIGHT):
            file.write(b"".join(rgbe(radiance(direction(column, row))) for column in range(WIDTH)))


def main(out):
    out.mkdir(parents=True, exist_ok=True)
    for name, radiance in MAPS.items():
        write(out / f"{name}.hdr", radiance)


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(Path(sys.argv[1]))
