"""Implicit surfaces: CPU time from file to PNG, beside POV-Ray's isosurfaces and closed forms."""

import json
import tempfile
from dataclasses import dataclass
from pathlib import Path

import install
from measure import ROOT, THREADS, Failed, Row, build_ours, check_png, median, pairs, run, say

SIZE = (640, 480)
PEER = ROOT / "bench/peers/implicit.pov"
# Pixels of the masks that may differ, of all: silhouettes by a rounding error, and what POV-Ray's accuracy of 1e-4 leaves out.
MASK_LIMIT = 1e-3


@dataclass
class Peer:
    """One of POV-Ray's ways to draw a shape; the gradient is the least round one with which the picture is right."""

    name: str
    shape: int
    gradient: float = 1.0
    goal: float | None = None


SHAPES = {
    "heart": [Peer("POV-Ray isosurface, gradient 60", 0, 60, 40.0), Peer("POV-Ray polynomial", 1, goal=1.0)],
    "torus": [Peer("POV-Ray isosurface, gradient 2", 2, 2, 12.0), Peer("POV-Ray torus", 3)],
    "gyroid": [Peer("POV-Ray isosurface, gradient 11", 4, 11)],
    "blob": [Peer("POV-Ray isosurface, gradient 2", 5, 2)],
}


class Implicit:
    """The commands; all write into one temporary folder."""

    def __init__(self, folder):
        self.folder = Path(folder)
        self.program = build_ours()
        self.povray_program = install.povray()

    def ours(self, shape, mask=False):
        """Our program by ray casting: a shadow ray at every hit, as POV-Ray's scene has it."""
        picture = self.folder / "ours.png"
        picture.unlink(missing_ok=True)
        scene = ROOT / f"bench/scenes/implicit_{shape}.toml"
        command = [self.program, "render", scene, "-o", picture, "-r", "{}x{}".format(*SIZE), "-s", "1"]
        looks = ["material.look.unlit=true", "material.look.base_color=1", "material.floor.unlit=true"]
        looks += ["material.floor.base_color=0", "environment.color=0"]
        masked = [part for look in looks for part in ("-D", look)] + ["--tonemap", "linear"]
        result = run(command + ["--method", "ray-cast", *(masked if mask else []), "-t", THREADS])
        check_png(picture, *SIZE)
        return result

    def povray(self, peer, mask=False):
        """POV-Ray with as many threads as we have."""
        picture = self.folder / "povray.png"
        picture.unlink(missing_ok=True)
        declared = {"SHAPE": peer.shape, "GRADIENT": peer.gradient, "MASK": int(mask)}
        command = [self.povray_program, f"+I{PEER}", f"+O{picture}", "-D", "-A", f"+WT{THREADS}"]
        command += [f"Declare={name}={value}" for name, value in declared.items()]
        result = run(command + ["+W{}".format(SIZE[0]), "+H{}".format(SIZE[1])])
        check_png(picture, *SIZE)
        return result

    def off(self, shape, peer):
        """The share of pixels where one sees the shape and the other does not."""
        self.ours(shape, mask=True), self.povray(peer, mask=True)
        pictures = [self.folder / "ours.png", self.folder / "povray.png"]
        done = run([self.program, "diff", *pictures, "--json", "--tolerance", "0.5"])
        return json.loads(done.output.strip().splitlines()[-1])["differing"] / (SIZE[0] * SIZE[1])


def rows_of(bench, shape, peers, repetitions):
    """Time and masks of one shape beside each of its peers."""
    for peer in peers:
        say(f"{shape}, ours and {peer.name}")
        off = bench.off(shape, peer)
        if off > MASK_LIMIT:
            raise Failed(f"{shape}: {off:.3%} of the pixels differ from {peer.name}")
        # The slowest isosurface takes half a minute.
        runs = min(repetitions, 3) if peer.gradient > 50 else repetitions
        ours, theirs = pairs(lambda: bench.ours(shape), lambda: bench.povray(peer), runs)
        figures = [median(side, lambda run: run.cpu * 1000) for side in (ours, theirs)]
        note = f"masks differ in {off:.3%}"
        yield Row(f"{shape}, file to PNG", "CPU-ms", figures[0], peer.name, figures[1], peer.goal, note=note)


def run_bench(repetitions):
    """The benchmark `implicit`."""
    with tempfile.TemporaryDirectory() as folder:
        bench = Implicit(folder)
        return [row for shape, peers in SHAPES.items() for row in rows_of(bench, shape, peers, repetitions)]
