"""Environment maps as real programs write them."""

from pathlib import Path

import imagecodecs
import numpy as np
import OpenEXR

import marker
from cases import Case, Refusal
from marker import MARKER, Numbers, numbers_of
from programs import BIN, ffmpeg, installed, oiiotool, openexr, radiance, run

HALF_MAX = 65504.0
# Half floats keep 11 bits; Radiance's mantissas keep 8 bits of the brightest channel.
HALF, SHARED = 1e-3, 6e-3


def sources():
    """Writes the maps that the programs start from."""
    openexr("g.exr", {"RGB": marker.marker()})
    openexr("sun.exr", {"RGB": marker.sun()})
    openexr("lamps.exr", {"RGB": marker.lamps()})
    openexr("small-lamps.exr", {"RGB": marker.lamps(128, 64)})
    oiiotool("small-lamps.exr", "-o", "small-lamps.hdr")
    openexr("low-sun.exr", {"RGB": marker.sun(radiance=1000.0, sky=0.0)})
    dome = marker.marker()
    dome[marker.HEIGHT // 2:] = 0
    openexr("dome.exr", {"RGB": dome})
    oiiotool("g.exr", "-o", "g.hdr")


def by_oiio(name, *arguments, source="g.exr"):
    """A file that oiiotool makes of a map."""
    def make():
        oiiotool(source, *arguments, "-o", name)
        return name
    return make


def colour_spaces():
    """Files whose colour space is stated by colorInteropID, which OpenImageIO writes alone."""
    def labelled(space):
        return by_oiio(f"{space}.exr", "--iscolorspace", "lin_rec709_scene", "--tocolorspace", space)

    def contradicting():
        openexr("ap1.exr", {"RGB": marker.marker()}, chromaticities=(0.713, 0.293, 0.165, 0.83, 0.128, 0.044, 0.32168, 0.33767))
        oiiotool("ap1.exr", "--iscolorspace", "lin_rec709_scene", "-o", "both.exr")
        return "both.exr"

    linear = ["lin_ap1_scene", "lin_ap0_scene", "lin_rec2020_scene", "lin_p3d65_scene", "lin_adobergb_scene", "lin_ciexyzd65_scene"]
    encoded = ["srgb_rec709_scene", "srgb_p3d65_scene", "g22_rec709_scene", "acescct_ap1", "acescc_ap1"]
    return [
        Case("oiio lin_rec709_scene", labelled("lin_rec709_scene")),
        *[Case(f"oiio {space}", labelled(space), says=space) for space in linear],
        *[Refusal(f"oiio {space}", labelled(space), says=space) for space in encoded],
        Case("oiio label against chromaticities", contradicting, says="contradict"),
    ]


def storage():
    """Compressions, sample types, tiles, windows, orientations and layers."""
    def compressed(name):
        return by_oiio(f"{name}.exr", "--compression", name)

    def half(name):
        return by_oiio(f"half_{name}.exr", "-d", "half", "--compression", name)

    def tiles():
        oiiotool("g.exr", "-otex", "tiles.exr")
        return "tiles.exr"

    def environment():
        oiiotool("g.exr", "-oenv", "oenv.exr")
        return "oenv.exr"

    def trimmed():
        oiiotool("dome.exr", "-o:autotrim=1", "trimmed.exr")
        return "trimmed.exr"

    def dome_numbers():
        dome = marker.marker()
        dome[marker.HEIGHT // 2:] = 0
        return numbers_of(dome)

    def overscan():
        wide = np.pad(marker.marker(), ((8, 8), (8, 8), (0, 0)), constant_values=9)
        window = (np.array([-8, -8], np.int32), np.array([marker.WIDTH + 7, marker.HEIGHT + 7], np.int32))
        display = (np.zeros(2, np.int32), np.array([marker.WIDTH - 1, marker.HEIGHT - 1], np.int32))
        return openexr("overscan.exr", {"RGB": wide}, dataWindow=window, displayWindow=display)

    def turned(orientation, *undo):
        return by_oiio(f"turned{orientation}.exr", *undo, "--orientation", orientation)

    read = ["none", "rle", "zip", "zips", "piz", "pxr24"]
    new = ["zstd", "lj2k", "htj2k256", "htj2k32"]
    return [
        *[Case(f"oiio float {name}", compressed(name), tolerance=HALF) for name in read],
        *[Case(f"oiio half {name}", half(name), tolerance=2 * HALF) for name in ["piz", "b44", "b44a", "dwaa", "dwab"]],
        *[Refusal(f"oiio {name}", compressed(name), says=f"compressed by {name.upper()}") for name in new],
        Case("oiio texture tiles and levels", tiles),
        Case("oiio environment texture", environment),
        Case("oiio autotrim", trimmed, dome_numbers()),
        Case("openexr overscan", overscan, says="cropped"),
        Case("oiio orientation 2", turned(2, "--flop"), says="Orientation 2"),
        Case("oiio orientation 3", turned(3, "--rotate180"), says="Orientation 3"),
        Case("oiio orientation 4", turned(4, "--flip"), says="Orientation 4"),
        Case("oiio orientation 6", turned(6, "--rotate270"), says="Orientation 6"),
        Case("oiio orientation 8", turned(8, "--rotate90"), says="Orientation 8"),
    ]


def layers():
    """Files with several images, or with channels of other names."""
    def renamed(name, channels, *arguments):
        return by_oiio(name, *arguments, "--chnames", channels)

    def renderer():
        """Passes before the picture, by the alphabet."""
        oiiotool("g.exr", "--mulc", "0.25", "--chnames", "albedo.R,albedo.G,albedo.B", "g.exr", "--chnames", "beauty.R,beauty.G,beauty.B",
                 "--chappend", "-o", "passes.exr")
        return "passes.exr"

    def blender():
        oiiotool("g.exr", "--mulc", "0.25", "--chnames", "ViewLayer.AO.R,ViewLayer.AO.G,ViewLayer.AO.B", "g.exr", "--chnames",
                 "ViewLayer.Combined.R,ViewLayer.Combined.G,ViewLayer.Combined.B", "--chappend", "-o", "blender.exr")
        return "blender.exr"

    def parts():
        oiiotool("g.exr", "--mulc", "0.25", "--attrib", "oiio:subimagename", "albedo", "g.exr", "--attrib", "oiio:subimagename",
                 "rgba", "--siappend", "-o", "parts.exr")
        return "parts.exr"

    def named():
        return renderer() + "#albedo"

    def grey():
        oiiotool("g.exr", "--ch", "G", "--chnames", "Y", "-o", "grey.exr")
        return "grey.exr"

    green = Numbers(MARKER.mean[[1, 1, 1]], MARKER.slopes[[1, 1, 1]])
    return [
        Case("oiio beauty after albedo", renderer),
        Case("oiio Blender's Combined", blender),
        Case("oiio a layer by its name", named, MARKER.times(0.25)),
        Case("oiio parts", parts, says="part"),
        Case("oiio r g b", renamed("small.exr", "r,g,b")),
        Case("oiio Y alone", grey, green),
        Case("oiio alpha", by_oiio("alpha.exr", "--ch", "R,G,B,A=1")),
        Case("oiio alpha below 1", by_oiio("clear.exr", "--ch", "R,G,B,A=0.5"), says="Alpha is below 1"),
        Case("oiio depth beside colour", by_oiio("depth.exr", "--ch", "R,G,B,Z=7")),
    ]


def suns():
    """Bright suns, which half floats cannot hold."""
    bright, low = numbers_of(marker.sun()), numbers_of(marker.sun(radiance=1000.0, sky=0.0))
    cut = numbers_of(np.minimum(marker.sun(), HALF_MAX))

    def scaled():
        """pfstools divide a map above 65504 by a factor, and store it."""
        oiiotool("sun.exr", "-o", "sun.hdr")
        run("pfsoutexr", "scaled.exr", stdin=run(installed("pfsin"), "sun.hdr"))
        return "scaled.exr"

    # The library of halves of each program makes +infinity of 100000.
    flags = ("--clamp-invalid",)
    return [
        Case("oiio box filter", by_oiio("box.exr", "--resize:filter=box", "128x64", source="sun.exr"), bright, tolerance=5e-3),
        Refusal("oiio default filter rings", by_oiio("rings.exr", "--resize", "128x64", source="sun.exr"), says="negative"),
        Case("oiio float sun", by_oiio("float-sun.exr", source="sun.exr"), bright),
        Case("oiio half sun", by_oiio("half-sun.exr", "-d", "half", source="sun.exr"), cut, flags=flags, says="+infinity"),
        # DWAA loses a sun above the halves without a trace; below them it makes tiny negatives of the dark sky.
        Case("oiio DWAA sun", by_oiio("dwaa-sun.exr", "-d", "half", "--compression", "dwaa", source="low-sun.exr"), low,
             tolerance=0.05, says="lossy compression"),
        Case("ffmpeg half sun", by_ffmpeg("ffmpeg-sun.exr", "-format", "half", source="sun.exr"), cut, flags=flags, says="+infinity"),
        Case("pfstools half sun", scaled, bright.times(HALF_MAX / 1e5), says="environment_scale=1.52", tolerance=0.02),
    ]


def by_ffmpeg(name, *arguments, source="g.exr"):
    def make():
        ffmpeg("-i", source, *arguments, name)
        return name
    return make


def ffmpegs():
    return [
        Case("ffmpeg float", by_ffmpeg("ff.exr", "-pix_fmt", "gbrpf32le")),
        Case("ffmpeg half zip", by_ffmpeg("ffz.exr", "-format", "half", "-compression", "zip16"), tolerance=HALF),
        Case("ffmpeg hdr", by_ffmpeg("ff.hdr"), tolerance=SHARED),
        # docs/bringing-maps.md says that the first filter keeps a map, and that the second clips it at 1.
        Case("ffmpeg zscale", by_ffmpeg("zscaled.exr", "-vf", "zscale=128:64"), tolerance=5e-3),
        Case("ffmpeg scale", by_ffmpeg("clipped.exr", "-vf", "scale=128:64"), numbers_of(np.minimum(marker.marker(), 1.0)), tolerance=5e-3),
    ]


def radiances():
    """Radiance files by Radiance's own programs, pfstools and OpenImageIO."""
    def filtered(*arguments, name="pfilt.hdr"):
        def make():
            Path(name).write_bytes(radiance("pfilt", *arguments, "g.hdr"))
            return name
        return make

    def combined():
        Path("pcomb.pic").write_bytes(radiance("pcomb", "-s", 2, "g.hdr"))
        return "pcomb.pic"

    def columns(name, *flags):
        """Stores columns, and says so in the resolution: the picture stays as it is."""
        def make():
            Path(name).write_bytes(radiance("protate", *flags, "g.hdr"))
            return name
        return make

    def flat():
        Path("flat.hdr").write_bytes(radiance("ra_rgbe", "g.hdr"))
        return "flat.hdr"

    def xyz(*flags):
        def make():
            name = f"xyz{''.join(flags)}.hdr"
            Path(name).write_bytes(radiance("ra_xyze", *flags, "g.hdr"))
            return name
        return make

    return [
        Case("oiio hdr", lambda: "g.hdr", tolerance=SHARED),
        Case("pfilt with exposure", filtered("-1", "-e", 4), tolerance=SHARED, says="exposure 4"),
        Case("pfilt default exposure", filtered(name="halved.hdr"), tolerance=SHARED, says="exposure"),
        Case("pcomb .pic", combined, MARKER.times(2.0), tolerance=SHARED),
        Case("ra_rgbe flat", flat, tolerance=SHARED),
        Case("protate", columns("columns.hdr"), tolerance=SHARED),
        Case("protate -r", columns("columns-r.hdr", "-r"), tolerance=SHARED),
        Refusal("ra_xyze", xyz(), says="XYZE"),
        Case("ra_xyze -r", xyz("-r"), tolerance=SHARED),
    ]


def projections():
    """Cubes, and lat-long maps whose outermost texels lie on the edges."""
    def nodes(name):
        """The marker as exrenvmap lays it out: texel centres on the edges."""
        v, u = np.mgrid[0:marker.HEIGHT, 0:marker.WIDTH]
        theta, phi = np.pi * v / (marker.HEIGHT - 1), 2 * np.pi * (0.5 - u / (marker.WIDTH - 1))
        directions = np.stack([np.sin(phi) * np.sin(theta), np.cos(theta), np.cos(phi) * np.sin(theta)], -1)
        image = (marker.MEAN + directions @ marker.SLOPES.T).astype(np.float32)
        return openexr(name, {"RGB": image}, envmap=OpenEXR.ENVMAP_LATLONG)

    def converted(name, *arguments):
        def make():
            installed("exrenvmap")
            run("exrenvmap", *arguments, nodes(f"nodes-of-{name}"), name)
            return name
        return make

    def maketx():
        run(BIN / "maketx", "--envlatl", "g.exr", "-o", "maketx.exr")
        return "maketx.exr"

    edges = ("--texels", "edges")
    return [
        Case("openexr lat-long", lambda: nodes("nodes.exr"), flags=edges),
        Case("openexr lat-long without the flag", lambda: nodes("unflagged.exr"), says="--texels edges", tolerance=0.01),
        Case("exrenvmap lat-long", converted("latlong.exr", "-li", "-l"), flags=edges, tolerance=HALF),
        Case("exrenvmap cube", converted("cube.exr", "-li", "-c", "-w", "64"), tolerance=2 * HALF),
        Case("maketx lat-long", maketx, flags=("--texels", "centres")),
    ]


def gain_maps():
    """JPEG files by libultrahdr: eight bits, so that means are right within some per cent."""
    def ultrahdr(name, scale=1.0, gamut="BT_709"):
        def make():
            half = np.dstack([scale * marker.marker(), np.ones((marker.HEIGHT, marker.WIDTH))]).astype(np.float16)
            codes = imagecodecs.ULTRAHDR
            Path(name).write_bytes(imagecodecs.ultrahdr_encode(half, level=95, transfer=codes.CT.LINEAR, gamut=codes.CG[gamut]))
            return name
        return make

    def plain():
        oiiotool("g.exr", "-o", "plain.jpg")
        return "plain.jpg"

    return [
        Case("libultrahdr", ultrahdr("uhdr.jpg"), tolerance=0.02),
        Case("libultrahdr below white", ultrahdr("dark.jpg", scale=0.2), MARKER.times(0.2), tolerance=0.02),
        Case("libultrahdr Display P3", ultrahdr("p3.jpg", scale=0.2, gamut="DISPLAY_P3"), MARKER.times(0.2 * P3_TO_REC709),
             tolerance=0.02, says="ICC profile"),
        Refusal("oiio jpeg", plain, says="without a gain map"),
    ]


# Linear Display P3 to Rec.709.
P3_TO_REC709 = np.array([[1.22494, -0.22494, 0.0], [-0.04206, 1.04206, 0.0], [-0.01964, -0.07864, 1.09827]])


def texture_files(reader):
    """Cubes as environments, by splitsum's own writer; scripts/check-clients.sh draws the same files in engines."""
    def baked(engine, name, axes=""):
        def make():
            folder = Path(f"{engine}{len(axes)}")
            reader.run("bake", "g.exr", "--for", engine, "--set", "prefilter_size=64x64", "--out", folder)
            return f"{folder}/{name}{axes}"
        return make

    return [
        Case("KTX 2 cube for Bevy", baked("bevy", "specular.ktx2", "#+x+y-z"), tolerance=5e-3),
        Case("KTX 2 cube for the Khronos viewer", baked("khronos", "specular.ktx2", "#-z+y+x"), tolerance=5e-3),
        Case("KTX 2 cube without axes", baked("bevy", "specular.ktx2"), Numbers(MARKER.mean, MARKER.slopes * [1, 1, -1]),
             tolerance=5e-3, says="+x+y+z"),
        Case("KTX cube for Filament", baked("filament", "ibl.ktx", "#+x+y+z"), tolerance=5e-3),
        Case("DDS cube for Unity", baked("unity", "specular.dds", "#-x+y+z"), tolerance=5e-3),
    ]


def cases(reader):
    return [*colour_spaces(), *storage(), *layers(), *suns(), *ffmpegs(), *radiances(), *projections(), *gain_maps(), *texture_files(reader)]
