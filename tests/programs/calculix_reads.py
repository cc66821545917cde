# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""CalculiX, which reads Abaqus input, takes our elements: the volume of each grain's element
set. It presses two samples together by the sets of their faces: what they resist with is that of
their material, and of its necks."""

import array
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

# The lower face stands still, the upper one is pressed down by a thousandth of the height.
PRESS = """*INCLUDE, INPUT={mesh}
*MATERIAL, NAME=ice
*ELASTIC
{modulus}, 0.33
{sections}
*STEP
*STATIC
*BOUNDARY
face_z_min, 1, 3
face_z_max, 1, 2
face_z_max, 3, 3, {down}
*NODE PRINT, NSET=face_z_max, TOTALS=ONLY
RF
*END STEP
"""


def run_calculix(bench, job):
    result = subprocess.run([PROGRAM, job], cwd=bench.folder,
                            env={**os.environ, "OMP_NUM_THREADS": "1"},
                            capture_output=True, text=True, timeout=300)
    check(result.returncode == 0 and "Job finished" in result.stdout and
          "*ERROR" not in result.stdout, "CalculiX: " + result.stdout[-2000:])
    with open(bench.path(job + ".dat")) as file:
        return [line.split() for line in file if line.strip()]


def stiffness(bench, mesh, height, section, modulus=9000):
    """Stress on the face over strain, of the modulus of the material."""
    with open(mesh) as file:
        sets = sorted({line.split("ELSET=")[1].strip() for line in file if "ELSET=" in line})
    with open(bench.path("press.inp"), "w") as file:
        file.write(PRESS.format(
            mesh=os.path.basename(mesh), modulus=modulus, down=-0.001 * height,
            sections="\n".join(f"*SOLID SECTION, ELSET={name}, MATERIAL=ice" for name in sets)))
    lines = run_calculix(bench, "press")
    force = [float(values[2]) for title, values in zip(lines, lines[1:])
             if title[:2] == ["total", "force"]]
    check(len(force) == 1, f"CalculiX: {len(force)} totals of the force")
    return -force[0] / section / 0.001 / modulus


def check_pressed(bench, size=16):
    """Columns that fill a half of the section carry a half, but for what their ends, which may not
    spread, add; a column with a neck carries less, one that is cut through nothing."""
    found = {}
    for name, waist in (("whole", size), ("neck", size // 4), ("cut", 0)):
        labels = array.array("i", [
            (1 if z < size // 2 else 2)
            if x < size // 2 and not (z == size // 2 and not (x < waist // 2 and y < waist)) else 0
            for z in range(size) for y in range(size) for x in range(size)])
        with open(bench.path(name + ".raw"), "wb") as file:
            file.write(labels.tobytes())
        mesh = bench.path(name + ".inp")
        subprocess.run([bench.tool, "export", bench.path(name + ".raw"), mesh, "--dims",
                        f"{size}x{size}x{size}", "--type", "int32", "--voxel-size", "10um", "-q"],
                       check=True)
        found[name] = stiffness(bench, mesh, size * EDGE, (size * EDGE)**2)
    check(0.5 < found["whole"] < 0.56, f"CalculiX: half a block has {found['whole']:.3f}")
    check(0.02 < found["neck"] < 0.3 * found["whole"], f"CalculiX: a neck has {found['neck']:.3f}")
    check(abs(found["cut"]) < 1e-6, f"CalculiX: what is cut has {found['cut']}")
    print("moduli, of the material's: " + ", ".join(f"{name} {e:.3f}" for name, e in found.items()))


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
    lines = run_calculix(bench, "job")
    found = {}
    for title, value in zip(lines, lines[1:]):
        if title[:4] == ["total", "volume", "for", "set"]:
            found[title[4].lower()] = float(value[0])
    check(set(found) == set(names), f"CalculiX: sets {sorted(found)}")
    for name, label in names.items():
        check(abs(found[name] / EDGE**3 - VOXELS[label]) < 1e-4, f"{name}: volume {found[name]}")
    check_pressed(bench)
print("CalculiX reads the elements and their sets, and presses them together by their faces")
