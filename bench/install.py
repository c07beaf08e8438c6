"""Finds the peers, or installs them from Debian and PyPI and says so."""

import glob
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

from measure import ROOT, say

FOLDER = ROOT / "bench/.peers"
MITSUBA = "mitsuba==3.9.1"
# Blender as a module; each version is for one version of Python.
CYCLES = "bpy==5.0.1"
# Carries Embree 4.4.0 as a shared library.
EMBREE = "embreex==4.4.0.post1"
# OpenGL and Vulkan for Python; pictures.
RASTERISERS = ("moderngl==5.12.0", "wgpu==0.32.0", "numpy", "pillow")
# Older ones abort in Mitsuba's code generation (15 and 16 on AVX-512 machines) or are untried.
OLDEST_LLVM = 19


class Missing(Exception):
    """A peer is not there and cannot be installed from here."""


def debian(package):
    """Installs a Debian package."""
    if shutil.which("apt-get") is None or os.geteuid() != 0:
        raise Missing(f"{package} is missing; as root: apt-get install {package}")
    say(f"installing from Debian: {package}")
    command = ["apt-get", "install", "-y", "--no-install-recommends", package]
    environment = os.environ | {"DEBIAN_FRONTEND": "noninteractive"}
    for attempt in (command, ["apt-get", "update"], command):
        done = subprocess.run(attempt, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        if attempt is command and done.returncode == 0:
            return
    raise Missing(f"apt-get install {package} failed:\n{done.stderr[-1000:]}")


def povray():
    """The POV-Ray program."""
    if shutil.which("povray") is None:
        debian("povray")
    return "povray"


def python_with(name, modules, packages):
    """The Python of a virtual environment of its own, made with the packages unless the modules are there."""
    python = FOLDER / name / "bin/python"
    if python.exists() and subprocess.run([python, "-c", f"import {modules}"]).returncode == 0:
        return python
    say(f"installing from PyPI into {FOLDER.relative_to(ROOT)}: {' '.join(packages)}")
    FOLDER.mkdir(exist_ok=True)
    for command in (
        [sys.executable, "-m", "venv", FOLDER / name],
        [python, "-m", "pip", "install", "--quiet", "--disable-pip-version-check", *packages],
    ):
        if subprocess.run(command, stdout=sys.stderr).returncode != 0:
            raise Missing(f"cannot install {packages[0]}: `{' '.join(map(str, command))}` failed")
    return python


def mitsuba():
    """The Python that has Mitsuba 3."""
    return python_with("mitsuba", "mitsuba", [MITSUBA, "numpy"])


def cycles():
    """The Python that has Cycles, or None, and a word about it, where PyPI has none for this Python."""
    try:
        return python_with("cycles", "bpy", [CYCLES])
    except Missing as error:
        say(f"{error}\n{CYCLES} is for Python 3.11; without it Cycles is left out")
        return None


def rasterisers():
    """The Python that draws through OpenGL and Vulkan, and Mesa's drivers that do it on the CPU."""
    drivers = {
        "libegl1": "/usr/lib/*/libEGL.so.1",
        "libgl1-mesa-dri": "/usr/lib/*/dri/swrast_dri.so",
        "mesa-vulkan-drivers": "/usr/share/vulkan/icd.d/lvp_icd*.json",
    }
    for package, file in drivers.items():
        if not glob.glob(file):
            debian(package)
    return python_with("rasterisers", "moderngl, numpy, PIL, wgpu", RASTERISERS)


def embree():
    """Embree's shared library out of a Python package, of which nothing else is used."""
    folder = FOLDER / "embree"
    if not list(folder.glob("embreex.libs/libembree4*")):
        say(f"installing from PyPI into {FOLDER.relative_to(ROOT)}: {EMBREE}")
        folder.mkdir(parents=True, exist_ok=True)
        options = ["--quiet", "--disable-pip-version-check", "--no-deps", "--only-binary=:all:"]
        command = [sys.executable, "-m", "pip", "install", *options, "--target", folder, EMBREE]
        if subprocess.run(command, stdout=sys.stderr).returncode != 0:
            raise Missing(f"cannot install Embree: `{' '.join(map(str, command))}` failed")
    found = list(folder.glob("embreex.libs/libembree4*"))
    if not found:
        raise Missing(f"no libembree4 inside {EMBREE}")
    return found[0]


def find_llvm():
    """The newest LLVM library that Mitsuba's fast variant can use, or None."""
    found = {}
    for path in Path("/usr/lib").glob("*/libLLVM*.so*"):
        version = re.fullmatch(r"libLLVM(?:-(\d+)\.so.*|\.so\.(\d+).*)", path.name)
        if version and int(version[1] or version[2]) >= OLDEST_LLVM:
            found[int(version[1] or version[2])] = path
    return found[max(found)] if found else None


def llvm():
    """As `find_llvm`, installed if Debian has it; None, and a word about it, otherwise."""
    if find_llvm() is None:
        try:
            debian(f"libllvm{OLDEST_LLVM}")
        except Missing as error:
            say(f"{error}\nwithout it Mitsuba is measured in its scalar variant only")
    return find_llvm()
