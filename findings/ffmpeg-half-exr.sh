#!/bin/sh
# ffmpeg 9.0.2 (PyPI imageio-ffmpeg 0.8.1), EXR by OpenEXR 3.5.3.
# Guess: ffmpeg reads EXR as floats, so a half-float EXR keeps its highlights wherever the same
#   picture as 32-bit EXR keeps them: `ffmpeg -i in.exr out.exr`, or raw gbrpf32le for a script.
# Seen: the 32-bit file passes exactly. The half-float file is clipped to 0..1: 7.5 becomes 1, -0.5
#   becomes 0, and .25 becomes .25002; EXR to EXR is clipped alike. The
#   decoder hands out 16-bit floats (gbrpf16le keeps 7.5); the scaler that ffmpeg inserts by itself
#   to reach 32 bits clips. No message, exit status 0.
# Hurt: half is the usual type of EXR: an environment keeps sky and loses sun and lamps; tests made
#   with 32-bit files pass.
# Avoid: convert with -vf zscale,format=gbrpf32le, or ask for gbrpf16le, or use oiiotool.
set -eu
t=$(mktemp -d)
trap 'rm -rf "$t"' EXIT
python3 -m pip -q --disable-pip-version-check install --root-user-action ignore \
    --target "$t/p" imageio-ffmpeg==0.8.1 OpenEXR==3.5.3 numpy==2.4.6 || exit 77
cd "$t"
PYTHONPATH="$t/p" python3 - <<'P'
import subprocess, sys
import imageio_ffmpeg, numpy as np, OpenEXR

exe = imageio_ffmpeg.get_ffmpeg_exe()
print(subprocess.run([exe, "-version"], capture_output=True, text=True).stdout.split("\n")[0][:24])

def ffmpeg(*args):
    return subprocess.run([exe, "-v", "error", "-y", "-i", *args], capture_output=True, check=True)

def raw(fmt, dtype, *filters):
    out = ffmpeg("in.exr", *filters, "-f", "rawvideo", "-pix_fmt", fmt, "-").stdout
    return np.frombuffer(out, dtype).astype(np.float32)

image = np.full((32, 32, 3), 7.5, np.float32)
image[:16] = 0.25
image[0] = -0.5
peak = {}
for kind in (np.float32, np.float16):
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    OpenEXR.File(header, {"RGB": image.astype(kind)}).write("in.exr")
    ffmpeg("in.exr", "out.exr")
    channels = OpenEXR.File("out.exr").channels()
    exr = np.concatenate([c.pixels.astype(np.float32).ravel() for c in channels.values()])
    got = {"raw gbrpf32le": raw("gbrpf32le", np.float32), "out.exr": exr,
           "zscale": raw("gbrpf32le", np.float32, "-vf", "zscale,format=gbrpf32le")}
    if kind is np.float16:
        got["raw gbrpf16le"] = raw("gbrpf16le", np.float16)
    for name, values in got.items():
        peak[kind, name] = values.max()
        print(f"{kind.__name__} EXR, {name}: {values.min():g} .. {values.max():g} "
              "(expected -0.5 .. 7.5)")
half = [peak[np.float16, k] for k in ("raw gbrpf32le", "out.exr")]
rest = [v for k, v in peak.items() if k[0] is np.float32 or k[1] in ("zscale", "raw gbrpf16le")]
if max(half) > 1.001 or min(rest) < 7.4:
    sys.exit("CHANGED: half-float EXR is no longer clipped, or others are")
print("still so: half-float EXR is clipped at 1, 32-bit EXR is not")
P
