# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""OpenVDB's own programs read our VDB files; the files keep Houdini's and Blender's rules."""

import shutil
import subprocess

from proof import Bench, EDGE, LABELS, check, near, skip

try:
    import numpy  # noqa: F401  the module needs it, and crashes without
    import pyopenvdb
except ImportError as error:
    skip(f"what OpenVDB's Python reads: python3-openvdb is not installed ({error})")
if not shutil.which("vdb_print"):
    skip("what vdb_print reads: libopenvdb-tools is not installed")

# Houdini and Blender have no mask grids; label grids are left to programs that know them.
TYPES = {"density": "float", "color": "vec3s", "surface": "float"}

with Bench() as bench:
    view = bench.run("export", "view.vdb", "--as", "viz")
    half = bench.run("export", "half.vdb", "--as", "viz", "--reduce", "2")
    lod = bench.run("export", "lod.vdb", "--as", "lod")
    grids = bench.run("export", "grids.vdb", "--as", "grids")
    surface = bench.run("export", "surface.vdb", "--as", "surface")
    for path in (view, half, lod, grids, surface):
        text = subprocess.run(["vdb_print", "-l", path], check=True, capture_output=True, text=True)
        check(not text.stderr, f"vdb_print on {path}: {text.stderr}")

    metadata = {grid.name: grid for grid in pyopenvdb.readAllGridMetadata(view)}
    check(sorted(metadata) == ["color", "density"], f"view.vdb holds {sorted(metadata)}")
    for path in (view, half, surface, grids):
        for grid in pyopenvdb.readAllGridMetadata(path):
            wanted = TYPES.get(grid.name, "float")
            check(grid.valueTypeName == wanted, f"{path}: {grid.name} is {grid.valueTypeName}")
            check(grid.name.replace("_", "").isalnum(), f"{path}: name {grid.name}")
            check(all(len(key) and " " not in key for key in grid.metadata), f"{path}: metadata")

    density = pyopenvdb.read(view, "density")
    check(density.gridClass == "fog volume", "view.vdb: density is no fog volume")
    check(density.activeVoxelCount() == len(LABELS), "view.vdb: number of voxels")
    color = pyopenvdb.read(view, "color")
    for place in LABELS:
        check(density.getAccessor().getValue(place) == 1, f"view.vdb: density at {place}")
        check(max(color.getAccessor().getValue(place)) > 0, f"view.vdb: color at {place}")
        check(near(density.transform.indexToWorld(place), [EDGE * i for i in place]),
              f"view.vdb: place of {place}")
    coarse = pyopenvdb.read(half, "density")
    check(near(coarse.transform.indexToWorld((0, 0, 0)), [0.5 * EDGE] * 3), "half.vdb: half a voxel")
    check(abs(coarse.getAccessor().getValue((1, 1, 2)) - 1 / 8) < 1e-6, "half.vdb: ice fraction")

    names = sorted(grid.name for grid in pyopenvdb.readAllGridMetadata(grids))
    check(names == ["grain_000001", "grain_000002", "grain_000003", "grain_070000"],
          f"grids.vdb holds {names}")
    masks = bench.run("export", "masks.vdb", "--as", "grids", "--bool")
    for label in set(LABELS.values()):
        mask = pyopenvdb.read(masks, f"grain_{label:06d}")
        check(mask.valueTypeName == "bool", f"masks.vdb: {mask.valueTypeName}")
        voxels = [place for place in LABELS if mask.getAccessor().getValue(place)]
        check(voxels == [place for place in LABELS if LABELS[place] == label], f"masks.vdb: {label}")
        check(mask.activeVoxelCount() == len(voxels), f"masks.vdb: voxels of {label}")
    for path, name, inside in ((grids, "grain_000001", (2, 3, 5)), (surface, "surface", (7, 1, 2))):
        level_set = pyopenvdb.read(path, name)
        check(level_set.gridClass == "level set", f"{name} is no level set")
        check(level_set.getAccessor().getValue(inside) < 0, f"{name}: sign inside")
        check(level_set.getAccessor().getValue((5, 5, 5)) > 0, f"{name}: sign outside")
print("vdb_print and pyopenvdb read the VDB files")
