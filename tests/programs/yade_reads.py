# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""YADE reads our clumps: their number, the place and radius of each ball, and their mass."""

import csv
import json
import math
import os
import shutil
import subprocess

from proof import EDGE, Bench, check, near, skip

PROGRAM = shutil.which("yade")
if not PROGRAM:
    skip("what YADE reads: yade is not installed (tools/setup --yade)")

# Without `discretization` YADE adds up the balls, overlaps and all.
SCRIPT = """
import json, os, shutil
from yade import ymport
found = []
for clump, members in ymport.textClumps('clumps.txt', discretization=20):
    balls = [O.bodies[member] for member in members]
    found.append({'volume': O.bodies[clump].state.mass / balls[0].material.density,
                  'center': list(O.bodies[clump].state.pos),
                  'balls': [list(ball.state.pos) + [ball.shape.radius] for ball in balls]})
with open('found.json', 'w') as file:
    json.dump({'bodies': len(O.bodies), 'clumps': found}, file)
shutil.rmtree(os.path.dirname(O.tmpFilename()))  # YADE 2023.02 leaves it behind
"""


def union_of(balls):
    """Volume and center of balls taken together: exact along z, columns every half voxel."""
    step = EDGE / 2
    low = [math.floor(min(ball[a] - ball[3] for ball in balls) / step) for a in (0, 1)]
    high = [math.ceil(max(ball[a] + ball[3] for ball in balls) / step) for a in (0, 1)]
    volume, moments = 0.0, [0.0, 0.0, 0.0]
    for i in range(low[0], high[0]):
        for j in range(low[1], high[1]):
            x, y, end = (i + 0.5) * step, (j + 0.5) * step, -math.inf
            spans = []
            for a, b, c, r in balls:
                rest = r * r - (x - a) ** 2 - (y - b) ** 2
                if rest > 0:
                    spans.append((c - math.sqrt(rest), c + math.sqrt(rest)))
            for begin, stop in sorted(spans):
                begin = max(begin, end)
                if stop > begin:
                    part, end = (stop - begin) * step * step, stop
                    volume += part
                    for axis, place in enumerate((x, y, (begin + stop) / 2)):
                        moments[axis] += part * place
    return volume, [moment / volume for moment in moments]


with Bench() as bench:
    bench.segment_sintered(80, 12)
    for name in ("clumps.txt", "clumps.csv"):
        bench.run("export", name, "--as", "clumps", "--balls", "20", source="grains.vdb")
    with open(bench.path("clumps.csv")) as file:
        balls = {}
        for row in csv.DictReader(file):
            balls.setdefault(int(row["grain_id"]), []).append(
                [float(row[key]) for key in ("x", "y", "z", "radius")])
    with open(bench.path("read.py"), "w") as file:
        file.write(SCRIPT)
    result = subprocess.run([PROGRAM, "-n", "-x", "read.py"], cwd=bench.folder,
                            env={**os.environ, "OMP_NUM_THREADS": "1"},
                            stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=300)
    check(os.path.exists(bench.path("found.json")),
          "YADE: " + result.stdout[-2000:] + result.stderr[-2000:])
    with open(bench.path("found.json")) as file:
        found = json.load(file)

    check(len(balls) > 5, f"only {len(balls)} grains: nothing to tell apart")
    check(len(found["clumps"]) == len(balls),
          f"{len(found['clumps'])} clumps of {len(balls)} grains")
    check(found["bodies"] == len(balls) + sum(map(len, balls.values())),
          f"{found['bodies']} bodies")
    for clump, (label, wanted) in zip(found["clumps"], balls.items()):
        check(len(clump["balls"]) == len(wanted), f"grain {label}: {len(clump['balls'])} balls")
        for here, there in zip(clump["balls"], wanted):
            check(near(here, there, 1e-9), f"grain {label}: ball {here} instead of {there}")
        volume, center = union_of(wanted)
        check(abs(clump["volume"] / volume - 1) < 0.03,
              f"grain {label}: volume {clump['volume']} instead of {volume}")
        check(near(clump["center"], center, EDGE / 4),
              f"grain {label}: center {clump['center']} instead of {center}")
print("YADE reads the clumps, each with the mass of its balls together")
