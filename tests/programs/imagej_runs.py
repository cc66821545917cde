# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""ImageJ hands stacks over by tools/doors/Vdb_Madf.java, and has their grains and tables.

It runs in a display without a screen (Xvfb), for its tables are windows.
"""

import array
import csv
import os
import shutil
import subprocess

from proof import Bench, check, skip

PLUGIN = os.path.abspath(os.path.join(os.path.dirname(__file__), "../../tools/doors/Vdb_Madf.java"))
IMAGEJ = "/usr/share/java/ij.jar"
if not os.path.exists(IMAGEJ) or not all(map(shutil.which, ("java", "javac", "xvfb-run"))):
    skip("what ImageJ shows: imagej, javac or xvfb is not installed (tools/setup --programs)")

# Cells are printed as they are, for ImageJ shows and saves few digits.
SCRIPT = """
run("A Reader", "keys={keys}");
{before}
run("Vdb Madf", "command=[{command}] segment=[{segment}] measure=[{measure}]");
print("image " + getTitle() + "," + nSlices);
getVoxelSize(width, height, depth, unit);
print("voxel " + width + "," + height + "," + depth + "," + unit);
x = 0; y = 0; z = 0;
toScaled(x, y, z);
print("first " + x + "," + y + "," + z);
saveAs("Tiff", "{labels}");
names = newArray("grains.csv", "bonds.csv");
for (n = 0; n < 2; n++) {{
  columns = split(Table.headings(names[n]), "\\t");
  for (i = 0; i < Table.size(names[n]); i++) {{
    row = names[n];
    for (c = 0; c < columns.length; c++)
      row += "," + d2s(Table.get(columns[c], i, names[n]), -9);
    print(row);
  }}
}}
"""
# In the place of somebody before the screen: reads messages and closes them, and hits Esc if asked.
READER = """
import java.awt.*;

public class A_Reader implements ij.plugin.PlugIn {
  public void run(String unused) {
    boolean hits = ij.Macro.getOptions().contains("Esc");
    Thread thread = new Thread(() -> {
      for (;;) {
        ij.IJ.wait(50);
        if (hits) ij.IJ.setKeyDown(java.awt.event.KeyEvent.VK_ESCAPE);
        for (Window window : Window.getWindows())
          if (window instanceof Dialog && window.isVisible()) {
            ij.IJ.wait(500);  // until it waits for somebody
            for (Component part : window.getComponents()) read(part);
            EventQueue.invokeLater(window::dispose);
          }
      }
    });
    thread.setDaemon(true);
    thread.start();
  }

  private static void read(Component part) {
    try {
      java.lang.reflect.Field lines = part.getClass().getDeclaredField("lines");
      lines.setAccessible(true);
      System.out.println("message " + ((String[]) lines.get(part))[0]);
    } catch (ReflectiveOperationException otherPart) {
    }
  }
}
"""


def compile_plugin(bench, *sources):
    # Fiji's Java may be as old as 8.
    done = subprocess.run(
        ["javac", "--release", "8", "-Xlint:all,-options", "-Werror", "-cp", IMAGEJ, "-d",
         bench.path("ij/plugins"), *sources], capture_output=True, text=True)
    check(done.returncode == 0, "javac: " + done.stdout + done.stderr)


def run_imagej(bench, script):
    """What it prints."""
    with open(bench.path("script.ijm"), "w") as file:
        file.write(script)
    result = subprocess.run(
        ["xvfb-run", "-a", "timeout", "100", "java", "-Dplugins.dir=" + bench.path("ij"),
         "-Djava.io.tmpdir=" + bench.path("it's temporary"), "-Duser.home=" + bench.folder,
         "-cp", IMAGEJ, "ij.ImageJ", "-batch", bench.path("script.ijm")], cwd=bench.folder,
        env={**os.environ, "HOME": bench.folder}, capture_output=True, text=True)
    check(result.returncode == 0, "ImageJ: " + result.stdout + result.stderr)
    left = [name for name in os.listdir(bench.path("it's temporary")) if "madf" in name]
    check(not left, f"{left} is left over")
    return result.stdout.splitlines()


def rows(path):
    with open(path, newline="") as file:
        return [[float(cell or "nan") for cell in row] for row in list(csv.reader(file))[1:]]


def same(a, b):
    return a != a or abs(a - b) <= 1e-9 * abs(a)


with Bench() as bench:
    def madf(*words):
        subprocess.run([bench.tool, *words, "-q"], cwd=bench.folder, check=True)

    def check_what_it_has(said, what):
        """The labels from imagej.tif, and the printed tables, against those of the command."""
        madf("convert", "grains.vdb", "ours.raw", "--type", "int32")
        madf("convert", "from imagej.tif", "theirs.raw", "--type", "int32")
        with open(bench.path("ours.raw"), "rb") as ours:
            with open(bench.path("theirs.raw"), "rb") as theirs:
                check(ours.read() == theirs.read(), what + ": the labels that ImageJ has")
        for name in ("grains.csv", "bonds.csv"):
            ours = rows(bench.path("tables/" + name))
            theirs = [[float(cell) for cell in line.split(",")[1:]]
                      for line in said if line.startswith(name + ",")]
            check(len(ours) == len(theirs) > 10,
                  f"{what}: {name} has {len(theirs)} rows, not {len(ours)}: {said[:9]}")
            for mine, other in zip(ours, theirs):
                check(len(mine) == len(other) and all(map(same, mine, other)),
                      f"{what}: {name}: {other}, not {mine}")

    # With spaces and an apostrophe in the names of the program, the folder and the scan.
    os.makedirs(bench.path("ij/plugins"))
    os.mkdir(bench.path("it's temporary"))
    os.symlink(bench.tool, bench.path("the program's name"))
    with open(bench.path("A_Reader.java"), "w") as file:
        file.write(READER)
    compile_plugin(bench, PLUGIN, bench.path("A_Reader.java"))

    def cut(before, segment, measure="", command=bench.path("the program's name"), keys="none"):
        return run_imagej(bench, SCRIPT.format(
            before=before, segment=segment, measure=measure, command=command, keys=keys,
            labels=bench.path("from imagej.tif")))

    madf("generate", "snow", "a scan's.tif", "--size", "40", "--length", "14")
    scan = f"""open("{bench.path("a scan's.tif")}");"""
    said = cut(scan + """
run("Properties...", "unit=micron pixel_width=0.5 pixel_height=0.5 voxel_depth=1");
""", "--phase 1",
               rf"""--shape --unit um --size-curve \"{bench.path('the curve.csv')}\" """)
    check(os.path.exists(bench.path("the curve.csv")), "a path with a space in double quotes")
    check("image grains of a scan's.tif,40" in said and "voxel 0.5,0.5,1,microns" in said,
          f"ImageJ: {said[:9]}")
    madf("segment", "a scan's.tif", "grains.vdb", "--phase", "1", "--voxel-size", "0.5x0.5x1um")
    madf("measure", "grains.vdb", "tables", "--shape", "--unit", "um", "--size-curve", "ours.csv")
    check_what_it_has(said, "a calibrated stack")

    # A voxel size that is given overrules that of the stack; labels of a crop lie where it does.
    calibrated = scan + """
run("Properties...", "unit=micron pixel_width=0.5 pixel_height=0.5 voxel_depth=1");
"""
    said = cut(calibrated, "--phase 1 --voxel-size 3um --crop 2,3,4:39,39,39")
    check("voxel 3,3,3,microns" in said and "first 6,9,12" in said,
          f"a voxel size of its own, and a crop: {said[:9]}")
    madf("segment", "a scan's.tif", "grains.vdb", "--phase", "1", "--voxel-size", "3um",
         "--crop", "2,3,4:39,39,39")
    madf("measure", "grains.vdb", "tables")
    check_what_it_has(said, "a crop")
    # Notes are shown.
    said = cut(scan, "--phase 77")
    check(said[0].startswith("vdb_madf: note: scan.tif: nothing is selected"), f"{said[:9]}")

    # ImageJ has signed samples as unsigned ones and an offset. Inches are no voxel size.
    madf("convert", "a scan's.tif", "bytes.raw", "--type", "uint8")
    with open(bench.path("bytes.raw"), "rb") as file:
        signed = array.array("h", (300 * value - 200 for value in file.read()))
    with open(bench.path("signed.raw"), "wb") as file:
        file.write(signed.tobytes())
    said = cut(f"""
run("Raw...", "open=[{bench.path("signed.raw")}] image=[16-bit Signed] width=40 height=40 " +
    "offset=0 number=40 gap=0 little-endian");
run("Properties...", "unit=inch pixel_width=0.25 pixel_height=0.25 voxel_depth=0.25");
""", "--threshold -50")
    check("voxel 0.25,0.25,0.25,inches" in said, f"ImageJ: {said[:9]}")
    madf("segment", "signed.raw", "grains.vdb", "--dims", "40x40x40", "--type", "int16",
         "--threshold", "-50")
    madf("measure", "grains.vdb", "tables")
    check_what_it_has(said, "a signed stack in inches")

    # What fails is shown, and nothing is opened.
    def refused(segment, **more):
        said = cut(scan, segment, **more)
        check(said[0].startswith("message ") and not any(line[:5] == "image" for line in said),
              f"{segment} {more} went on: {said[:9]}")
        return said[0]

    said = refused("--keep x")
    line = subprocess.run([bench.tool, "segment", "a scan's.tif", "no.vdb", "--keep", "x"],
                          cwd=bench.folder, capture_output=True, text=True).stderr
    check(line and said.startswith("message " + line.strip()), f"not '{line}', but '{said}'")
    said = refused("", command=bench.path("no program"))
    check("no program" in said, f"without the program: {said}")
    with open(bench.path("slow"), "w") as file:
        file.write("#!/bin/sh\nexec sleep 1000\n")
    os.chmod(bench.path("slow"), 0o755)
    said = refused("", command=bench.path("slow"), keys="Esc")
    check("was stopped" in said, f"Esc: {said}")
print("ImageJ hands stacks over, and has their grains and tables")
