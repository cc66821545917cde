# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""OpenVDB's own programs read our VDB files; the files keep Houdini's and Blender's rules."""

import re
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



def complaint(path):
    """What vdb_print has against a file: it exits with 0 whatever happens."""
    result = subprocess.run(["vdb_print", "-l", path], capture_output=True, text=True)
    lines = (result.stdout + result.stderr).splitlines()
    if not any(line.startswith("Name: ") for line in lines):
        return "no grid"
    return "\n".join(line for line in lines if "vdb_print ERROR" in line or "WARN" in line)


with Bench() as bench:
    view = bench.run("export", "view.vdb", "--as", "viz")
    half = bench.run("export", "half.vdb", "--as", "viz", "--reduce", "2")
    lod = bench.run("export", "lod.vdb", "--as", "lod")
    grids = bench.run("export", "grids.vdb", "--as", "grids")
    surface = bench.run("export", "surface.vdb", "--as", "surface")
    masks = bench.run("export", "masks.vdb", "--as", "grids", "--bool")
    subprocess.run([bench.tool, "generate", "sintered", bench.path("sample.vdb"), "--size", "40",
                    "--count", "4", "-q"], check=True)
    segmented = bench.run("segment", "segmented.vdb", "--keep", "distance,power,manifold,balls",
                          source="sample.vdb")
    subprocess.run([bench.tool, "remerge", segmented, bench.path("again.vdb"), "-q"], check=True)
    converted = bench.run("convert", "converted.vdb", "--range", "1:3")
    for path in (view, half, lod, grids, masks, surface, bench.path("sample.vdb"), segmented,
                 bench.path("again.vdb"), converted):
        check(not complaint(path), f"vdb_print on {path}: {complaint(path)}")
    with open(view, "rb") as whole, open(bench.path("broken.vdb"), "wb") as broken:
        broken.write(whole.read()[:800])
    check(complaint(bench.path("broken.vdb")), "vdb_print has nothing against a broken file")

    try:  # what the manual says of labels
        pyopenvdb.readAllGridMetadata(lod)
        print("pyopenvdb reads Int32 grids here")
    except TypeError as error:
        check("int32" in str(error), f"pyopenvdb on labels: {error}")

    metadata = {grid.name: grid for grid in pyopenvdb.readAllGridMetadata(view)}
    check(sorted(metadata) == ["color", "density"], f"view.vdb holds {sorted(metadata)}")
    for path in (view, half, surface, grids):
        for grid in pyopenvdb.readAllGridMetadata(path):
            wanted = TYPES.get(grid.name, "float")
            check(grid.valueTypeName == wanted, f"{path}: {grid.name} is {grid.valueTypeName}")
            check(re.fullmatch("[A-Za-z_][A-Za-z_0-9]*", grid.name), f"{path}: name {grid.name}")
            check(all(len(key) and " " not in key for key in grid.metadata), f"{path}: metadata")

    density = pyopenvdb.read(view, "density")
    check(density.gridClass == "fog volume", "view.vdb: density is no fog volume")
    check(density.activeVoxelCount() == len(LABELS), "view.vdb: number of voxels")
    color = pyopenvdb.read(view, "color")
    shades = {label: {color.getAccessor().getValue(place) for place in LABELS
                      if LABELS[place] == label} for label in LABELS.values()}
    check(all(len(shade) == 1 and max(max(shade)) > 0 for shade in shades.values()),
          f"view.vdb: colors {shades}")
    check(shades[2] != shades[3], "view.vdb: grains that touch have one color")
    for place in LABELS:
        check(density.getAccessor().getValue(place) == 1, f"view.vdb: density at {place}")
        check(near(density.transform.indexToWorld(place), [EDGE * i for i in place]),
              f"view.vdb: place of {place}")
    coarse = pyopenvdb.read(half, "density")
    check(near(coarse.transform.indexToWorld((0, 0, 0)), [0.5 * EDGE] * 3),
          "half.vdb: half a voxel")
    check(abs(coarse.getAccessor().getValue((1, 1, 2)) - 1 / 8) < 1e-6, "half.vdb: solid fraction")

    names = sorted(grid.name for grid in pyopenvdb.readAllGridMetadata(grids))
    check(names == ["grain_000001", "grain_000002", "grain_000003", "grain_070000"],
          f"grids.vdb holds {names}")
    for label in set(LABELS.values()):
        mask = pyopenvdb.read(masks, f"grain_{label:06d}")
        check(mask.valueTypeName == "bool", f"masks.vdb: {mask.valueTypeName}")
        voxels = [place for place in LABELS if mask.getAccessor().getValue(place)]
        check(voxels == [place for place in LABELS if LABELS[place] == label],
              f"masks.vdb: {label}")
        check(mask.activeVoxelCount() == len(voxels), f"masks.vdb: voxels of {label}")
    for path, name, inside in ((grids, "grain_000001", (2, 3, 5)), (surface, "surface", (7, 1, 2))):
        level_set = pyopenvdb.read(path, name)
        check(level_set.gridClass == "level set", f"{name} is no level set")
        check(level_set.getAccessor().getValue(inside) < 0, f"{name}: sign inside")
        check(level_set.getAccessor().getValue((5, 5, 5)) > 0, f"{name}: sign outside")
print("vdb_print and pyopenvdb read the VDB files")
