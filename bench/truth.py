"""Exact shadows of a frame: rays to the light from every visible point, against Embree 4; and `umbriel compare` as a whole."""

import json
import statistics
import subprocess
import tempfile
from pathlib import Path

import install
from measure import ROOT, THREADS, Failed, Row, build_ours, cargo, median, pairs, run, say

FOLDER = ROOT / "bench/truth"
# The scene of `bench/run shadow`.
SCENES = ROOT / "out/shadow"
TRIANGLES = 100_000
SIZE = "1280x720"
# Milliseconds of wall time for the points and the truth of a light without size.
GOAL_MS = 150
PEERS = ("embree16", "embree16-robust")


def make_scene():
    """The path of the scene file."""
    SCENES.mkdir(parents=True, exist_ok=True)
    command = [str(install.rasterisers()), "-B", str(ROOT / "bench/shadow/scene.py"), str(SCENES), str(TRIANGLES)]
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    if done.returncode != 0:
        raise Failed(f"scene.py ended with {done.returncode}:\n{done.stderr[-2000:]}")
    return done.stdout.strip()


def measured(program, scene, threads, rounds):
    """What the program prints."""
    command = [str(part) for part in (program, scene, install.embree(), threads, rounds)]
    say(" ".join(command[1:]))
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    if done.returncode != 0:
        raise Failed(f"`{' '.join(command)}` ended with {done.returncode}:\n{done.stderr[-2000:]}")
    return json.loads(done.stdout)


def truth_rows(found, threads):
    """Rays against rays, and points and rays against the goal."""
    rounds = found["rounds"]
    middle = lambda figure: statistics.median(figure(one) for one in rounds)
    words = f"{TRIANGLES // 1000}k, {SIZE}, {threads} thread{'s' if threads > 1 else ''}"
    rows = []
    for peer in PEERS:
        ours, theirs = middle(lambda r: r["truth"]["cpu"]), middle(lambda r: r[peer]["time"]["cpu"])
        paired = middle(lambda r: r[peer]["time"]["cpu"] / r["truth"]["cpu"])
        other, asked = rounds[0][peer]["other"], rounds[0]["questions"]
        note = f"{other} of {asked} answers differ"
        rows.append(Row(f"{words}, rays to the light", "CPU-ms", ours, peer, theirs, paired=paired, note=note))
    whole = lambda kind: middle(lambda r: r["points"][kind] + r["truth"][kind])
    rows.append(Row(f"{words}, points and rays", "ms", whole("wall"), f"goal {GOAL_MS} ms", GOAL_MS, 1.0 if threads > 1 else None))
    return rows


def end_to_end(program, scene, repetitions):
    """`compare` against the three commands that give a part of what it says."""
    with tempfile.TemporaryDirectory() as folder:
        one, two = Path(folder) / "maps.png", Path(folder) / "rays.png"
        picture = lambda method, path: run([program, "render", scene, "-q", "-r", SIZE, "-m", method, "-s", 1, "-o", path])

        def apart():
            parts = [picture("shadow-map", one), picture("ray-cast", two), run([program, "diff", one, two])]
            parts[0].wall = sum(part.wall for part in parts)
            return parts[0]

        ours, theirs = pairs(lambda: run([program, "compare", scene, "-q", "-r", SIZE]), apart, repetitions)
    wall = lambda one: 1e3 * one.wall
    return [Row(f"{TRIANGLES // 1000}k, {SIZE}, `umbriel compare`", "ms", median(ours, wall), "two renders and a diff", median(theirs, wall))]


def run_bench(repetitions):
    """The benchmark `truth`."""
    program, ours, scene = cargo([], FOLDER) / "bench-truth", build_ours(), make_scene()
    rows = []
    for threads in sorted({1, THREADS}):
        rows += truth_rows(measured(program, scene, threads, repetitions), threads)
    return rows + end_to_end(ours, scene, repetitions)
