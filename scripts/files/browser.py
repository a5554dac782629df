"""Files of programs that run in a browser, or in node."""

import json
import shutil
import subprocess
import sys
import threading
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

import numpy as np
from PIL import Image

import marker
from cases import Case, Check, Skipped, Wrong

BROWSERS = ["chromium", "chromium-browser", "google-chrome", "google-chrome-stable"]
FLAGS = ["--headless", "--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
# Seconds for the whole page.
PAGE_SECONDS = 90
ATLAS_SIDE = 512

BUNDLE = """
import { build } from 'esbuild';
await build({ entryPoints: ['writers.js'], bundle: true, format: 'esm', outfile: process.argv[2], logLevel: 'error' });
"""

# A cube of the marker in floats by ktx-parse, along the axes of the world: face, then rows from the top.
KTX = """
import { writeFileSync } from 'node:fs';
import { write, createDefaultContainer, KHR_DF_MODEL_RGBSDA, KHR_DF_TRANSFER_LINEAR, VK_FORMAT_R32G32B32A32_SFLOAT } from 'ktx-parse';
const side = 32;
const texels = new Float32Array(6 * side * side * 4);
for (let face = 0; face < 6; face++) {
    for (let y = 0; y < side; y++) for (let x = 0; x < side; x++) {
        const [s, t] = [2 * (x + 0.5) / side - 1, 2 * (y + 0.5) / side - 1];
        const d = [[1, -t, -s], [-1, -t, s], [s, 1, t], [s, -1, -t], [s, -t, 1], [-s, -t, -1]][face];
        const length = Math.hypot(...d);
        const color = [2 + d[0] / length, 1 + d[1] / length / 2, 0.5 + d[2] / length / 4, 1];
        texels.set(color, 4 * (face * side * side + y * side + x));
    }
}
const file = createDefaultContainer();
Object.assign(file, { vkFormat: VK_FORMAT_R32G32B32A32_SFLOAT, typeSize: 4, pixelWidth: side, pixelHeight: side, faceCount: 6, levelCount: 1 });
file.levels = [{ levelData: new Uint8Array(texels.buffer), uncompressedByteLength: texels.byteLength }];
Object.assign(file.dataFormatDescriptor[0], { colorModel: KHR_DF_MODEL_RGBSDA, transferFunction: KHR_DF_TRANSFER_LINEAR, bytesPlane: [16, 0, 0, 0, 0, 0, 0, 0] });
writeFileSync(process.argv[2], write(file));
"""


class Site(ThreadingHTTPServer):
    """Serves the page and the marker from the current folder, and keeps what the page posts."""

    def __init__(self):
        super().__init__(("127.0.0.1", 0), Visit)
        self.posted = {}
        self.is_done = threading.Event()


class Visit(SimpleHTTPRequestHandler):
    def do_POST(self):
        name = self.path.strip("/")
        self.server.posted[name] = self.rfile.read(int(self.headers.get("Content-Length", 0)))
        self.send_response(204)
        self.end_headers()
        if name == "done":
            self.server.is_done.set()

    def log_message(self, *arguments):
        pass


class Browser:
    """The page of writers.js, run once; `packages` is the folder of node's packages."""

    def __init__(self, packages):
        self.packages = packages
        self.posted = {}

    def node(self, script, *arguments):
        if self.packages is None:
            raise Skipped("node or its packages are missing")
        command = ["node", "--input-type=module", "-", *arguments]
        done = subprocess.run(command, input=script, cwd=self.packages, capture_output=True, text=True, timeout=100)
        if done.returncode != 0:
            raise RuntimeError(done.stderr[-400:])

    def start(self):
        """Runs the page."""
        browser = next((name for name in BROWSERS if shutil.which(name)), None)
        if self.packages is None or browser is None:
            return
        for name, image in (("g.raw", marker.marker()), ("lamps.raw", marker.lamps())):
            with_alpha = np.concatenate([image, np.ones((marker.HEIGHT, marker.WIDTH, 1), np.float32)], -1)
            Path(name).write_bytes(with_alpha.tobytes())
        shutil.copy(Path(__file__).with_name("writers.js"), self.packages)
        self.node(BUNDLE, str(Path("writers.js").resolve()))
        Path("writers.html").write_text("<!doctype html><meta charset=utf-8><body><script type=module src=writers.js></script>")
        site = Site()
        threading.Thread(target=site.serve_forever, daemon=True).start()
        command = [browser, *FLAGS, f"--user-data-dir={Path('profile').resolve()}", f"http://127.0.0.1:{site.server_port}/writers.html"]
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        site.is_done.wait(PAGE_SECONDS)
        process.terminate()
        process.wait()
        site.shutdown()
        self.posted = site.posted or {"": b""}

    def file(self, name):
        """Writes a file of the page."""
        if not self.posted:
            raise Skipped("Chromium, node or its packages are missing")
        error = self.posted.get(f"{name}.error", b"the page did not come to it")
        if name not in self.posted:
            raise Wrong(error.decode())
        Path(name).write_bytes(self.posted[name])
        return name


def judged(reader, file, *flags, environment="g.exr"):
    """What check-bake says of a file."""
    done = reader.run("check-bake", *flags, f"specular={file}", "--environment", environment, "--json")
    if not done.stdout:
        raise Wrong(done.stderr)
    return json.loads(done.stdout)


def rms(judgement, level):
    return 100 * judgement["levels"][level]["relmse"] ** 0.5


def causes(judgement):
    """What the verdict names, one sentence."""
    return "; ".join(cause["words"] for cause in judgement["causes"])


def expect(is_right, found):
    if not is_right:
        raise Wrong(found)
    return found


def cases(reader, packages):
    browser = Browser(packages)
    browser.start()

    def env(name):
        """Level 0 has its texels at corners: half a texel of 64 along a face."""
        found = judged(reader, browser.file(name))
        first, wide = rms(found, 0), rms(found, 3)
        sh = 100 * found["sh"]["relmse"] ** 0.5
        return expect(first < 2 and wide < 2 and sh < 1, f"{first:.2g} %, {wide:.2g} %, SH {sh:.2g} %")

    def atlas():
        texels = np.frombuffer(Path(browser.file("playcanvas.rgba")).read_bytes(), np.uint8).reshape(ATLAS_SIDE, ATLAS_SIDE, 4)
        Image.fromarray(texels, "RGBA").save("playcanvas.png")
        found = judged(reader, "playcanvas.png")
        first, wide = rms(found, 0), rms(found, 3)
        return expect(first < 2 and wide < 5, f"{first:.2g} %, {wide:.2g} %")

    def widths():
        """Levels of roughness 2k/11 that are read at k/5."""
        texels = np.frombuffer(Path(browser.file("playcanvas-lamps.rgba")).read_bytes(), np.uint8).reshape(ATLAS_SIDE, ATLAS_SIDE, 4)
        Image.fromarray(texels, "RGBA").save("playcanvas-lamps.png")
        found = causes(judged(reader, "playcanvas-lamps.png", environment="lamps.exr"))
        return expect("roughness k/(n - 1/2)" in found, found)

    def vtk():
        """Widths k/5 of levels that are read at k/4, by samples that read a lat-long map's mips 1.79 levels too blurred."""
        script = Path(__file__).with_name("vtk_levels.py")
        done = subprocess.run([sys.executable, script, "small-lamps.hdr", "vtk"], capture_output=True, text=True, timeout=300)
        if done.returncode != 0:
            raise Skipped(f"VTK has no driver: {done.stderr[-200:]}")
        found = judged(reader, "vtk", "--preset", "vtk", environment="small-lamps.hdr")
        named = ["roughness k/n, and read at k/(n - 1)", "mips of the lat-long map"]
        return expect(all(words in causes(found) for words in named), causes(found))

    def cube():
        browser.node(KTX, str(Path("ktx-parse.ktx2").resolve()))
        return "ktx-parse.ktx2"

    return [
        Case("Babylon.js .env as an environment", lambda: browser.file("babylon-png.env"), tolerance=0.02),
        Check("Babylon.js .env by check-bake", lambda: env("babylon-png.env"), "levels 0 and 3 within 2 %, SH within 1 %"),
        Check("Babylon.js .env of WebP by check-bake", lambda: env("babylon-webp.env"), "levels 0 and 3 within 2 %, SH within 1 %"),
        Check("PlayCanvas atlas by check-bake", atlas, "level 0 within 2 %, level 3 within 5 %"),
        Check("PlayCanvas' widths by check-bake", widths, "k/(n - 1/2)"),
        Case("gainmap-js JPEG", lambda: browser.file("gainmap.jpg"), tolerance=0.05),
        Check("VTK's levels by check-bake", vtk, "k/n, and coarse mips of the lat-long map"),
        Case("ktx-parse cube", cube, says="+x+y+z"),
    ]
