# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""The inputs for YADE and LAMMPS that the manual shows, run as they stand on its sample: under
gravity the packing comes to rest and no grain leaves it, loose or bonded.

    dem_rest.py VDB_MADF yade|lammps [COUNT]

With a COUNT so many ellipsoids are cut and fall loose, with softer contacts and longer steps, until
they lie still as a pack of plausible density and contacts; none is lost.
"""

import csv
import itertools
import json
import math
import os
import re
import shutil
import subprocess
import sys

from proof import Bench, check, skip

MANUAL = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../tools/manual")
PAGES = ("clumps.md", "lammps.md", "yade.md")
# Kinetic energy at the end, in parts of the largest on the way.
AT_REST = 0.05
AT_REST_SETTLED = 0.01
# What is plausible in the middle of a settled pack: random packs fill 0.55 to 0.64, small ones
# between near walls less; grains with friction need 4 contacts, but for those that rattle, and
# ellipsoids without it have 10.
SOLID_FRACTION = (0.5, 0.65)
CONTACTS = (3.5, 7)


def blocks(language):
    """What the pages have in blocks of a language, one after the other."""
    text = ""
    for page in PAGES:
        with open(os.path.join(MANUAL, page)) as file:
            text += file.read()
    return re.findall(rf"^```{language}\n(.*?)^```", text, re.S | re.M)


def block(language):
    found = blocks(language)
    check(len(found) == 1, f"{len(found)} blocks of {language} in the manual")
    return found[0]


def replaced(text, pattern, replacement):
    changed, count = re.subn(pattern, replacement, text, flags=re.S | re.M)
    check(count > 0, f"nothing in the manual's input is like {pattern}")
    return changed


def run(bench, name, command, text):
    with open(bench.path(name), "w") as file:
        file.write(text)
    result = subprocess.run(command + [name], cwd=bench.folder, stdin=subprocess.DEVNULL,
                            env={**os.environ, "OMP_NUM_THREADS": "1"}, capture_output=True,
                            text=True, timeout=3600)
    return result.returncode, result.stdout + result.stderr


def comes_to_rest(what, energies, rest=AT_REST):
    check(len(energies) >= 3, f"{what}: only {len(energies)} energies")
    check(max(energies) > 0, f"{what}: nothing moved")
    check(energies[-1] < rest * max(energies), f"{what}: not at rest: {energies}")
    # Balls that overlap kick at the first steps; grains that only fall are slow then.
    check(energies[0] < max(energies), f"{what}: the grains flew apart: {energies}")
    print(f"{what}: kinetic energy {max(energies):.2g}, at the end {energies[-1]:.2g}")


def settles(what, count, balls, low, high):
    """Checks a settled pack of so many grains or a few less: (clump, x, y, z, radius) of all balls,
    and the corners of the walls."""
    for _, *center, _ in balls:
        check(all(l < x < h for l, x, h in zip(low, center, high)),
              f"{what}: a ball left: {center}")
    # The middle: a ball away from the sides, and neither the lowest nor the uppermost balls.
    largest = max(ball[4] for ball in balls)
    heights = sorted(ball[3] for ball in balls)
    low = [x + largest for x in low[:2]] + [heights[len(heights) // 10]]
    high = [x - largest for x in high[:2]] + [heights[len(heights) * 7 // 10]]

    step = largest / 4
    size = [int((h - l) / step) for l, h in zip(low, high)]
    filled = set()
    for _, *center, radius in balls:
        place = [(x - l) / step - 0.5 for x, l in zip(center, low)]
        around = (range(max(0, math.ceil(x - radius / step)),
                        min(n, math.floor(x + radius / step) + 1)) for x, n in zip(place, size))
        filled.update(point for point in itertools.product(*around)
                      if math.dist(point, place) * step < radius)
    fraction = len(filled) / math.prod(size)

    cells, grains = {}, {}
    for ball in balls:
        cells.setdefault(tuple(int(x // (2 * largest)) for x in ball[1:4]), []).append(ball)
        grains.setdefault(ball[0], []).append(ball[1:4])
    touching = {grain: set() for grain in grains}
    for cell, here in cells.items():
        beside = [ball for shift in itertools.product((-1, 0, 1), repeat=3)
                  for ball in cells.get(tuple(map(sum, zip(cell, shift))), ())]
        for a, b in itertools.product(here, beside):
            if a[0] != b[0] and math.dist(a[1:4], b[1:4]) < a[4] + b[4]:
                touching[a[0]].add(b[0])
    check(0.95 * count < len(grains) <= count, f"{what}: {len(grains)} grains of {count}")
    middle = [grain for grain, centers in grains.items()
              if all(l < sum(x) / len(x) < h for l, x, h in zip(low, zip(*centers), high))]
    check(len(middle) > 5, f"{what}: {len(middle)} grains in the middle")
    contacts = sum(len(touching[grain]) for grain in middle) / len(middle)
    print(f"{what}: {len(grains)} settled; {len(middle)} of them in the middle: solid fraction "
          f"{fraction:.3f}, {contacts:.2f} contacts a grain")
    check(SOLID_FRACTION[0] < fraction < SOLID_FRACTION[1], f"{what}: the solid fraction")
    check(CONTACTS[0] < contacts < CONTACTS[1], f"{what}: the contacts")


# In the place of the last run of YADE: the same steps, with a look at the packing now and then.
LOOK = r"""
import json, os, shutil
look = {'energies': [], 'low': list(low), 'high': list(high)}
for _ in range(\1 // 500):
    O.run(500, wait=True)
    look['energies'].append(kineticEnergy())
look['centers'] = [list(O.bodies[ball].state.pos) for ball, _ in clumps]
look['balls'] = [[number, *O.bodies[ball].state.pos, O.bodies[ball].shape.radius]
                 for number, (_, members) in enumerate(clumps) for ball in members]
look['bonds'] = sum(1 for i in O.interactions if i.isReal and hasattr(i.phys, 'cohesionBroken')
                    and not i.phys.cohesionBroken)
with open('look.json', 'w') as file:
    json.dump(look, file)
shutil.rmtree(os.path.dirname(O.tmpFilename()))  # YADE 2023.02 leaves it behind
"""


def yade(bench, text, what, bonds, rest=AT_REST):
    text = replaced(text, r"^O\.run\((\d+), wait=True\)", LOOK)
    _, printed = run(bench, "run.py", ["yade", "-n", "-x"], text)
    check(os.path.exists(bench.path("look.json")), f"{what}: {printed[-3000:]}")
    with open(bench.path("look.json")) as file:
        look = json.load(file)
    os.remove(bench.path("look.json"))
    comes_to_rest(what, look["energies"], rest)
    check(len(look["centers"]) > 20, f"{what}: {len(look['centers'])} clumps")
    for center in look["centers"]:
        check(all(low < x < high for low, x, high in zip(look["low"], center, look["high"])),
              f"{what}: a grain left: {center}")
    check(look["bonds"] == bonds, f"{what}: {look['bonds']} of {bonds} bonds hold")
    return look


def lammps(bench, text, what, bonds, rest=AT_REST):
    if bonds:
        text = replaced(text, r"^run ", "compute length all bond/local dist\n"
                        "dump length all local 40000 length.txt c_length\nrun ")
    code, printed = run(bench, "run.txt", ["lmp", "-log", "none", "-in"], text)
    check(code == 0, f"{what}: {printed[-3000:]}")
    rows = re.search(r"^ *Step Atoms.*?\n(.*?)^Loop", printed, re.S | re.M)
    check(rows, f"{what}: {printed[-3000:]}")
    rows = [row.split() for row in rows[1].splitlines() if re.match(r"^ *\d+ +\d+ +\S+ *$", row)]
    check(len({row[1] for row in rows}) == 1, f"{what}: atoms were lost: {rows}")
    comes_to_rest(what, [float(row[2]) for row in rows[1:]], rest)
    if bonds:
        with open(bench.path("length.txt")) as file:
            last = file.read().split("ITEM: ENTRIES")[-1].splitlines()[1:]
        check(len(last) == len(bonds), f"{what}: {len(last)} bonds of {len(bonds)}")
        lengths = sorted(float(line) for line in last)
        for length, wanted in zip(lengths, sorted(float(bond["distance"]) for bond in bonds)):
            check(abs(length / wanted - 1) < 0.01, f"{what}: a bond of {wanted} is {length} long")


PROGRAMS = {"yade": ("yade", "tools/setup --yade"), "lammps": ("lmp", "tools/setup --programs")}
chosen = sys.argv[2]
count = int(sys.argv[3]) if len(sys.argv) > 3 else 0
if not shutil.which(PROGRAMS[chosen][0]):
    skip(f"clumps at rest in {chosen}: it is not installed ({PROGRAMS[chosen][1]})")
with Bench() as bench:
    environment = {**os.environ, "PATH": bench.folder + os.pathsep + os.environ["PATH"]}
    os.symlink(bench.tool, bench.path("vdb_madf"))
    edge = count**(1 / 3)
    sample = "vdb_madf generate sintered scan.tif --size 120 --count 30 -q"
    if count:
        sample = (f"vdb_madf generate particles scan.tif --shape ellipsoids --count {count} --dims "
                  f"{13 * edge:.0f}x{13 * edge:.0f}x{48 * edge:.0f} --radius 7:9 --neck 0.95 -q")
    lines = [line for line in "".join(blocks("sh")).splitlines()
             if re.search(r" segment scan|grains.vdb .*--as clumps|^awk ", line)]
    check(len(lines) == 5, f"the manual's lines for clumps are {lines}")
    if count:  # newer releases of LAMMPS ignore contacts of balls that bonds join
        lines = [line.replace("--balls 20", "--balls 10").replace(" --bonds bonds.csv", "")
                 for line in lines if not line.startswith("awk ")]
    for line in [sample] + lines:
        done = subprocess.run(["bash", "-c", line], cwd=bench.folder, env=environment,
                              capture_output=True, text=True)
        check(done.returncode == 0, f"{line}: {done.stdout}{done.stderr}")
    if not count:
        with open(bench.path("bonds.csv")) as file:
            bonds = list(csv.DictReader(file))
        check(len(bonds) > 10, f"only {len(bonds)} bonds")
    text = block({"yade": "python", "lammps": "lammps"}[chosen])
    if chosen == "yade":
        loose = replaced(text, r"^for row in .*?(?=^O\.dt)", "")
    else:
        loose = replaced(text, r"^(bond_style|include bonds)[^\n]*\n", "")
    if count and chosen == "yade":
        softer = replaced(loose, "young=1e5", "young=1e4")
        softer = replaced(softer, r"^O\.run\(\d+", f"O.run({500 * round(11.4 * edge**0.5)}")
        look = yade(bench, softer, "YADE", 0, AT_REST_SETTLED)
        settles("YADE", count, look["balls"], look["low"], look["high"])
    elif count:
        softer = replaced(loose, " 0\\.02 ", " 0.0002 ")
        softer = replaced(softer, "^fix drag[^\n]*\n", "")  # this is for bonds
        softer = replaced(softer, "^thermo 2000", "thermo 200")
        softer = replaced(softer, "^timestep 1e-6\nrun 40000",
                          f"timestep 1e-5\nrun {1200 * edge:.0f}")
        softer += "write_dump all custom end.txt mol x y z radius modify format float %.12g\n"
        lammps(bench, softer, "LAMMPS", [], AT_REST_SETTLED)
        with open(bench.path("end.txt")) as file:
            rows = file.read().split("ITEM: ATOMS")[1].splitlines()[1:]
        balls = [(int(row.split()[0]), *map(float, row.split()[1:])) for row in rows]
        with open(bench.path("clumps.data")) as file:
            walls = re.findall(r"^(\S+) (\S+) \wlo \whi$", file.read(), re.M)
        settles("LAMMPS", count, balls, *([float(x) for x in side] for side in zip(*walls)))
    elif chosen == "yade":
        yade(bench, loose, "YADE, loose grains", 0)
        yade(bench, text, "YADE, bonded grains", len(bonds))
    else:
        lammps(bench, loose, "LAMMPS, loose grains", [])
        lammps(bench, text, "LAMMPS, bonded grains", bonds)
        # Without --apart a grain has one ball. Of these grains none flies apart at once.
        overlapping = (lines[0].replace(" segment ", " segment --merge both ") +
                       "; vdb_madf export grains.vdb clumps.data --as clumps --bonds bonds.csv")
        subprocess.run(["bash", "-c", overlapping], cwd=bench.folder, env=environment, check=True,
                       stdout=subprocess.DEVNULL)
        code, printed = run(bench, "run.txt", ["lmp", "-log", "none", "-in"],
                            replaced(loose, r"^run \d+", "run 10"))
        check(code == 0, f"LAMMPS with a grain of one ball: {printed[-3000:]}")
