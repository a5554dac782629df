"""The files that splitsum writes, read back by OpenImageIO, OpenEXR and ffmpeg."""

from pathlib import Path

import numpy as np
import OpenEXR

from cases import Check, Wrong
from marker import MARKER
from programs import ffmpeg, installed, oiiotool, run

RADIANCE, DATA = "lin_rec709_scene", "data"


def expect(condition, found):
    if not condition:
        raise Wrong(f"got {found}")
    return str(found)


def label(file):
    """The colour interop ID, by OpenEXR's own library."""
    return OpenEXR.File(str(file)).header().get("colorInteropID")


def pixels(file):
    channels = OpenEXR.File(str(file)).channels()
    return next(channels[name].pixels[..., :3] for name in ("RGB", "RGBA") if name in channels)


def write(reader):
    """Bakes for any program and for an importer, and renders one picture."""
    commands = [
        ("bake", "g.exr", "--set", "brdf=ggx", "--set", "prefilter_size=64x64", "--set", "dfg_size=8", "--out", "plain"),
        ("bake", "g.exr", "--for", "raw", "--set", "prefilter_size=64x64", "--set", "dfg_size=8", "--out", "raw"),
        ("render", "--environment", "g.exr", "--method", "split-sum", "--size", "32x32", "--out", "ball.exr"),
    ]
    for command in commands:
        done = reader.run(*command)
        if done.returncode != 0:
            raise RuntimeError(f"splitsum {command[0]}: {done.stderr.strip()}")


def labels(folder, expected):
    def check():
        found = {path.name: label(path) for path in sorted(Path(".").glob(folder))}
        wrong = {name: ident for name, ident in found.items() if ident != expected}
        expect(found and not wrong, wrong or "no files")
        return f"{len(found)} files"
    return check


def by_oiio(file, shown):
    """OpenImageIO must not convert: the same numbers in its linear Rec.709 as ours."""
    def check():
        oiiotool(file, "--tocolorspace", "lin_rec709_scene", "-o", "shown.exr")
        off = np.abs(pixels("shown.exr") - pixels(file)).max()
        return expect((off < 1e-5) == shown, f"{off:.1e} off after --tocolorspace lin_rec709_scene")
    return check


def by_ffmpeg(file):
    def check():
        # Its own form: a conversion would clip at 1.
        form, planes = ("gbrapf32le", 4) if "RGBA" in OpenEXR.File(str(file)).channels() else ("gbrpf32le", 3)
        raw = ffmpeg("-i", file, "-f", "rawvideo", "-pix_fmt", form, "-")
        height, width = pixels(file).shape[:2]
        green, blue, red = np.frombuffer(raw, np.float32).reshape(planes, height, width)[:3]
        off = np.abs(np.stack([red, green, blue], -1) - pixels(file)).max()
        return expect(off < 1e-6, f"{off:.1e} off")
    return check


def by_exrheader():
    header = run(installed("exrheader"), "ball.exr").decode()
    return expect('colorInteropID (type string): "lin_rec709_scene"' in header, header[-200:] if "Interop" not in header else "its label")


def irradiance():
    """Level texels of the irradiance map: half of the marker's slopes times 4/3, and its mean."""
    faces = pixels("plain/irradiance_over_pi.exr")
    mean = faces.reshape(-1, 3).mean(0)
    return expect(np.abs(mean - MARKER.mean).max() < 2e-3, mean)


def names():
    """A shipped file must not tell the folders of its maker."""
    text = b"".join(path.read_bytes() for folder in ("away", "away-plain") for path in Path(folder).rglob("*") if path.is_file())
    return expect(b"private-folder" not in text, "no folder")


def table():
    values = pixels("raw/dfg.exr")
    return expect(values[..., 2].max() == 0 and 0.9 < values.sum(-1).max() <= 1.001, f"A + B up to {values.sum(-1).max():.4f}")


def cases(reader):
    def away():
        folder = Path("private-folder")
        folder.mkdir(exist_ok=True)
        (folder / "map.exr").write_bytes(Path("g.exr").read_bytes())
        for flags in (("--for", "khronos", "--out", "away"), ("--out", "away-plain")):
            done = reader.run("bake", folder.resolve() / "map.exr", "--set", "brdf=ggx", "--set", "prefilter_size=64x64", "--set", "dfg_size=8", *flags)
            expect(done.returncode == 0, done.stderr)
        return names()

    return [
        Check("pictures are labelled", labels("ball.exr", RADIANCE), RADIANCE),
        Check("levels are labelled", labels("raw/specular/*.exr", RADIANCE), RADIANCE),
        Check("maps are labelled", labels("plain/[ip]*.exr", RADIANCE), RADIANCE),
        Check("tables are labelled", labels("*/[dt][fa]*.exr", DATA), DATA),
        Check("OpenImageIO shows our picture", by_oiio("ball.exr", True), "0 off"),
        Check("OpenImageIO shows our map", by_oiio("plain/irradiance_over_pi.exr", True), "0 off"),
        Check("OpenImageIO shows our table", by_oiio("raw/dfg.exr", True), "0 off"),
        Check("exrheader reads our label", by_exrheader, RADIANCE),
        Check("ffmpeg reads our picture", by_ffmpeg("ball.exr"), "0 off"),
        Check("ffmpeg reads our table", by_ffmpeg("raw/dfg.exr"), "0 off"),
        Check("OpenEXR reads our irradiance", irradiance, MARKER.mean),
        Check("OpenEXR reads our table", table, "A + B up to 1, a third channel of 0"),
        Check("no folder in an asset", away, "no folder"),
    ]
