# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""Blender, without a display, reads our preview VDB and our PLY, meshes the fog and renders both;
and finds each grain of our GLB at its place, with its color and its measures.

Runs itself again inside Blender. With a second argument the pictures are kept in that folder.
"""

import os
import shutil
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from proof import EDGE, LABELS, VOXELS, Bench, box_of, check, near, run_in_blender  # noqa: E402

try:
    import bpy
except ImportError:
    bpy = None
else:
    import blender_picture

LAST = [max(place[axis] for place in LABELS) for axis in range(3)]
FIRST = [min(place[axis] for place in LABELS) for axis in range(3)]


def start():
    with Bench() as bench:
        bench.run("export", "view.vdb", "--as", "viz")
        bench.run("export", "grains.ply", "--smooth", "0")
        bench.run("export", "grains.glb", "--smooth", "0")
        print(run_in_blender(__file__, bench.folder, "what Blender reads"))
        if len(sys.argv) > 2:
            for name in ("volume.png", "mesh.png"):
                shutil.copy(bench.path(name), sys.argv[2])


def extent(mesh, which):
    return [which(vertex.co[axis] for vertex in mesh.vertices) / EDGE for axis in range(3)]


def check_volume(fog):
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
    mesh = shell.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    check(len(mesh.polygons) > 0, "Volume to Mesh is empty")
    # Blender takes the place of a voxel for its lowest corner: half a voxel too far. Corners of
    # this mesh are blunt.
    check(near(extent(mesh, min), FIRST, 0.4), f"Volume to Mesh begins at {extent(mesh, min)}")
    check(near(extent(mesh, max), [i + 1 for i in LAST], 0.4),
          f"Volume to Mesh ends at {extent(mesh, max)}")
    bpy.data.objects.remove(shell)


def check_mesh(mesh):
    check(len(mesh.polygons) > 0, "the PLY has no faces")
    check(near(extent(mesh, min), [i - 0.5 for i in FIRST], 1e-3),
          f"the PLY begins at {extent(mesh, min)}")
    check(near(extent(mesh, max), [i + 0.5 for i in LAST], 1e-3),
          f"the PLY ends at {extent(mesh, max)}")
    check(len(mesh.color_attributes) == 1, "the PLY has no colors")
    colors = {tuple(round(c, 3) for c in item.color) for item in mesh.color_attributes[0].data}
    check(len(colors) == len(set(LABELS.values())), f"{len(colors)} colors")


def volume_of(mesh):
    mesh.calc_loop_triangles()
    corners = [[mesh.vertices[i].co for i in triangle.vertices] for triangle in mesh.loop_triangles]
    return sum(a.dot(b.cross(c)) / 6 for a, b, c in corners)


def check_grains(path):
    """In the places of the PLY, which are those of the volume."""
    import numpy
    if not hasattr(numpy, "bool"):
        numpy.bool = bool  # the importer of Blender 3.4 asks for it; newer numpy has it no more
    before = set(bpy.data.objects)
    bpy.ops.import_scene.gltf(filepath=path)
    grains = {thing.name: thing for thing in set(bpy.data.objects) - before}
    check(set(grains) == {f"grain_{label:06d}" for label in VOXELS},
          f"the GLB has {sorted(grains)}")
    for label, count in VOXELS.items():
        grain = grains[f"grain_{label:06d}"]
        places = [grain.matrix_world @ vertex.co for vertex in grain.data.vertices]
        bounds = [which(place[axis] for place in places) for axis in range(3)
                  for which in (min, max)]
        check(near(bounds, box_of(label)), f"{grain.name} lies at {bounds}, not {box_of(label)}")
        voxels = volume_of(grain.data) / EDGE**3
        check(abs(voxels - count) < 1e-3, f"{grain.name} has the volume of {voxels} voxels")
        check(grain["grain_id"] == label and grain["voxels"] == count and
              abs(grain["volume"] - count * EDGE**3) < 1e-12, f"{grain.name} has {dict(grain)}")
    colors = {tuple(grain.data.materials[0].diffuse_color) for grain in grains.values()}
    check(len(colors) == len(VOXELS), f"the GLB has {len(colors)} colors")
    for grain in grains.values():
        bpy.data.objects.remove(grain)


def inside(folder):
    mesh = blender_picture.opened(os.path.join(folder, "grains.ply"))
    check_mesh(mesh.data)
    check_grains(os.path.join(folder, "grains.glb"))
    corners = blender_picture.box_of(mesh)
    pictures = [os.path.join(folder, name) for name in ("mesh.png", "volume.png")]
    blender_picture.render_export(mesh, pictures[0], 160, 8)
    fog = blender_picture.opened(os.path.join(folder, "view.vdb"))
    check_volume(fog)
    blender_picture.render_export(fog, pictures[1], 160, 8, corners)
    for picture, least in zip(pictures, (3, 2)):  # a grain of one voxel is a pale cloud
        hues = [hue for hue in blender_picture.hues(picture, 12) if hue is not None]
        many = {hue for hue in hues if hues.count(hue) >= 10}
        check(len(many) >= least, f"{os.path.basename(picture)} shows the hues {many}")
    print("DONE: Blender reads the preview, the PLY and the GLB, meshes the fog and renders")


if __name__ == "__main__":
    if bpy:
        inside(sys.argv[sys.argv.index("--") + 1])
    else:
        start()
