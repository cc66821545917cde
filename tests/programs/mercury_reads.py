# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""MercuryDPM's LoadClumps() reads our folder of clumps, which lie in the world as ours do.

VDB_MADF_MERCURYDPM names a checkout of MercuryDPM, which is not part of the project: a program with
its header Drivers/Clump/ClumpHeaders/ClumpInput.h is compiled by g++ and loads the folder. Where
ClumpParticle would put the pebbles is computed here.
"""

import csv
import json
import os
import shutil
import subprocess

from proof import Bench, check, near, skip

SOURCE = os.environ.get("VDB_MADF_MERCURYDPM", "")
HEADERS = os.path.join(SOURCE, "Drivers/Clump/ClumpHeaders")
PROGRAM = r"""
#include "Logger.h"
#include "ClumpInput.h"
const std::string getMercuryDPMSourceDir() { return FOLDER; }
static void list(const char* name, const DoubleVector& values, const char* end) {
  std::cerr << '"' << name << "\": [";
  for (size_t i = 0; i < values.size(); ++i) std::cerr << (i ? ", " : "") << values[i];
  std::cerr << "]" << end;
}
int main() {
  ClumpData data;
  LoadClumps(data);
  std::cerr.precision(9);
  std::cerr << "[";
  for (size_t i = 0; i < data.clumpNames.size(); ++i) {
    std::cerr << (i ? "," : "") << "{\"name\": \"" << data.clumpNames[i] << "\", ";
    list("x", data.pebblesX[i], ", ");
    list("y", data.pebblesY[i], ", ");
    list("z", data.pebblesZ[i], ", ");
    list("r", data.pebblesR[i], ", ");
    list("toi", data.toi[i], ", ");
    list("pd", data.pd[i], ", ");
    list("mass", {data.mass[i]}, "}\n");
  }
  std::cerr << "]";
}
"""


def build(bench):
    """The definitions that CMake would fill in are those of a build without backtraces."""
    with open(os.path.join(SOURCE, "Configuration/CMakeDefinitions.h")) as file:
        text = file.read().replace("@MercuryDPM_BACKTRACE_ENABLE@", "OFF")
    with open(bench.path("CMakeDefinitions.h"), "w") as file:
        file.write(text.replace("@MercuryDPM_BACKTRACE_DEMANGLE@", "OFF"))
    with open(bench.path("load.cc"), "w") as file:
        file.write(PROGRAM)
    kernel = os.path.join(SOURCE, "Kernel")
    subprocess.run(["g++", "-std=c++17", "-w", f'-DFOLDER="{bench.folder}"', "-I", bench.folder,
                    "-I", kernel, "-I", HEADERS, bench.path("load.cc"), f"{kernel}/Logger.cc",
                    f"{kernel}/Math/Vector.cc", "-o", bench.path("load")], check=True)


def relative(found, wanted, tolerance=1e-6):
    return abs(found - wanted) <= tolerance * abs(wanted)


if not os.path.isfile(os.path.join(HEADERS, "ClumpInput.h")):
    skip("what MercuryDPM reads: VDB_MADF_MERCURYDPM names no checkout of it")
if not shutil.which("g++"):
    skip("what MercuryDPM reads: g++ is not installed")
with Bench() as bench:
    bench.segment_sintered(60, 10)
    os.makedirs(bench.path("Tools/MClump"))
    options = ("--as", "clumps", "--apart", "--balls", "8")
    folder = bench.run("export", "Tools/MClump/Clumps", *options, source="grains.vdb")
    bench.run("export", "clumps.csv", *options, source="grains.vdb")
    subprocess.run([bench.tool, "measure", bench.path("grains.vdb"), bench.path("tables"), "-q"],
                   check=True)
    with open(bench.path("tables/grains.csv")) as file:
        grains = {int(row["id"]): row for row in csv.DictReader(file)}
    with open(bench.path("clumps.csv")) as file:
        balls = [{key: float(value) for key, value in row.items()}
                 for row in csv.DictReader(file)]
    with open(os.path.join(folder, "places.csv")) as file:
        places = {int(row["grain_id"]): [float(row[axis]) for axis in "xyz"]
                  for row in csv.DictReader(file)}
    build(bench)
    result = subprocess.run([bench.path("load")], capture_output=True, text=True)
    check(result.returncode == 0, f"LoadClumps: {result.stdout}{result.stderr}")
    clumps = json.loads(result.stderr)
    labels = sorted({int(ball["grain_id"]) for ball in balls})
    check([clump["name"] for clump in clumps] == [f"grain_{label:06}" for label in labels],
          f"{[clump['name'] for clump in clumps]}")
    check(len(labels) > 5 and sorted(places) == labels, "a sample too small to tell")
    for label, clump in zip(labels, clumps):
        own = [ball for ball in balls if ball["grain_id"] == label]
        check(len(own) == len(clump["r"]), f"{clump['name']}: {len(clump['r'])} pebbles")
        check(near(places[label], [float(grains[label][f"centroid_{axis}_mm"]) for axis in "xyz"]),
              f"{clump['name']}: place {places[label]}")
        check(relative(clump["mass"][0], float(grains[label]["volume_mm3"])), "mass")
        inertia = clump["toi"]
        lengths = [float(grains[label][f"axis{i}_length_mm"]) for i in (1, 2, 3)]
        for i in range(3):
            others = sum(lengths[j] ** 2 for j in range(3) if j != i) / 20
            check(relative(inertia[4 * i], clump["mass"][0] * others, 1e-5), f"inertia {inertia}")
        check(all(inertia[i] == 0 for i in range(9) if i % 4), f"inertia {inertia}")
        axes = [[clump["pd"][3 * row + axis] for row in range(3)] for axis in range(3)]
        for ball, *along, radius in zip(own, clump["x"], clump["y"], clump["z"], clump["r"]):
            # As ClumpParticle::updatePebblesVelPos() does.
            place = [places[label][i] + sum(axes[axis][i] * along[axis] for axis in range(3))
                     for i in range(3)]
            check(near(place, [ball[axis] for axis in "xyz"]), f"{clump['name']}: {place}")
            check(relative(radius, ball["radius"]), f"{clump['name']}: radius {radius}")
print(f"MercuryDPM's LoadClumps() reads {len(clumps)} clumps, which lie where ours do")
