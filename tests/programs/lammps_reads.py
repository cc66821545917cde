# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""LAMMPS reads our clumps and moves each grain as one rigid body."""

import csv
import os
import shutil
import subprocess

from proof import Bench, check, near, skip

PROGRAM = shutil.which("lmp")
if not PROGRAM:
    skip("what LAMMPS reads: lammps is not installed (tools/setup --programs)")

# A grain turns as it falls: its balls keep their distances only if they are one body.
INPUT = """
units si
atom_style hybrid sphere molecular
boundary f f f
comm_modify vel yes
newton off
read_data clumps.data extra/special/per/atom 1
pair_style zero 0.5
pair_coeff * *
velocity all set 0 0 0
velocity all ramp vx 0 0.1 y 0 0.4
write_dump all custom before.txt id mol x y z radius modify sort id format float %.12g
fix grains all rigid/small molecule
fix weight all gravity 9.81 vector 0 0 -1
timestep 1e-4
thermo_style custom step
run 20
write_dump all custom after.txt id mol x y z radius modify sort id format float %.12g
"""


def atoms(path):
    """Molecule, place and radius of each atom."""
    with open(path) as file:
        rows = [line.split() for line in file.read().split("ITEM: ATOMS")[1].splitlines()[1:]]
    return [(int(row[1]), tuple(map(float, row[2:5])), float(row[5])) for row in rows]


def distance(a, b):
    return sum((x - y) ** 2 for x, y in zip(a, b)) ** 0.5


with Bench() as bench:
    subprocess.run([bench.tool, "generate", "sintered", bench.path("sample.vdb"), "--size", "40",
                    "--count", "6", "--voxel-size", "10um", "-q"], check=True)
    bench.run("segment", "grains.vdb", "--keep", "balls", "--boundary", "closed",
              source="sample.vdb")
    for name in ("clumps.csv", "clumps.data"):
        bench.run("export", name, "--as", "clumps", "--balls", "6", source="grains.vdb")
    with open(bench.path("clumps.csv")) as file:
        balls = [{key: float(value) for key, value in row.items()} for row in csv.DictReader(file)]
    with open(bench.path("in.txt"), "w") as file:
        file.write(INPUT)
    result = subprocess.run([PROGRAM, "-in", "in.txt", "-log", "none"], cwd=bench.folder,
                            env={**os.environ, "OMP_NUM_THREADS": "1"},
                            capture_output=True, text=True, timeout=300)
    check(result.returncode == 0, "LAMMPS: " + result.stdout[-2000:] + result.stderr[-2000:])

    grains = sorted({ball["grain_id"] for ball in balls})
    check(len(grains) > 2, f"only {len(grains)} grains: nothing to tell apart")
    before, after = atoms(bench.path("before.txt")), atoms(bench.path("after.txt"))
    check(len(before) == len(balls), f"{len(before)} atoms of {len(balls)} balls")
    for (molecule, place, radius), ball in zip(before, balls):
        check(grains[molecule - 1] == ball["grain_id"], f"molecule {molecule}")
        check(near(place, [ball[axis] for axis in "xyz"], 1e-9), f"place {place}")
        check(abs(radius - ball["radius"]) < 1e-9, f"radius {radius}")

    bodies = f"{len(grains)} rigid bodies with {len(balls)} atoms"
    check(bodies in result.stdout, f"not {bodies}: {result.stdout}")
    for one in range(len(before)):
        moved = distance(before[one][1], after[one][1])
        check(moved > 1e-5, f"atom {one + 1} moved by {moved}")
        for other in range(one):
            if before[one][0] == before[other][0]:
                check(abs(distance(before[one][1], before[other][1]) -
                          distance(after[one][1], after[other][1])) < 1e-9,
                      f"atoms {one + 1} and {other + 1} are no rigid body")
print("LAMMPS reads the clumps and moves them as rigid bodies")
