# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""What the benchmarks of time share: the programs, the stages of a segmentation, the machine, and
tables."""
import json
import os
import pathlib
import platform
import subprocess
import sys

BENCHMARK = pathlib.Path(__file__).resolve().parent.parent
BUILD = pathlib.Path(os.environ.get("VDB_MADF_BUILD", BENCHMARK.parent.parent / "build"))
MADF = BUILD / "tools" / "vdb_madf"
MAURER = BUILD / "tests" / "vdb_madf_peer_maurer"
STAGES = ["leaf_index", "cavities", "squared_distance", "power_map", "medial_balls",
          "gamma_filter", "flow", "manifold_graph", "merge", "tidy", "labels"]


def stages_of(run):
    """Seconds of all stages together, of what `segment --json` says."""
    return sum(run.get("seconds_" + stage, 0) for stage in STAGES)


def madf(*arguments):
    subprocess.run([MADF, *map(str, arguments), "-q"], check=True)


def output_of(command, volume, dims, *more):
    """The line of JSON that a peer prints, or None where it cannot run."""
    out = subprocess.run([*map(str, command), volume, *map(str, dims), *map(str, more)],
                         capture_output=True, text=True)
    return json.loads(out.stdout) if out.returncode == 0 else None


def peer(name, raw, dims):
    command = [MAURER] if name == "maurer" else [sys.executable, BENCHMARK / "peers.py", name]
    return output_of(command, raw, dims) if pathlib.Path(command[0]).exists() else None


def row(*cells):
    print("| " + " | ".join(str(c) for c in cells) + " |", flush=True)


def table(*titles):
    print()
    row(*titles)
    row(*["---"] * len(titles))


def processor():
    for line in pathlib.Path("/proc/cpuinfo").read_text().splitlines():
        if line.startswith("model name"):
            return line.split(":", 1)[1].strip()
    return platform.processor()


def level():
    """The line of --version that says which inner loops run."""
    text = subprocess.run([MADF, "--version"], check=True, capture_output=True, text=True).stdout
    return next(line for line in text.splitlines() if line.startswith("SIMD level"))
