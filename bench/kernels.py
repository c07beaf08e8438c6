"""Rays and meshes: speed of single rays and packets, builds and memory, against Embree 4 and Rust crates."""

import json
import subprocess
from pathlib import Path

import install
from measure import ROOT, Failed, Row, cargo, say

FOLDER = ROOT / "bench/kernels"
MESHES = ("sphere", "terrain", "hall")
COHERENT = ("primary", "shadow")
# Pairs of ours and a peer. Goals stand where the build fits the mesh: splits through triangles for the hall.
SINGLE = (("umbriel", "embree-robust"), ("umbriel", "embree"))
SINGLE_HIGH = (("umbriel-high", "embree-robust"), ("umbriel-high", "embree"), ("umbriel-high", "embree-high"))
PACKETS = (("umbriel-packets", "embree16-robust"), ("umbriel-packets", "embree16"))
PACKETS_HIGH = (("umbriel-high-packets", "embree16-robust"), ("umbriel-high-packets", "embree16-high"))
CRATES = ("obvhs-cwbvh", "obvhs-bvh2", "bvh", "parry3d")
# Rays through this hall cost as much as a hundred elsewhere: fewer pixels a side there than 1024.
FEWER_RAYS = {("hall", 1_000_000): 512, ("hall", 5_000_000): 256}
GOAL_SINGLE = {"embree-robust": 1.25, "embree": 1.0}
GOAL_HALL = {"embree-robust": 2.5, "embree": 1.0}
GOAL_PACKETS = {"embree16-robust": 1.1}
GOAL_BYTES = 60


class Programs:
    """The binary as it ships and the one that is built for this machine, which the crates ask for."""

    def __init__(self):
        self.embree = install.embree()
        self.shipped = cargo([], FOLDER) / "bench-kernels"
        native = FOLDER / "target/native"
        environment = {"RUSTFLAGS": "-C target-cpu=native", "CARGO_TARGET_DIR": str(native)}
        self.native = cargo(["--features", "rust-peers"], FOLDER, environment) / "bench-kernels"

    def rows(self, program, mesh, size, peers, *options):
        """What the program prints, as dictionaries; `mesh` is a name or the path of a file."""
        chosen = ["--mesh", mesh, "--size", size] if mesh in MESHES else [Path(mesh).resolve()]
        if (mesh, size) in FEWER_RAYS and "--side" not in options:
            options = (*options, "--side", FEWER_RAYS[mesh, size])
        command = [program, "--json", "--embree", self.embree, "--peers", ",".join(peers), *options, *chosen]
        command = [str(part) for part in command]
        say(" ".join(["bench-kernels", *command[4:]]))
        done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        if done.returncode != 0:
            raise Failed(f"`{' '.join(command)}` ended with {done.returncode}:\n{done.stderr[-2000:]}")
        return [json.loads(line) for line in done.stdout.splitlines()]


def label(row):
    """Mesh and size; hundreds of triangles more or less do not matter."""
    count = row["triangles"]
    size = f"{count / 1e6:.1f}M" if count >= 950_000 else f"{count / 1e3:.0f}k"
    return f"{row['mesh']} {size}"


def differences(ours, theirs):
    """Rays that came out otherwise than for robust Embree."""
    words = []
    for name, row in (("ours", ours), ("theirs", theirs)):
        counts = [f"{row[key]} {key}" for key in ("missed", "extra", "other") if row[key]]
        if counts:
            words.append(f"{name}: {', '.join(counts)}")
    return "; ".join(words)


def speed_row(rows, kind, threads, ours, peer, goal):
    """Ours against one peer; None where one of them was not run."""
    found = {row["peer"]: row for row in rows if row["row"] == kind and row["threads"] == threads}
    if ours not in found or peer not in found:
        return None
    mine, theirs = found[ours], found[peer]
    how = ours.removeprefix("umbriel").removeprefix("-")
    case = f"{label(mine)}, {kind}{', ' + how if how else ''}, {threads} thread{'s' if threads > 1 else ''}"
    figures = {"paired": mine.get(f"per_{peer}"), "note": differences(mine, theirs)}
    return Row(case, "Mrays/CPU-s", mine["mrays"], peer, theirs["mrays"], goal, speed=True, **figures)


def speeds(rows, pairs, goals, threads=1, kinds=(*COHERENT, "bounce", "ao")):
    """Rows of all kinds for all pairs."""
    found = [speed_row(rows, kind, threads, *pair, goals.get(pair[1])) for kind in kinds for pair in pairs]
    return [row for row in found if row is not None]


def names(*pairs):
    """Every peer in the pairs once."""
    return list(dict.fromkeys(name for group in pairs for pair in group for name in pair))


def single_rays(programs, mesh, size, passes):
    """One thread, rays one after the other."""
    pairs = SINGLE if size > 1_000_000 else SINGLE + SINGLE_HIGH
    rows = programs.rows(programs.shipped, mesh, size, names(pairs), "--passes", passes)
    if size > 1_000_000:
        return speeds(rows, pairs, {} if mesh == "hall" else GOAL_SINGLE)
    goals = ({}, GOAL_HALL) if mesh == "hall" else (GOAL_SINGLE, {})
    return speeds(rows, SINGLE, goals[0]) + speeds(rows, SINGLE_HIGH, goals[1])


def packets(programs, mesh, size, passes):
    """One thread, sixteen neighbouring rays at a time."""
    pairs = PACKETS + PACKETS_HIGH
    options = ("--passes", passes, "--kinds", ",".join(COHERENT))
    rows = programs.rows(programs.shipped, mesh, size, names(pairs), *options)
    goals = ({}, GOAL_PACKETS) if mesh == "hall" else (GOAL_PACKETS, {})
    return speeds(rows, PACKETS, goals[0]) + speeds(rows, PACKETS_HIGH, goals[1])


def two_threads(programs, mesh, size, passes):
    """Two threads share the rays."""
    options = ("--passes", passes, "--threads", 2)
    rows = programs.rows(programs.shipped, mesh, size, names(SINGLE), *options)
    return speeds(rows, SINGLE, {}, threads=2)


def crates(programs, mesh, size, passes):
    """Crates built for this machine. Ours are from that binary, too, so that the rounds are the same."""
    pairs = [("umbriel", name) for name in CRATES]
    options = ("--passes", passes, "--side", 512)
    rows = programs.rows(programs.native, mesh, size, [*names(pairs), "embree-robust"], *options)
    return speeds(rows, pairs, {})


def builds(programs, mesh, size, count):
    """Wall time of builds with one and two threads, and memory."""
    pairs = (("umbriel", "embree"), ("umbriel-high", "embree-high"))
    rows, options = [], ("--build-only", "--builds", count, "--threads")
    for threads in (1, 2):
        # A process each: Embree shares threads between devices.
        found = programs.rows(programs.shipped, mesh, size, names(pairs), *options, threads)
        built = {row["peer"]: row for row in found}
        for ours, peer in pairs:
            mine, theirs = built[ours], built[peer]
            # No verdict on wall times while others had the processors.
            quiet = mine["quiet"] and theirs["quiet"]
            goal = 1.0 if quiet and threads == 2 and 900_000 < mine["triangles"] < 1_100_000 else None
            case = f"{label(mine)}, build{' high' if 'high' in ours else ''}, {threads} threads"
            rows.append(Row(case, "ms", mine["wall_ms"], peer, theirs["wall_ms"], goal, note="" if quiet else "busy machine"))
    for ours, peer in pairs:
        mine, theirs = built[ours], built[peer]
        case = f"{label(mine)}, structure{' high' if 'high' in ours else ''}"
        bytes_each = mine["bytes_per_triangle"]
        rows.append(Row(case, "B/triangle", bytes_each, peer, theirs["bytes_per_triangle"]))
        rows.append(Row(case, "B/triangle", bytes_each, f"goal {GOAL_BYTES}", GOAL_BYTES, 1.0))
    return rows


def run_bench(repetitions, files=()):
    """The benchmark `kernels`; a third as many passes as repetitions, since each has a million rays."""
    programs, passes, rows = Programs(), (repetitions + 2) // 3, []
    for mesh in files or MESHES:
        for size in [0] if files else (10_000, 100_000, 1_000_000, 5_000_000):
            rows += single_rays(programs, mesh, size, passes)
            if size <= 1_000_000:
                rows += packets(programs, mesh, size, passes)
            if size in (0, 1_000_000):
                rows += two_threads(programs, mesh, size, passes)
                rows += builds(programs, mesh, size, min(3, passes))
            if size in (0, 100_000):
                rows += crates(programs, mesh, size, passes)
    return rows
