# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""A real scan goes the whole way: segment, export as preview volume and as mesh, and Blender's
pictures of both show the same grains in the same many colors.

The folder that holds nmc.tif (see tests/whole/real_scan_test.cc) is $VDB_MADF_DATA, without it
$VDB_MADF_DATA_DIR. Runs itself again inside Blender. With a second argument the pictures are kept
in that folder.
"""

import os
import shutil
import subprocess
import sys
import tempfile

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from proof import check, run_in_blender, skip  # noqa: E402

try:
    import bpy
except ImportError:
    bpy = None
else:
    import blender_picture

PIXELS = 240


def start():
    tool = os.path.abspath(sys.argv[1])
    data = os.environ.get("VDB_MADF_DATA") or os.environ.get("VDB_MADF_DATA_DIR", "")
    scan = os.path.join(data, "nmc.tif")
    if not os.path.exists(scan):
        skip(f"a real scan in Blender: no {scan}. Set VDB_MADF_DATA to the folder that holds "
             f"nmc.tif")
    if not shutil.which("blender"):
        skip("a real scan in Blender: blender is not installed (tools/setup --blender)")
    with tempfile.TemporaryDirectory(prefix="vdb_madf_") as folder:
        def run(verb, source, output, *options):
            subprocess.run([tool, verb, source, os.path.join(folder, output), "-q", *options],
                           check=True)

        grains = os.path.join(folder, "grains.vdb")
        run("segment", scan, "grains.vdb", "--phase", "1", "--gamma", "160")
        run("export", grains, "view.vdb", "--as", "viz", "--max-dim", "160")
        run("export", grains, "grains.obj", "--max-dim", "80")
        print(run_in_blender(__file__, folder, "a real scan in Blender"))
        if len(sys.argv) > 2:
            for name in ("volume.png", "mesh.png"):
                shutil.copy(os.path.join(folder, name), sys.argv[2])


def seen(path):
    """Where the picture shows something, and its hues."""
    values = list(bpy.data.images.load(path).pixels)
    pixels = [values[i:i + 3] for i in range(0, len(values), 4)]
    shown = [max(abs(a - b) for a, b in zip(pixel, pixels[0])) > 0.05 for pixel in pixels]
    return shown, blender_picture.hues(path, 24)


def inside(folder):
    pictures, corners = {}, None
    for name, source in (("mesh", "grains.obj"), ("volume", "view.vdb")):
        thing = blender_picture.opened(os.path.join(folder, source))
        # The mesh's place for both: else each picture would be centered by itself.
        corners = corners or blender_picture.box_of(thing)
        picture = os.path.join(folder, name + ".png")
        blender_picture.render_export(thing, picture, PIXELS, 24, corners)
        pictures[name] = seen(picture)

    said = []
    for name, (shown, hues) in pictures.items():
        covered = sum(shown)
        kinds = [h for h in range(24) if hues.count(h) > 0.005 * covered]
        said.append(f"{name}: {covered / len(shown):.0%} of the picture, {len(kinds)} of 24 hues")
        check(0.3 < covered / len(shown) < 0.8, said[-1])
        check(len(kinds) >= 14, said[-1])
        # Grains, not noise: a neighbor seldom has another hue.
        pairs = [(a, b) for a, b in zip(hues, hues[1:]) if a is not None and b is not None]
        check(sum((a - b + 1) % 24 <= 2 for a, b in pairs) > 0.7 * len(pairs), f"{name} is noise")
    (here, one), (there, other) = pictures.values()
    both = sum(a and b for a, b in zip(here, there)) / sum(a or b for a, b in zip(here, there))
    check(both > 0.9, f"mesh and volume share only {both:.0%} of their pixels")
    pairs = [(a, b) for a, b in zip(one, other) if a is not None and b is not None]
    alike = sum((a - b + 1) % 24 <= 2 for a, b in pairs) / len(pairs)
    check(alike > 0.6, f"mesh and volume have the same color on only {alike:.0%} of their pixels")
    print(f"DONE: a real scan in Blender: {'; '.join(said)}; {both:.0%} of the pixels shared, "
          f"{alike:.0%} of them alike")


if __name__ == "__main__":
    if bpy:
        inside(sys.argv[sys.argv.index("--") + 1])
    else:
        start()
