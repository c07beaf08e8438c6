"""Runs programs, takes medians of pairs, and prints rows."""

import json
import os
import shutil
import statistics
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
THREADS = len(os.sched_getaffinity(0))


class Failed(Exception):
    """A measured program did not do its work."""


@dataclass
class Run:
    """What one run of a program took, and what it printed."""

    wall: float
    cpu: float
    peak_mib: float
    output: str


@dataclass
class Row:
    """One comparison; `theirs` is the peer's figure, or the goal's where the peer is a goal."""

    case: str
    unit: str
    ours: float
    peer: str
    theirs: float
    goal: float | None = None
    # Of speeds the greater is better.
    speed: bool = False
    # The median of the rounds' ratios, where both sides were measured in rounds.
    paired: float | None = None
    note: str = ""

    @property
    def ratio(self):
        """How many times better ours is."""
        if self.paired is not None:
            return self.paired
        return self.ours / self.theirs if self.speed else self.theirs / self.ours

    def json(self, bench):
        row = {"bench": bench, "case": self.case, "unit": self.unit, "ours": round(self.ours, 4), "peer": self.peer}
        row |= {"theirs": round(self.theirs, 4), "ratio": round(self.ratio, 3), "goal": self.goal}
        return json.dumps(row | ({"note": self.note} if self.note else {}))


def run(command, environment=None):
    """Runs a program once; raises Failed unless it exits with 0."""
    command = [str(part) for part in command]
    program = shutil.which(command[0])
    if program is None:
        raise Failed(f"no program `{command[0]}`")
    with tempfile.NamedTemporaryFile("r", errors="replace") as output:
        spawn = [sys.executable, "-I", "-S", ROOT / "bench/spawn.py", output.name, program, *command[1:]]
        figures = subprocess.run(spawn, check=True, stdout=subprocess.PIPE, text=True, env=environment).stdout
        wall, cpu, peak_mib, status = map(float, figures.split())
        text = output.read()
    if status != 0:
        raise Failed(f"`{' '.join(command)}` ended with {status:.0f}:\n{text[-2000:]}")
    return Run(wall, cpu, peak_mib, text)


def pairs(ours, theirs, repetitions):
    """Runs two functions in turn, ours first; returns both lists of runs.

    A first pair warms the caches (files, Mitsuba's compiled kernels) and does not count.
    """
    ours(), theirs()
    both = [(ours(), theirs()) for _ in range(repetitions)]
    return [pair[0] for pair in both], [pair[1] for pair in both]


def median(runs, figure):
    """The median of one figure of the runs."""
    return statistics.median(figure(run) for run in runs)


def say(text):
    """Words go to stderr: stdout is for rows."""
    print(text, file=sys.stderr, flush=True)


def check_png(path, width, height):
    """Makes sure that the picture which was measured exists in its full size."""
    try:
        head = path.read_bytes()[:24]
    except OSError as error:
        raise Failed(f"no picture: {error}") from None
    size = (int.from_bytes(head[16:20], "big"), int.from_bytes(head[20:24], "big"))
    if head[:8] != b"\x89PNG\r\n\x1a\n" or size != (width, height):
        raise Failed(f"{path}: expected a PNG of {width}x{height}")


def cargo(arguments, folder=ROOT, environment=None):
    """Builds with cargo; returns the folder of its outputs."""
    say(f"building: cargo build --release {' '.join(arguments)}")
    environment = os.environ | (environment or {})
    command = ["cargo", "build", "--release", *arguments]
    if subprocess.run(command, cwd=folder, stdout=sys.stderr, env=environment).returncode != 0:
        raise Failed(f"`{' '.join(command)}` failed in {folder}")
    return Path(environment.get("CARGO_TARGET_DIR", folder / "target")).resolve() / "release"


def build_ours():
    """Builds the program and returns its path."""
    return cargo(["-p", "umbriel"]) / "umbriel"


def machine_line(repetitions, load_before):
    """The processor, how many of its threads we may use, and how busy the machine was."""
    info = Path("/proc/cpuinfo").read_text().splitlines()
    model = next((line.split(":")[1].strip() for line in info if line.startswith("model name")), "unknown CPU")
    load = f"load {load_before:.2f} before, {os.getloadavg()[0]:.2f} after"
    return f"{model}, {THREADS} threads; medians of {repetitions} pairs after one that does not count; {load}\n"


def table(rows):
    """The rows as a Markdown table that is also readable as it is."""
    cells = [("case", "unit", "ours", "peer", "theirs", "ratio", "goal", "")]
    for row in rows:
        met = "" if row.goal is None else "reached" if row.ratio >= row.goal else "NOT REACHED"
        goal = "" if row.goal is None else f"{row.goal:g}"
        figures = (figure(row.ours), row.peer, figure(row.theirs), f"{row.ratio:.2f}")
        cells.append((row.case, row.unit, *figures, goal, "; ".join(filter(None, (met, row.note)))))
    widths = [max(len(line[column]) for line in cells) for column in range(8)]
    lines = ["| " + " | ".join(cell.ljust(width) for cell, width in zip(line, widths)) + " |" for line in cells]
    lines.insert(1, "|" + "|".join("-" * (width + 2) for width in widths) + "|")
    return "\n".join(lines)


def figure(value):
    """Three significant digits or the whole number, whichever is more."""
    return f"{value:.0f}" if value >= 100 else f"{value:.3g}"
