# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""MUSEN imports our networks as spheres and solid bonds, keeps every number of them, and leaves
them at rest, by the script of the manual.

The program is cmusen (or CMUSEN) of github.com/msolids/musen in the PATH.
"""

import csv
import math
import os
import shutil
import subprocess

from proof import Bench, check, skip

PROGRAM = shutil.which("cmusen") or shutil.which("CMUSEN")
PAGE = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../tools/manual/musen.md")
EXPORT = """JOB
COMPONENT EXPORT_TO_TEXT
SOURCE_FILE {folder}/{name}.mdem
RESULT_FILE {folder}/{name}_back.txt
"""
# How many numbers follow a key.
VALUES = {12: 3, 15: 3, 16: 3, 18: 1, 20: 3, 31: 4, 36: 9, 37: 1, 42: 3, 43: 1, 45: 3}


def objects(path):
    """By their numbers: type, geometry, compound, places at all times."""
    found = {}
    with open(path) as file:
        for line in file:
            words = line.split()
            if words[0] != "0":
                continue
            check(words[2] == "1" and words[4] == "5", f"{path}: {line}")
            kind, count = int(words[3]), {"1": 2, "9": 4}[words[3]]
            geometry = [float(word) for word in words[5:5 + count]]
            rest = words[5 + count:]
            check(rest[0] == "23", f"{path}: {line}")
            places, at = [], 2
            while at < len(rest):
                key = int(rest[at])
                if key == 12 and kind == 1:
                    places.append([float(word) for word in rest[at + 1:at + 4]])
                at += 1 + {24: 2, 2: 1, **VALUES}[key]
            found[int(words[1])] = (kind, geometry, rest[1], places)
    return found


if not PROGRAM:
    skip("what MUSEN reads: cmusen is not in the PATH (github.com/msolids/musen)")
with Bench() as bench:
    bench.segment_sintered(60, 10)
    bench.run("export", "scene.txt", "--as", "network", source="grains.vdb")
    bench.run("export", "network.csv", "--as", "network", source="grains.vdb")
    with open(bench.path("script.txt"), "w") as file:
        with open(PAGE) as page:
            file.write(page.read().split("```text\n")[1].split("```")[0])
        for name in ("scene", "later"):
            file.write(EXPORT.format(folder=bench.folder, name=name))
    result = subprocess.run([PROGRAM, f"-s={bench.path('script.txt')}"], cwd=bench.folder,
                            capture_output=True, text=True, timeout=300)
    check(result.returncode == 0 and "rror" not in result.stdout + result.stderr,
          f"MUSEN: {result.stdout}{result.stderr}")
    with open(bench.path("network.csv"), newline="") as file:
        rows = list(csv.DictReader(file))
    grains = [row for row in rows if row["pore.grain_id"]]
    bonds = [row for row in rows if row["throat.conns[0]"]]
    check(len(grains) > 5 and len(bonds) > 5, "a sample too small to tell")
    back, later = objects(bench.path("scene_back.txt")), objects(bench.path("later_back.txt"))
    check(len(back) == len(grains) + len(bonds), f"{len(back)} objects")
    for row in grains:
        kind, geometry, compound, places = back[int(row["pore.grain_id"])]
        check(kind == 1 and compound == "GRAIN", f"type {kind} of {compound}")
        radius = (3 / (4 * math.pi) * float(row["pore.volume"])) ** (1 / 3) / 1000  # mm
        check(all(abs(value / radius - 1) < 1e-6 for value in geometry), f"radii {geometry}")
        place = [float(row[f"pore.coords[{axis}]"]) / 1000 for axis in range(3)]
        check(math.dist(places[0], place) < 1e-9, f"place {places[0]}, not {place}")
        after = later[int(row["pore.grain_id"])][3]
        check(len(after) > 1 and math.dist(after[-1], place) < 1e-9, f"it moved: {after}")
    last = max(int(row["pore.grain_id"]) for row in grains)
    for number, row in enumerate(bonds, last + 1):
        kind, (first, second, diameter, length), compound, _ = back[number]
        check(kind == 9 and compound == "BOND", f"type {kind} of {compound}")
        ends = [int(grains[int(row[f"throat.conns[{end}]"])]["pore.grain_id"]) for end in (0, 1)]
        check([first, second] == ends, f"bond {number} of {first} and {second}")
        area = math.pi / 4 * diameter ** 2 * 1e6
        check(abs(area / float(row["throat.area"]) - 1) < 1e-6, f"area {area}")
        check(abs(length * 1000 / float(row["throat.length"]) - 1) < 1e-6, f"length {length}")
print(f"MUSEN imports {len(grains)} spheres and {len(bonds)} bonds, and leaves them at rest")
