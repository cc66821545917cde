# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""ImageJ hands a stack over by tools/doors/imagej_vdb_madf.ijm, and has its grains and tables.

It runs in a display without a screen (Xvfb), for its tables are windows.
"""

import csv
import os
import shutil
import subprocess

from proof import Bench, check, skip

MACRO = os.path.abspath(os.path.join(os.path.dirname(__file__),
                                     "../../tools/doors/imagej_vdb_madf.ijm"))
IMAGEJ = "/usr/share/java/ij.jar"
if not os.path.exists(IMAGEJ) or not shutil.which("java") or not shutil.which("xvfb-run"):
    skip("what ImageJ shows: imagej or xvfb is not installed (tools/setup --programs)")

# With spaces in the names of the program, the folder and the scan.
SCRIPT = """
open("{scan}");
run("Properties...", "unit=micron pixel_width=10 pixel_height=10 voxel_depth=20");
runMacro("{macro}", "command=[{command}] segment=[--phase 1] measure=[--shape --unit um]");
print("image " + getTitle() + "," + nSlices);
getVoxelSize(width, height, depth, unit);
print("voxel " + width + "," + height + "," + depth);
saveAs("Tiff", "{labels}");
selectWindow("grains.csv");
Table.save("{grains}");
selectWindow("bonds.csv");
Table.save("{bonds}");
"""


def run_imagej(bench, script):
    """What it prints."""
    with open(bench.path("script.ijm"), "w") as file:
        file.write(script)
    result = subprocess.run(
        ["xvfb-run", "-a", "java", "-jar", IMAGEJ, "-batch", bench.path("script.ijm")],
        cwd=bench.folder, env={**os.environ, "TMPDIR": bench.folder, "HOME": bench.folder},
        capture_output=True, text=True, timeout=120)
    check(result.returncode == 0, "ImageJ: " + result.stdout + result.stderr)
    return result.stdout.splitlines()


def rows(path, separator=","):
    with open(path, newline="") as file:
        return [[float(cell or "nan") for cell in row]
                for row in list(csv.reader(file, delimiter=separator))[1:]]


with Bench() as bench:
    def madf(*words):
        subprocess.run([bench.tool, *words, "-q"], cwd=bench.folder, check=True)

    os.symlink(bench.tool, bench.path("the program"))
    madf("generate", "snow", "a scan.tif", "--size", "40", "--length", "14")
    said = run_imagej(bench, SCRIPT.format(
        scan=bench.path("a scan.tif"), macro=MACRO, command=bench.path("the program"),
        labels=bench.path("from imagej.tif"), grains=bench.path("grains.csv"),
        bonds=bench.path("bonds.csv")))
    check("image grains of a scan.tif,40" in said, f"ImageJ: {said}")
    check("voxel 10,10,20" in said, f"ImageJ: {said}")

    size = ("--voxel-size", "10x10x20um")
    madf("segment", "a scan.tif", "grains.vdb", "--phase", "1", *size)
    madf("measure", "grains.vdb", "tables", "--shape", "--unit", "um")
    madf("convert", "grains.vdb", "ours.raw", "--type", "int32")
    madf("convert", "from imagej.tif", "theirs.raw", "--type", "int32")
    with open(bench.path("ours.raw"), "rb") as ours, open(bench.path("theirs.raw"), "rb") as theirs:
        check(ours.read() == theirs.read(), "the labels that ImageJ has")
    for name in ("grains", "bonds"):
        ours, theirs = rows(bench.path(f"tables/{name}.csv")), rows(bench.path(name + ".csv"))
        check(len(ours) == len(theirs) > 10, f"{name}: {len(theirs)} rows, not {len(ours)}")
        for mine, other in zip(ours, theirs):
            check(all(a != a or abs(a - b) <= 1e-3 + 1e-3 * abs(a) for a, b in zip(mine, other)),
                  f"{name}: {other}, not {mine}")
    left = [name for name in os.listdir(bench.folder) if name.startswith("vdb_madf_")]
    check(not left, f"{left} is left over")
print("ImageJ hands a stack over, and has its grains and tables")
