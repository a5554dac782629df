"""How each baker prefilters a map: what it writes, by which conventions, and its CPU seconds, user and system, of all its threads."""
import http.server
import os
import pathlib
import queue
import resource
import struct
import subprocess
import threading
import urllib.parse

HERE = pathlib.Path(__file__).parent
SIDE, LEVELS, SAMPLES = 256, 5, 1024  # of a face; of a cube and a texel, where a baker lets one choose
PATIENCE = 600  # seconds for one map


def child_seconds():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def run(*command, cwd=None):
    """CPU seconds of a command, its start included, and what it prints."""
    before = child_seconds()
    done = subprocess.run([str(word) for word in command], cwd=cwd, capture_output=True, text=True)
    if done.returncode:
        raise RuntimeError(f"{command[0]} ended with {done.returncode}: {(done.stderr or done.stdout).strip()[-400:]}")
    return child_seconds() - before, done.stdout


def tree_seconds(root):
    """CPU seconds so far of a process and its descendants."""
    parents, seconds = {}, {}
    for stat in pathlib.Path("/proc").glob("[0-9]*/stat"):
        try:
            fields = stat.read_text().rsplit(")", 1)[1].split()
        except OSError:
            continue
        pid = int(stat.parent.name)
        parents[pid], seconds[pid] = int(fields[1]), sum(map(int, fields[11:15])) / os.sysconf("SC_CLK_TCK")

    def is_inside(pid):
        return pid == root or (pid in parents and is_inside(parents[pid]))

    return sum(of for pid, of in seconds.items() if is_inside(pid))


class Baker:
    """`preset` is what check-bake takes. A baker with `is_whole` is timed from its start to its end; `makes` is what the time is for."""

    makes, is_whole = "cube", True

    def __init__(self, name, version, preset):
        self.name, self.version, self.preset = name, version, preset

    def close(self):
        pass


class Splitsum(Baker):
    """Ours, exact."""

    makes = "cube, irradiance map, SH, table, taps"

    def __init__(self, program):
        super().__init__("splitsum", run(program, "--version")[1].split()[1], "splitsum")
        self.program = program

    def bake(self, map, out):
        sizes = ["brdf=ggx", f"prefilter_size={SIDE}x{SIDE}", f"prefilter_level_count={LEVELS}"]
        sets = [word for size in sizes for word in ("--set", size)]
        return run(self.program, "bake", map, "--out", out, *sets)[0], out


class Cmgen(Baker):
    """Levels only, as Filament loads them. No other form serves: EXR overflows under a sun, and its DDS of 32 bits holds 3.0 everywhere."""

    def __init__(self, program, version):
        super().__init__("cmgen", version, "cmgen")
        self.program = program

    def bake(self, map, out):
        size = ["-s", SIDE, f"--ibl-samples={SAMPLES}"]
        return run(self.program, "-q", "-f", "ktx", *size, f"--ibl-ld={out}", map)[0], out / f"{out.name}_ibl.ktx"


class Khronos(Baker):
    """As its Python package runs it."""

    makes = "cube, table"

    def __init__(self, program, version):
        super().__init__("khronos", version, "khronos")
        self.program = program

    def bake(self, map, out):
        out.mkdir()
        files = ["-inputPath", map, "-outCubeMap", out / "specular.ktx2", "-outLUT", out / "lut.png"]
        size = ["-cubeMapResolution", SIDE, "-sampleCount", SAMPLES, "-mipLevelCount", LEVELS, "-targetFormat", "R32G32B32A32_SFLOAT"]
        return run(self.program, *files, *size, cwd=out)[0], out / "specular.ktx2"


def dds(side, levels, texels):
    """A cube of RGBA in 32 bits, face by face, each with its levels."""
    pixels = struct.pack("<8I", 32, 4, 116, 0, 0, 0, 0, 0)  # D3DFMT_A32B32G32R32F
    header = struct.pack("<7I44x", 124, 0x21007, side, side, 0, 0, levels)
    return b"DDS " + header + pixels + struct.pack("<5I", 0x401008, 0xFE00, 0, 0, 0) + texels


class Three(Baker):
    """three.js in Chromium, without start, compilation and upload; u is turned so that its cube has our axes, as cmgen's mirrored one."""

    is_whole = False

    def __init__(self, chromium, modules, work):
        super().__init__("three.js", "", "cmgen")
        self.modules, self.asked, self.said, self.map = modules, queue.Queue(), queue.Queue(), None
        baker = self

        class Handler(http.server.BaseHTTPRequestHandler):
            def reply(self, body=b"", kind="text/plain"):
                self.send_response(200)
                self.send_header("Content-Type", kind)
                self.end_headers()
                self.wfile.write(body)

            def do_GET(self):
                if self.path == "/":
                    self.reply((HERE / "three.html").read_bytes(), "text/html")
                elif self.path == "/next":
                    self.reply(baker.asked.get().encode())
                elif self.path == "/map.hdr":
                    self.reply(baker.map.read_bytes())
                elif self.path.startswith("/three/") and ".." not in self.path:
                    self.reply((modules / self.path[1:]).read_bytes(), "text/javascript")
                else:
                    self.send_error(404)

            def do_POST(self):
                seconds = tree_seconds(baker.browser.pid)
                body = self.rfile.read(int(self.headers["Content-Length"] or 0))
                self.reply()
                baker.said.put((self.path, seconds, body))

            def log_message(self, *_):
                pass

        self.server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Handler)
        threading.Thread(target=self.server.serve_forever, daemon=True).start()
        flags = ["--headless", "--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
        page = f"http://127.0.0.1:{self.server.server_port}/"
        self.log = open(work / "chromium.log", "w")
        self.browser = subprocess.Popen([chromium, *flags, f"--user-data-dir={work / 'profile'}", page], stdout=self.log, stderr=self.log)

    def heard(self, path):
        try:
            said, seconds, body = self.said.get(timeout=PATIENCE)
        except queue.Empty:
            raise RuntimeError(f"three.js: the page did not answer within {PATIENCE} s") from None
        if said.split("?")[0] != path:
            raise RuntimeError(f"three.js: {said} {body[:400].decode(errors='replace')}")
        return said, seconds, body

    def bake(self, map, out):
        self.map = map
        self.asked.put(map.stem)
        _, before, version = self.heard("/begin")
        self.version = version.decode()
        _, after, _ = self.heard("/end")
        said, _, texels = self.heard("/cube")
        query = urllib.parse.parse_qs(said.split("?")[1])
        file = out.with_suffix(".dds")
        file.write_bytes(dds(int(query["side"][0]), int(query["levels"][0]), texels))
        return after - before, file

    def close(self):
        self.asked.put("")
        self.browser.terminate()
        self.browser.wait()
        self.server.shutdown()
        self.log.close()
