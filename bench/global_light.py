"""Global illumination: CPU time to a relative mean square error of 0.001, and paths a CPU second, beside Mitsuba 3 and Cycles."""

import math
import subprocess
import sys
import tempfile
from pathlib import Path
from statistics import median

import install
from measure import ROOT, Failed, Row, build_ours, run, say

FOLDER = ROOT / "bench/global"
sys.path.insert(0, str(FOLDER))
import scenes

GOAL_ERROR = 0.001
# Samples a pixel that are tried, one after the other, until the error is below the goal.
LADDER = [4, 16, 64, 256, 1024]
GOAL_MITSUBA, GOAL_CYCLES = 1.0, 3.0


class Ours:
    """Our program; start-up and the file count."""

    name, ending = "ours", "exr"

    def __init__(self, folder, program):
        self.folder, self.program = folder, program

    def render(self, spp, seed, output):
        command = [self.program, "render", self.folder / "scene.toml", "-o", output, "-s", spp, "--seed", seed]
        # As the peers: light comes through glass by paths alone.
        return run(command + ["--glass-shadows", "opaque", "-q"]).cpu

    def close(self):
        pass


class Peer:
    """A process that has loaded the scene and answers in turn."""

    def __init__(self, name, ending, command, environment=None):
        self.name, self.ending = name, ending
        pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "stderr": subprocess.DEVNULL, "text": True}
        self.process = subprocess.Popen([str(part) for part in command], env=environment, **pipes)

    def ask(self, *words):
        """The last words of the answer, as numbers; what else the program prints is skipped."""
        self.process.stdin.write(" ".join(map(str, words)) + "\n")
        self.process.stdin.flush()
        for line in self.process.stdout:
            try:
                numbers = [float(word) for word in line.removeprefix("seconds").split()]
            except ValueError:
                continue
            if numbers:
                return numbers
        raise Failed(f"{self.name} ended without an answer")

    def render(self, spp, seed, output):
        return self.ask(spp, seed, output)[0]

    def close(self):
        self.process.stdin.close()
        self.process.wait()


class Bench:
    """Programs and peers; all files lie in one temporary folder."""

    def __init__(self, folder):
        self.folder = Path(folder)
        self.program = build_ours()
        self.mitsuba = install.mitsuba()
        llvm = install.llvm()
        if llvm is None:
            raise Failed("Mitsuba's LLVM variant is the one to compare with")
        self.environment = {"HOME": str(install.FOLDER), "DRJIT_LIBLLVM_PATH": str(llvm)}
        self.cycles = install.cycles()
        self.error = Peer("error", "", [self.mitsuba, "-B", FOLDER / "error.py"])

    def renderers(self):
        """All, on the scene in the folder."""
        yield Ours(self.folder, self.program)
        mitsuba = [self.mitsuba, "-B", FOLDER / "mitsuba_render.py", self.folder, "multijitter"]
        yield Peer("Mitsuba 3 multijitter", "npy", mitsuba, self.environment)
        if self.cycles:
            yield Peer("Cycles", "exr", [self.cycles, "-B", FOLDER / "cycles_render.py", self.folder])


def needed_seconds(steps):
    """CPU seconds to the goal from (error, seconds) of the last two steps, and whether that lies beyond them.

    Between two steps error and time are powers of the samples; beyond them error times time stays the same.
    """
    (error0, seconds0), (error1, seconds1) = steps[-2:]
    if not error0 > GOAL_ERROR >= error1:
        return seconds1 * error1 / GOAL_ERROR, True
    share = math.log(GOAL_ERROR / error0) / math.log(error1 / error0)
    return seconds0 * (seconds1 / seconds0) ** share, False


def climb(bench, renderer, round_number):
    """CPU seconds to the goal, paths a CPU second at the last step, the picture's mean there, and whether the goal lies beyond."""
    steps = []
    for spp in LADDER:
        files = [bench.folder / f"{side}.{renderer.ending}" for side in "ab"]
        seconds = [renderer.render(spp, 2 * round_number + i + 1, file) for i, file in enumerate(files)]
        error, mean = bench.error.ask(*files)
        steps.append((error, sum(seconds) / 2))
        if error <= GOAL_ERROR and len(steps) > 1:
            break
    needed, beyond = needed_seconds(steps)
    paths = scenes.SIZE**2 * spp / steps[-1][1] / 1e6
    figures = f"{needed:.3g} CPU-s{' extrapolated' if beyond else ''}, {paths:.3g} Mpaths/CPU-s"
    say(f"  {renderer.name}: {spp} spp, error {error:.2g}, mean {mean:.4f}: {figures}")
    return needed, paths, mean, beyond


def note(ours, theirs):
    """What a reader must know of two climbs, each a list of rounds."""
    extrapolated = [who for who, rounds in (("ours", ours), ("theirs", theirs)) if any(r[3] for r in rounds)]
    words = [f"{who}: extrapolated" for who in extrapolated]
    share = median(r[2] for r in ours) / median(r[2] for r in theirs)
    return "; ".join(words + ([f"mean light {share:.2f} of theirs"] if abs(share - 1) > 0.02 else []))


def scene_rows(bench, name, repetitions):
    """Rows of one scene: all renderers climb in turn, round by round."""
    say(name)
    scenes.write_scene(name, bench.folder)
    renderers = list(bench.renderers())
    rounds = [[climb(bench, renderer, number) for renderer in renderers] for number in range(repetitions)]
    for renderer in renderers:
        renderer.close()
    climbs, rows = list(zip(*rounds)), []
    seconds, paths = (median(r[k] for r in climbs[0]) for k in range(2))
    for renderer, theirs in zip(renderers[1:], climbs[1:]):
        their_seconds, their_paths = (median(r[k] for r in theirs) for k in range(2))
        goal = GOAL_CYCLES if renderer.name == "Cycles" else GOAL_MITSUBA
        words = note(climbs[0], theirs)
        rows.append(Row(f"{name}, relMSE {GOAL_ERROR}", "CPU-s", seconds, renderer.name, their_seconds, goal, note=words))
        rows.append(Row(f"{name}, paths", "M/CPU-s", paths, renderer.name, their_paths, speed=True))
    return rows


def run_bench(repetitions):
    """The benchmark `global`."""
    with tempfile.TemporaryDirectory() as folder:
        bench = Bench(folder)
        rows = [row for name in scenes.SCENES for row in scene_rows(bench, name, repetitions)]
        bench.error.close()
        return rows
