"""The real programs: OpenImageIO, OpenEXR, ffmpeg and Radiance from PyPI, others if they are installed."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import imageio_ffmpeg
import OpenEXR
import pyradiance

from cases import Skipped

BIN = Path(sys.executable).parent
RADIANCE = Path(pyradiance.__file__).parent / "bin"


def run(*command, stdin=None):
    """Runs a program; returns its standard output as bytes."""
    done = subprocess.run([str(word) for word in command], input=stdin, capture_output=True, timeout=100)
    if done.returncode != 0:
        raise RuntimeError(f"{command[0]}: {done.stderr.decode(errors='replace')[-400:]}")
    return done.stdout


def installed(name):
    if shutil.which(name) is None:
        raise Skipped(f"{name} is missing")
    return name


def oiiotool(*arguments):
    return run(BIN / "oiiotool", *arguments).decode()


def ffmpeg(*arguments):
    return run(imageio_ffmpeg.get_ffmpeg_exe(), "-hide_banner", "-loglevel", "error", "-y", *arguments)


def radiance(program, *arguments, stdin=None):
    environment = {**os.environ, "RAYPATH": str(RADIANCE.parent / "lib")}
    command = [RADIANCE / program, *[str(word) for word in arguments]]
    done = subprocess.run(command, input=stdin, capture_output=True, timeout=100, env=environment)
    if done.returncode != 0:
        raise RuntimeError(f"{program}: {done.stderr.decode(errors='replace')[-400:]}")
    return done.stdout


def openexr(name, channels, **attributes):
    """Writes float or half arrays, by the names of their channels, with OpenEXR's own library."""
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage, **attributes}
    OpenEXR.File(header, channels).write(name)
    return name
