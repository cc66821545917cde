# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""CalculiX, which reads Abaqus input, takes our elements: the volume of each grain's element
set."""

import os
import shutil
import subprocess

from proof import Bench, EDGE, LABELS, VOXELS, check, skip

PROGRAM = shutil.which("ccx")
if not PROGRAM:
    skip("what CalculiX reads: calculix-ccx is not installed (tools/setup --programs)")

# All nodes are moved alike: no equation is left, but elements turned inside out are refused.
INPUT = """*INCLUDE, INPUT=elements.inp
*NSET, NSET=all, GENERATE
1, {nodes}
*MATERIAL, NAME=ice
*ELASTIC
9000, 0.33
{sections}
*STEP
*STATIC
*BOUNDARY
all, 1, 2
all, 3, 3, 0.001
{volumes}
*END STEP
"""

with Bench() as bench:
    bench.run("export", "elements.inp")
    names = {f"grain_{label:06d}": label for label in VOXELS}
    nodes = {(x + dx, y + dy, z + dz) for x, y, z in LABELS
             for dx in (0, 1) for dy in (0, 1) for dz in (0, 1)}
    with open(bench.path("job.inp"), "w") as file:
        file.write(INPUT.format(
            nodes=len(nodes),
            sections="\n".join(f"*SOLID SECTION, ELSET={name}, MATERIAL=ice" for name in names),
            volumes="\n".join(f"*EL PRINT, ELSET={name}, TOTALS=ONLY\nEVOL" for name in names)))
    result = subprocess.run([PROGRAM, "job"], cwd=bench.folder,
                            env={**os.environ, "OMP_NUM_THREADS": "1"},
                            capture_output=True, text=True, timeout=300)
    check(result.returncode == 0 and "Job finished" in result.stdout and
          "*ERROR" not in result.stdout, "CalculiX: " + result.stdout[-2000:])
    with open(bench.path("job.dat")) as file:
        lines = [line.split() for line in file if line.strip()]
    found = {}
    for title, value in zip(lines, lines[1:]):
        if title[:4] == ["total", "volume", "for", "set"]:
            found[title[4].lower()] = float(value[0])
    check(set(found) == set(names), f"CalculiX: sets {sorted(found)}")
    for name, label in names.items():
        check(abs(found[name] / EDGE**3 - VOXELS[label]) < 1e-4, f"{name}: volume {found[name]}")
print("CalculiX reads the elements and their sets")
