# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""Blender, without a display, reads our preview VDB and our PLY, meshes the fog and renders both.

Runs itself again inside Blender. With a second argument the picture is kept there.
"""

import os
import shutil
import subprocess
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from proof import EDGE, LABELS, Bench, check, near, skip  # noqa: E402

try:
    import bpy
except ImportError:
    bpy = None
else:
    import blender_picture


def start():
    if not shutil.which("blender"):
        skip("what Blender reads: blender is not installed (tools/setup --blender)")
    with Bench() as bench:
        bench.run("export", "view.vdb", "--as", "viz")
        bench.run("export", "grains.ply", "--smooth", "0")
        result = subprocess.run(
            ["blender", "--background", "--factory-startup", "-noaudio", "--python-exit-code", "1",
             "--python", os.path.abspath(__file__), "--", bench.folder],
            capture_output=True, text=True, timeout=900)
        check(result.returncode == 0 and "all read" in result.stdout,
              "Blender: " + result.stdout[-2000:] + result.stderr[-2000:])
        if len(sys.argv) > 2:
            shutil.copy(bench.path("picture.png"), sys.argv[2])
    print("Blender reads the preview and the PLY, meshes the fog and renders")


def inside(folder):
    for thing in list(bpy.data.objects):
        bpy.data.objects.remove(thing)

    bpy.ops.object.volume_import(filepath=os.path.join(folder, "view.vdb"), align="WORLD",
                                 location=(0, 0, 0))
    fog = bpy.context.object
    fog.data.grids.load()
    types = {grid.name: grid.data_type for grid in fog.data.grids}
    check(types == {"density": "FLOAT", "color": "VECTOR_FLOAT"}, f"grids {types}")

    # Volume to Mesh on the density alone.
    shell = bpy.data.objects.new("shell", bpy.data.meshes.new("shell"))
    bpy.context.collection.objects.link(shell)
    modifier = shell.modifiers.new("fog", "VOLUME_TO_MESH")
    modifier.object = fog
    modifier.grid_name = "density"
    modifier.threshold = 0.5
    modifier.resolution_mode = "GRID"
    evaluated = shell.evaluated_get(bpy.context.evaluated_depsgraph_get())
    check(len(evaluated.data.polygons) > 0, "Volume to Mesh is empty")
    shell.hide_render = True

    bpy.ops.import_mesh.ply(filepath=os.path.join(folder, "grains.ply"))
    mesh = bpy.context.object
    check(len(mesh.data.polygons) > 0, "the PLY has no faces")
    check(len(mesh.data.color_attributes) == 1, "the PLY has no colours")
    middle = [sum(v.co[axis] for v in mesh.data.vertices) for axis in range(3)]
    lowest = [min(v.co[axis] for v in mesh.data.vertices) for axis in range(3)]
    check(middle and near(lowest, [(min(p[axis] for p in LABELS) - 0.5) * EDGE for axis in range(3)],
                          1e-5), f"the PLY begins at {lowest}")
    colors = {tuple(round(c, 3) for c in item.color)
              for item in mesh.data.color_attributes[0].data}
    check(len(colors) == len(set(LABELS.values())), f"{len(colors)} colours")

    picture_path = os.path.join(folder, "picture.png")
    blender_picture.render(mesh, picture_path, 160, 8)
    picture = bpy.data.images.load(picture_path)
    pixels = list(picture.pixels)
    check(len({tuple(round(c, 1) for c in pixels[i:i + 3]) for i in range(0, len(pixels), 4)}) > 3,
          "the picture shows nothing")
    print("all read")


if __name__ == "__main__":
    if bpy:
        inside(sys.argv[sys.argv.index("--") + 1])
    else:
        start()
