# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""The inputs for YADE and LAMMPS that the manual shows, run as they stand on its sample: under
gravity the packing comes to rest and no grain leaves it, loose or bonded."""

import csv
import json
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
                            text=True, timeout=300)
    return result.returncode, result.stdout + result.stderr


def comes_to_rest(what, energies, least=3):
    check(len(energies) >= least, f"{what}: only {len(energies)} energies")
    check(max(energies) > 0, f"{what}: nothing moved")
    check(energies[-1] < AT_REST * max(energies), f"{what}: not at rest: {energies}")
    # Balls that overlap kick at the first steps; grains that only fall are slow then.
    check(energies[0] < max(energies), f"{what}: the grains flew apart: {energies}")
    print(f"{what}: kinetic energy {max(energies):.2g}, at the end {energies[-1]:.2g}")


# In the place of the last run of YADE: the same steps, with a look at the packing now and then.
LOOK = r"""
import json, os, shutil
look = {'energies': [], 'low': list(low), 'high': list(high)}
for _ in range(\1 // 500):
    O.run(500, wait=True)
    look['energies'].append(kineticEnergy())
look['centers'] = [list(O.bodies[ball].state.pos) for ball, _ in clumps]
look['bonds'] = sum(1 for i in O.interactions if i.isReal and hasattr(i.phys, 'cohesionBroken')
                    and not i.phys.cohesionBroken)
with open('look.json', 'w') as file:
    json.dump(look, file)
shutil.rmtree(os.path.dirname(O.tmpFilename()))  # YADE 2023.02 leaves it behind
"""


def yade(bench, text, what, bonds):
    text = replaced(text, r"^O\.run\((\d+), wait=True\)", LOOK)
    _, printed = run(bench, "run.py", ["yade", "-n", "-x"], text)
    check(os.path.exists(bench.path("look.json")), f"{what}: {printed[-3000:]}")
    with open(bench.path("look.json")) as file:
        look = json.load(file)
    os.remove(bench.path("look.json"))
    comes_to_rest(what, look["energies"])
    check(len(look["centers"]) > 20, f"{what}: {len(look['centers'])} clumps")
    for center in look["centers"]:
        check(all(low < x < high for low, x, high in zip(look["low"], center, look["high"])),
              f"{what}: a grain left: {center}")
    check(look["bonds"] == bonds, f"{what}: {look['bonds']} of {bonds} bonds hold")


def lammps(bench, text, what, bonds):
    if bonds:
        text = replaced(text, r"^run ", "compute length all bond/local dist\n"
                        "dump length all local 40000 length.txt c_length\nrun ")
    code, printed = run(bench, "run.txt", ["lmp", "-log", "none", "-in"], text)
    check(code == 0, f"{what}: {printed[-3000:]}")
    rows = re.search(r"^ *Step Atoms.*?\n(.*?)^Loop", printed, re.S | re.M)
    check(rows, f"{what}: {printed[-3000:]}")
    rows = [row.split() for row in rows[1].splitlines() if re.match(r"^ *\d+ +\d+ +\S+ *$", row)]
    check(len({row[1] for row in rows}) == 1, f"{what}: atoms were lost: {rows}")
    comes_to_rest(what, [float(row[2]) for row in rows[1:]])
    if bonds:
        with open(bench.path("length.txt")) as file:
            last = file.read().split("ITEM: ENTRIES")[-1].splitlines()[1:]
        check(len(last) == len(bonds), f"{what}: {len(last)} bonds of {len(bonds)}")
        lengths = sorted(float(line) for line in last)
        for length, wanted in zip(lengths, sorted(float(bond["distance"]) for bond in bonds)):
            check(abs(length / wanted - 1) < 0.01, f"{what}: a bond of {wanted} is {length} long")


PROGRAMS = {"yade": ("yade", "tools/setup --yade"), "lammps": ("lmp", "tools/setup --programs")}
chosen = sys.argv[2]
if not shutil.which(PROGRAMS[chosen][0]):
    skip(f"clumps at rest in {chosen}: it is not installed ({PROGRAMS[chosen][1]})")
with Bench() as bench:
    environment = {**os.environ, "PATH": bench.folder + os.pathsep + os.environ["PATH"]}
    os.symlink(bench.tool, bench.path("vdb_madf"))
    sample = "vdb_madf generate sintered scan.tif --size 120 --count 30 -q"
    lines = [line for line in "".join(blocks("sh")).splitlines()
             if re.search(r" segment |--as clumps|^awk ", line)]
    check(len(lines) == 5, f"the manual's lines for clumps are {lines}")
    for line in [sample] + lines:
        done = subprocess.run(["bash", "-c", line], cwd=bench.folder, env=environment,
                              capture_output=True, text=True)
        check(done.returncode == 0, f"{line}: {done.stdout}{done.stderr}")
    with open(bench.path("bonds.csv")) as file:
        bonds = list(csv.DictReader(file))
    check(len(bonds) > 10, f"only {len(bonds)} bonds")
    if chosen == "yade":
        text = block("python")
        loose = replaced(text, r"^for row in .*?(?=^O\.dt)", "")
        yade(bench, loose, "YADE, loose grains", 0)
        yade(bench, text, "YADE, bonded grains", len(bonds))
    else:
        text = block("lammps")
        loose = replaced(text, r"^(bond_style|include bonds)[^\n]*\n", "")
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
