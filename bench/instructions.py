"""Instructions of a few fixed kernels under callgrind: the same on a busy machine, so that a small regression shows."""

import json
import os
import shutil
import subprocess
import sys

import install
from measure import ROOT, Failed, Row, say, table

FOLDER = ROOT / "bench/instructions"
# Of the crate in Cargo.toml and of the runner.
GUNGRAUN = "0.20.0"
BASELINE = FOLDER / "baseline.json"
# More instructions than the baseline's times this fail.
LIMIT = 1.05


def runner():
    """The program that runs valgrind for the benchmarks."""
    folder = install.FOLDER / f"gungraun-{GUNGRAUN}"
    program = folder / "bin/gungraun-runner"
    if not program.exists():
        say(f"installing from crates.io into {folder.relative_to(ROOT)}: gungraun-runner {GUNGRAUN}")
        command = ["cargo", "install", "--quiet", "--version", GUNGRAUN, "--root", folder, "gungraun-runner"]
        if subprocess.run(command, stdout=sys.stderr).returncode != 0:
            raise install.Missing(f"cannot install the runner: `{' '.join(map(str, command))}` failed")
    if shutil.which("valgrind") is None:
        install.debian("valgrind")
    return program


def counts():
    """Instructions by kernel."""
    command = ["cargo", "bench", "--bench", "kernels", "--", "--output-format=json"]
    say(" ".join(command))
    environment = os.environ | {"GUNGRAUN_RUNNER": str(runner())}
    done = subprocess.run(command, cwd=FOLDER, env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    if done.returncode != 0:
        raise Failed(f"`{' '.join(command)}` ended with {done.returncode}:\n{done.stderr[-2000:]}")
    found = {}
    for line in filter(lambda line: line.startswith("{"), done.stdout.splitlines()):
        bench = json.loads(line)
        (profile,) = (p for p in bench["profiles"] if p["tool"] == "Callgrind")
        instructions = profile["data"]["total"]["metrics"]["Ir"]["values"]["new"]
        found[f"{bench['function_name']} {bench['id']}"] = instructions
    return found


def run_bench(_repetitions):
    """The benchmark `instructions`; counts need no repetitions. Without a baseline it writes one: delete it to renew it."""
    found = counts()
    if not BASELINE.exists():
        say(f"new baseline: {BASELINE.relative_to(ROOT)}")
        BASELINE.write_text(json.dumps(found, indent=2) + "\n")
    baseline = json.loads(BASELINE.read_text())
    if found.keys() != baseline.keys():
        raise Failed(f"other kernels than in {BASELINE.relative_to(ROOT)}; delete it to renew it")
    rows = [Row(name, "k instr", n / 1e3, "baseline", baseline[name] / 1e3, round(1 / LIMIT, 3)) for name, n in found.items()]
    more = [f"{row.case}: {row.ours / row.theirs:.3f}" for row in rows if row.ours > LIMIT * row.theirs]
    if more:
        say(table(rows))
        raise Failed(f"more instructions than {LIMIT} times the baseline's: {', '.join(more)}")
    return rows
