# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""Snakemake takes a folder of scans to tables, pictures and reports, and goes on after a stop.

    snakemake_runs.py COMMAND
"""

import os
import shutil
import subprocess

from proof import Bench, check, skip

SNAKEFILE = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../tools/Snakefile")
OPTIONS = ("--phase", "1", "--voxel-size", "10um")  # of segment
KINDS = ("bonds.csv", "grains.csv", "labels.png", "labels.vdb", "report.html", "sample.json",
         "summary.json")
if not shutil.which("snakemake"):
    skip("tools/Snakefile: snakemake is not installed")


def read(path):
    with open(path, "rb") as file:
        return file.read()


with Bench() as bench:
    def fails(*words):
        result = subprocess.run([bench.tool, *words, "-q"], cwd=bench.folder, capture_output=True)
        return result.stderr.decode() if result.returncode else ""

    def run(*words):
        check(not fails(*words), f"{words}: {fails(*words)}")

    def generate(name, seed):
        run("generate", "snow", name, "--size", "32", "--length", "10", "--seed", seed)

    def times():
        results = bench.path("results")
        files = [os.path.join(folder, name) for folder, _, names in os.walk(results)
                 for name in names]
        return {os.path.relpath(file, results): os.stat(file).st_mtime_ns for file in files}

    def snakemake(code=0):
        """The files that were made; what was said."""
        before = times()
        config = ["scans=scans", f"command={bench.tool}", f"segment={' '.join(OPTIONS)}",
                  "measure=--ice", "render=--size 64"]
        result = subprocess.run(
            ["snakemake", "-s", SNAKEFILE, "--cores", "2", "--keep-going", "--config", *config],
            cwd=bench.folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        check(result.returncode == code, f"exit code {result.returncode}: {result.stdout}")
        after = times()
        made = sorted(name for name in after if after[name] != before.get(name))
        return made, result.stdout

    # What is in no folder, or in it twice, is told in a line.
    check("there is no such folder" in snakemake(code=1)[1], "no folder of scans")
    os.makedirs(bench.path("scans/slices"))
    generate("scans/core 1.tif", "1")
    generate("scans/core 1.npy", "2")
    check("both would go to" in snakemake(code=1)[1], "two scans of one name")
    os.rename(bench.path("scans/core 1.npy"), bench.path("scans/second.npy"))
    shutil.copy(bench.path("scans/second.npy"), bench.path("scans/run{A}.npy"))
    check("run{A}.npy: braces in names" in snakemake(code=1)[1], "a name with braces")
    os.remove(bench.path("scans/run{A}.npy"))
    for z in range(6):
        run("convert", "scans/second.npy", f"scans/slices/{z}.tif",
            "--crop", f"0,0,{z}:31,31,{z}")
    if fails("report", "scans/second.npy", "probe.html"):
        skip("tools/Snakefile: this vdb_madf was built without the verb report")

    # Headers with data beside them are a scan each.
    generate("scans/meta.mhd", "3")
    shutil.copy(bench.path("scans/meta.raw"), bench.path("scans/nrrd.raw"))
    with open(bench.path("scans/nrrd.nhdr"), "w") as file:
        file.write("NRRD0004\ntype: uint8\ndimension: 3\nsizes: 32 32 32\nencoding: raw\n"
                   "data file: nrrd.raw\n")
    shutil.copy(bench.path("scans/meta.raw"), bench.path("scans/pyhst.vol"))
    with open(bench.path("scans/pyhst.vol.info"), "w") as file:
        file.write("! PyHST_SLAVE VOLUME INFO FILE\nNUM_X = 32\nNUM_Y = 32\nNUM_Z = 32\n")

    samples = ("core 1", "meta", "nrrd", "pyhst", "second", "slices")
    wanted = sorted(["samples.csv"] + [f"{s}/{kind}" for s in samples for kind in KINDS])
    made, _ = snakemake()
    check(made == wanted, f"made: {made}")
    # The bytes are those of the command by hand.
    os.makedirs(bench.path("hand/core 1"))
    labels = "hand/core 1/labels.vdb"
    run("segment", "scans/core 1.tif", labels, *OPTIONS)
    run("measure", labels, "hand/core 1", "--sample", "core 1", "--ice")
    for name in ("labels.vdb", "grains.csv", "bonds.csv"):
        same = read(bench.path(f"hand/core 1/{name}")) == read(bench.path(f"results/core 1/{name}"))
        check(same, name)
    rows = read(bench.path("results/samples.csv")).decode().splitlines()
    check([row.split(",")[0] for row in rows] == ["sample", *samples], f"samples.csv: {rows}")

    # Once more: nothing. What a stop has left out and what depends on it: nothing else.
    check(snakemake()[0] == [], "all was done")
    os.remove(bench.path("results/second/labels.vdb"))
    made, _ = snakemake()
    check("second/labels.vdb" in made, f"made again: {made}")
    check(all(name.startswith("second/") or name == "samples.csv" for name in made), f"{made}")
    # Another scan in the place of one, though it is older, other data of a header, another slice.
    generate("other.npy", "5")
    generate("other.mhd", "5")
    run("convert", "other.npy", "other.tif", "--crop", "0,0,3:31,31,3")
    old = os.stat(bench.path("scans/second.npy")).st_mtime - 9e4
    for new, place in (("other.npy", "second.npy"), ("other.raw", "meta.raw"),
                       ("other.tif", "slices/3.tif")):
        os.utime(bench.path(new), (old, old))
        os.replace(bench.path(new), bench.path("scans/" + place))
    made, _ = snakemake()
    check(made == sorted(["samples.csv"] + [f"{s}/{kind}" for s in ("meta", "second", "slices")
                                            for kind in KINDS]), f"of other scans: {made}")
    # A scan that cannot be read: the others are done all the same.
    with open(bench.path("scans/bad.tif"), "w") as file:
        file.write("damaged")
    generate("scans/fourth.tif", "4")
    made, said = snakemake(code=1)
    check(made == [f"fourth/{kind}" for kind in KINDS], f"made beside a bad scan: {made}")
    check("bad.tif" in said, said)
    os.remove(bench.path("scans/bad.tif"))
    check(snakemake()[0] == ["samples.csv"], "the table, without the bad scan")
    print("Snakemake makes each file of each scan once, and goes on after a stop")
