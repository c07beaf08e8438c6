"""Shadow maps on the CPU: the pass from the light and the pass from the eye, against Mesa's rasterisers."""

import json
import os
import statistics
import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path

import install
from measure import ROOT, Failed, Row, cargo, say

FOLDER = ROOT / "bench/shadow"
# Scenes and pictures stay there to be looked at.
OUTPUT = ROOT / "out/shadow"
TRIANGLES = (10_000, 100_000, 1_000_000)
PEERS = ("llvmpipe", "lavapipe")
# Wall time is what counts; CPU time says the same on a busy machine.
UNITS = {"map": "ms", "eye": "ms", "frame": "ms", "cpu": "CPU-ms"}
# Mesa's drivers draw in the calling thread with 0, and with N in N more.
MESA_THREADS = {1: 0, 2: 2}
# Frames of one side before the other's turn: a busy moment meets all sides.
TURN = 3
# How many times llvmpipe's speed, by triangles, for whole frames on two threads.
GOALS = {10_000: 4.0, 100_000: 6.0, 1_000_000: 6.0}
# Greatest share of pixels that may be off by more than 16 of 255.
PIXELS_OFF = 1e-4


@dataclass(frozen=True)
class Cell:
    """One picture to draw."""

    triangles: int
    size: tuple[int, int]
    taps: int
    cull: bool

    def __str__(self):
        scene = f"{self.triangles // 1000}k" if self.triangles < 1_000_000 else f"{self.triangles // 1_000_000}M"
        taps = "3x3 PCF" if self.taps == 9 else "1 tap"
        return f"{scene}, {self.size[0]}x{self.size[1]}, {taps}{', culled' if self.cull else ''}"

    def picture(self, name):
        """Where a renderer's picture goes."""
        words = f"{self.triangles}_{self.size[1]}_{self.taps}{'_culled' if self.cull else ''}"
        return OUTPUT / f"{words}_{name}.png"


def cells(triangles):
    """All pictures of one scene."""
    sizes, taps = ((1280, 720), (1920, 1080)), (1, 9)
    return [Cell(triangles, size, tap, cull) for size in sizes for tap in taps for cull in (False, True)]


class Renderer:
    """A process that has loaded a scene and answers requests, see peer.py."""

    def __init__(self, name, command, environment=None):
        self.name, self.errors = name, tempfile.TemporaryFile("w+")
        pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "stderr": self.errors, "text": True}
        command = [str(part) for part in command]
        self.process = subprocess.Popen(command, env=os.environ | (environment or {}), **pipes)
        self.first = self.answer()
        self.words = self.first["name"]

    def answer(self):
        line = self.process.stdout.readline()
        if not line:
            self.errors.seek(0)
            raise Failed(f"{self.name} ended with {self.process.wait()}:\n{self.errors.read()[-2000:]}")
        return json.loads(line)

    def draw(self, cell, frames, picture=None):
        """Milliseconds of each frame by pass."""
        request = {"width": cell.size[0], "height": cell.size[1], "taps": cell.taps, "cull": cell.cull}
        request |= {"frames": frames, "picture": picture and str(picture)}
        print(json.dumps(request), file=self.process.stdin, flush=True)
        answer = self.answer()
        if "error" in answer:
            raise Failed(f"{self.name}: {answer['error']}")
        return answer

    def close(self):
        self.process.stdin.close()
        self.process.wait()


class Programs:
    """Ours and the peers' Python."""

    def __init__(self):
        self.python = install.rasterisers()
        self.ours = cargo([], FOLDER / "umbriel") / "bench-shadow"
        OUTPUT.mkdir(parents=True, exist_ok=True)

    def script(self, name, *arguments):
        """The command that runs one of the Python programs of this folder."""
        return [str(part) for part in (self.python, "-B", FOLDER / f"{name}.py", *arguments)]

    def output(self, name, *arguments):
        """What such a program prints."""
        done = subprocess.run(self.script(name, *arguments), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        if done.returncode != 0:
            raise Failed(f"{name}.py ended with {done.returncode}:\n{done.stderr[-2000:]}")
        return done.stdout.strip()

    def renderers(self, scene, threads):
        """Ours first."""
        environment = {"LP_NUM_THREADS": str(MESA_THREADS[threads]), "LIBGL_ALWAYS_SOFTWARE": "1"}
        found = [Renderer("umbriel", [self.ours, scene, threads])]
        share_words(Path(scene).with_suffix(".json"), found[0].first)
        found += [Renderer(name, self.script(name, scene), environment) for name in PEERS]
        return found


def share_words(path, first):
    """Adds Umbriel's views of the light, by the number of taps, and the tables of its shading to what the peers read of the scene."""
    words = json.loads(path.read_text())
    shared = {key: first[key] for key in ("maps", "albedo")}
    path.write_text(json.dumps(words | shared, indent=1) + "\n")


def rounds(renderers, cell, repetitions, pictures):
    """By renderer, the frames' times of each round."""
    found = {renderer.name: [] for renderer in renderers}
    for number in range(-(-repetitions // TURN)):
        for renderer in renderers:
            picture = cell.picture(renderer.name) if pictures and number == 0 else None
            found[renderer.name].append(renderer.draw(cell, TURN, picture))
    return found


def median(times, kind):
    """Of all rounds' frames."""
    return statistics.median(time for turn in times for time in turn[kind])


def on(threads):
    return f"{threads} thread{'s' if threads > 1 else ''}"


def speed_rows(cell, threads, times):
    """Each pass against each peer."""
    rows, ours = [], times["umbriel"]
    for peer in PEERS:
        for kind, unit in UNITS.items():
            turns = zip(ours, times[peer])
            paired = statistics.median(median([theirs], kind) / median([mine], kind) for mine, theirs in turns)
            goal = GOALS[cell.triangles] if (peer, kind, threads) == ("llvmpipe", "frame", 2) else None
            words = "frame" if kind == "cpu" else kind
            case = f"{cell}, {words}, {on(threads)}"
            figures = (median(ours, kind), peer, median(times[peer], kind))
            rows.append(Row(case, unit, *figures, goal, paired=paired))
    return rows


def picture_row(programs, cell):
    """How many pixels are not llvmpipe's."""
    off, pixels = map(int, programs.output("compare", cell.picture("umbriel"), cell.picture("llvmpipe")).split())
    most = PIXELS_OFF * pixels
    return Row(f"{cell}, picture", "pixels off", off, "llvmpipe", most, 1.0, paired=most / max(off, 1))


def scene_rows(programs, triangles, threads, repetitions):
    """All rows of one scene."""
    rows, renderers = [], programs.renderers(programs.output("scene", OUTPUT, triangles), threads)
    say("; ".join(renderer.words for renderer in renderers))
    try:
        for cell in cells(triangles):
            times = rounds(renderers, cell, repetitions, pictures=threads == 2)
            words = [f"{name} {median(turns, 'map'):.1f} + {median(turns, 'eye'):.1f}" for name, turns in times.items()]
            say(f"{cell}, {on(threads)}: {', '.join(words)} ms")
            rows += speed_rows(cell, threads, times)
            if threads == 2:
                rows.append(picture_row(programs, cell))
    finally:
        for renderer in renderers:
            renderer.close()
    return rows


def run_bench(repetitions):
    """The benchmark `shadow`."""
    programs, rows = Programs(), []
    for triangles in TRIANGLES:
        for threads in MESA_THREADS:
            rows += scene_rows(programs, triangles, threads, repetitions)
    return rows
