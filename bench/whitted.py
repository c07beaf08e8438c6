"""Whitted's picture of 1979: time from file to PNG, tracing alone, and memory."""

import json
import re
import tempfile
from pathlib import Path

import install
from measure import ROOT, THREADS, Failed, Row, build_ours, check_png, median, pairs, run, say

SIZE = (640, 480)
DEPTH = 10
# Our scene, and POV-Ray's and Mitsuba's variant of theirs, for the same picture.
VARIANTS = {
    "hollow glass": (ROOT / "scenes/whitted.toml", 1),
    "solid glass": (ROOT / "bench/scenes/whitted_solid.toml", 0),
}
PEERS = ROOT / "bench/peers"
GOAL_MS = 30
GOAL_MIB = 25
GOAL_TRACING = 4.0


class Whitted:
    """The commands; all write into one temporary folder."""

    def __init__(self, folder):
        self.folder = Path(folder)
        self.program = build_ours()
        self.povray_program = install.povray()
        self.python = install.mitsuba()
        self.llvm = install.llvm()

    def checked(self, command, picture, environment=None):
        """Runs a command from nothing to a picture."""
        picture.unlink(missing_ok=True)
        result = run(command, environment)
        check_png(picture, *SIZE)
        return result

    def ours(self, scene, spp=1, threads=0):
        """Our program; threads 0 is all."""
        picture = self.folder / "ours.png"
        command = [self.program, "render", scene, "-o", picture, "-r", "{}x{}".format(*SIZE)]
        return self.checked(command + ["-s", spp, "--depth", DEPTH, "-t", threads, "--json"], picture)

    def povray(self, hollow, spp=1, threads=THREADS):
        """POV-Ray; 16 samples a pixel are its adaptive method with threshold 0 and a grid of 4x4 without jitter."""
        picture = self.folder / "povray.png"
        sampling = {1: ["-A"], 16: ["+A0.0", "+AM1", "+R4", "-J"]}[spp]
        command = [self.povray_program, f"+I{PEERS / 'whitted.pov'}", f"+O{picture}", "-D", f"Declare=HOLLOW={hollow}"]
        return self.checked(command + ["+W{}".format(SIZE[0]), "+H{}".format(SIZE[1]), f"+WT{threads}", *sampling], picture)

    def mitsuba(self, hollow, variant):
        """Mitsuba's Python process: import, load, render 1 sample a pixel, write."""
        picture = self.folder / "mitsuba.png"
        llvm = {"DRJIT_LIBLLVM_PATH": str(self.llvm)} if self.llvm else {}
        command = [self.python, PEERS / "whitted_mitsuba.py", variant, hollow, picture]
        return self.checked(command, picture, environment={"HOME": str(install.FOLDER)} | llvm)

    def peers(self, hollow):
        """Name and command of each peer for one whole picture."""
        yield "POV-Ray 3.7", lambda: self.povray(hollow)
        if self.llvm:
            yield "Mitsuba 3 llvm_ad_rgb", lambda: self.mitsuba(hollow, "llvm_ad_rgb")
        yield "Mitsuba 3 scalar_rgb", lambda: self.mitsuba(hollow, "scalar_rgb")


def tracing_seconds(result):
    """CPU seconds that POV-Ray counts for tracing."""
    found = re.search(r"Trace Time:.*\n.*?with ([\d.]+) CPU-seconds", result.output)
    if found is None:
        raise Failed("POV-Ray did not print its tracing time")
    return float(found[1])


def render_seconds(result):
    """No less than the CPU seconds of our own tracing with one thread.

    Both the phase `render`, which is wall time, and the CPU time of the whole process are upper bounds; on a busy
    machine the second is the closer one.
    """
    phase = json.loads(result.output.strip().splitlines()[-1])["phases"]["render"]
    return min(phase, result.cpu)


def whole_process(bench, name, scene, hollow, repetitions):
    """Rows for the process from file to PNG, and for its memory."""
    times, memory = [], []
    for peer, command in bench.peers(hollow):
        say(f"whole process, {name}, ours and {peer}")
        ours, theirs = pairs(lambda: bench.ours(scene), command, repetitions)
        wall = [median(runs, lambda run: run.wall * 1000) for runs in (ours, theirs)]
        peak = [median(runs, lambda run: run.peak_mib) for runs in (ours, theirs)]
        times.append(Row(f"file to PNG, {name}", "ms", wall[0], peer, wall[1]))
        memory.append(Row(f"peak memory, {name}", "MiB", peak[0], peer, peak[1]))
    # Goals are held against the worst of our medians.
    slowest, largest = max(row.ours for row in times), max(row.ours for row in memory)
    times.append(Row(f"file to PNG, {name}", "ms", slowest, f"goal {GOAL_MS} ms", GOAL_MS, 1.0))
    memory.append(Row(f"peak memory, {name}", "MiB", largest, f"goal {GOAL_MIB} MiB", GOAL_MIB, 1.0))
    return times + memory


def tracing(bench, name, scene, hollow, spp, repetitions):
    """The row for tracing alone, one thread on both sides."""
    say(f"tracing, {name}, {spp} samples a pixel")
    ours, theirs = pairs(lambda: bench.ours(scene, spp, 1), lambda: bench.povray(hollow, spp, 1), repetitions)
    figures = (median(ours, render_seconds) * 1000, median(theirs, tracing_seconds) * 1000)
    case = f"tracing, {name}, {spp} spp"
    return Row(case, "CPU-ms", figures[0], "POV-Ray 3.7", figures[1], GOAL_TRACING)


def bench_rows(bench, repetitions):
    """All rows, in the order in which they are measured."""
    rows = []
    for name, (scene, hollow) in VARIANTS.items():
        rows += whole_process(bench, name, scene, hollow, repetitions)
        rows += [tracing(bench, name, scene, hollow, spp, repetitions) for spp in (1, 16)]
    return rows


def run_bench(repetitions):
    """The benchmark `whitted`."""
    with tempfile.TemporaryDirectory() as folder:
        return bench_rows(Whitted(folder), repetitions)
