# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""LAMMPS, and LIGGGHTS that came of it, read our clumps, weigh each grain right and move it as one
rigid body."""

import csv
import os
import shutil
import subprocess

from proof import Bench, check, near, skip

# A grain turns as it falls: its balls keep their distances only if they are one body.
LAMMPS = """
units si
atom_style hybrid sphere molecular
boundary f f f
comm_modify vel yes
newton off
read_data clumps.data extra/special/per/atom 1
variable ice atom 917*mass
set group all mass v_ice
pair_style zero 0.5
pair_coeff * *
velocity all ramp vx 0 0.1 y 0 0.4
dump 1 all custom 20 step_*.txt id mol x y z radius mass
dump_modify 1 sort id format float %.12g
fix grains all rigid/small molecule
fix weight all gravity 9.81 vector 0 0 -1
timestep 1e-4
thermo_style custom step
run 20
"""
LIGGGHTS = """
units si
atom_style hybrid granular molecular
atom_modify map array sort 0 0
boundary f f f
communicate single vel yes
newton off
read_data clumps.data
neighbor 0.01 bin
pair_style none
velocity all ramp vx 0 0.1 y 0 0.4
dump 1 all custom 20 step_*.txt id mol x y z radius mass
dump_modify 1 sort id format "%d %d %.12g %.12g %.12g %.12g %.12g"
fix grains all rigid molecule
fix weight all gravity 9.81 vector 0 0 -1
timestep 1e-4
run 20
"""
PROGRAMS = {  # name: command, input, density
    "LAMMPS": ("lmp", LAMMPS, 917),
    "LIGGGHTS": ("liggghts", LIGGGHTS, 1),
}


def atoms(path):
    """Molecule, place, radius and mass of each atom."""
    with open(path) as file:
        rows = [line.split() for line in file.read().split("ITEM: ATOMS")[1].splitlines()[1:]]
    return [(int(row[1]), tuple(map(float, row[2:5])), float(row[5]), float(row[6]))
            for row in rows]


def distance(a, b):
    return sum((x - y) ** 2 for x, y in zip(a, b)) ** 0.5


def prove(name, bench, balls, volumes):
    program, text, density = PROGRAMS[name]
    with open(bench.path("in.txt"), "w") as file:
        file.write(text)
    result = subprocess.run([program, "-in", "in.txt", "-log", "none"], cwd=bench.folder,
                            env={**os.environ, "OMP_NUM_THREADS": "1"},
                            capture_output=True, text=True, timeout=300)
    check(result.returncode == 0, f"{name}: " + result.stdout[-2000:] + result.stderr[-2000:])

    grains = sorted({ball["grain_id"] for ball in balls})
    before, after = atoms(bench.path("step_0.txt")), atoms(bench.path("step_20.txt"))
    counts = [sum(ball["grain_id"] == label for ball in balls) for label in grains]
    single = counts.count(1)  # these have a second ball, at the end of the list
    check(len(before) == len(balls) + single, f"{name}: {len(before)} atoms of {len(balls)} balls")
    for (molecule, place, radius, _), ball in zip(before, balls):
        check(grains[molecule - 1] == ball["grain_id"], f"{name}: molecule {molecule}")
        check(near(place, [ball[axis] for axis in "xyz"], 1e-9), f"{name}: place {place}")
        check(abs(radius - ball["radius"]) < 1e-9, f"{name}: radius {radius}")
    for molecule, label in enumerate(grains, 1):
        mass = sum(atom[3] for atom in before if atom[0] == molecule)
        check(abs(mass / (density * volumes[label]) - 1) < 1e-6,
              f"{name}: grain {label}: mass {mass}")

    bodies = f"{len(grains)} rigid bodies with {len(before)} atoms"
    check(bodies in result.stdout, f"{name}: not {bodies}: {result.stdout}")
    for one in range(len(before)):
        moved = distance(before[one][1], after[one][1])
        check(moved > 1e-5, f"{name}: atom {one + 1} moved by {moved}")
        for other in range(one):
            if before[one][0] == before[other][0]:
                check(abs(distance(before[one][1], before[other][1]) -
                          distance(after[one][1], after[other][1])) < 1e-9,
                      f"{name}: atoms {one + 1} and {other + 1} are no rigid body")
    print(f"{name} reads the clumps, weighs them and moves them as rigid bodies")


if not any(shutil.which(program) for program, _, _ in PROGRAMS.values()):
    skip("what LAMMPS and LIGGGHTS read: neither is installed (tools/setup --programs)")
with Bench() as bench:
    bench.segment_sintered(40, 6)
    subprocess.run([bench.tool, "measure", bench.path("grains.vdb"), bench.path("tables"), "-q"],
                   check=True)
    with open(bench.path("tables/grains.csv")) as file:
        volumes = {int(row["id"]): float(row["volume_mm3"]) for row in csv.DictReader(file)}
    check(len(volumes) > 2, f"only {len(volumes)} grains: nothing to tell apart")
    for most in ("6", "1"):
        for name in ("clumps.csv", "clumps.data"):
            bench.run("export", name, "--as", "clumps", "--balls", most, "--uncovered", "0",
                      source="grains.vdb")
        with open(bench.path("clumps.csv")) as file:
            balls = [{key: float(value) for key, value in row.items()}
                     for row in csv.DictReader(file)]
        for name, (program, _, _) in PROGRAMS.items():
            if shutil.which(program):
                prove(name, bench, balls, volumes)
            else:
                print(f"SKIPPED: what {name} reads: {name.lower()} is not installed (tools/setup "
                      f"--programs)")
