# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""The part of the list of tests/same_bytes that works on labels: see same_bytes_runs.py."""
from itertools import product

# an .mhd would not replace the .raw of another
IMAGES = ("tif", "mhd", "raw", "mha", "nrrd", "npy")


def layout(name, size="32x32x32", kind="uint8"):
    """A RAW file has to be described."""
    return f" --dims {size} --type {kind}" if name.endswith(".raw") else ""


def remerge():
    for merge, theta in product(("both", "angle", "neck"), (-1, -0.8, -0.3)):
        yield f"remerge all_snow_0.vdb remerged_{merge}{theta}.vdb --merge {merge} --theta {theta}"
    yield "remerge all_snow_20.vdb remerged_cell.vdb --merge angle --adjacency cell"
    yield "remerge threads1.vdb remerged_large.vdb --merge both --theta -0.7 --threads 1"
    yield "remerge snow.slabs remerged.slabs --merge both --theta -0.8"
    yield "remerge keep_manifold.vdb remerged_quiet.vdb --quiet"
    yield "remerge solid_labels.vdb remerged_solid.vdb"
    yield "remerge none.vdb remerged_none.vdb"


def edit():
    yield ("edit keep_manifold.vdb edited.vdb --merge 1,2 --split 1 --min-voxels 20 "
           "--drop-at-faces --json edited.json")
    yield "edit edited.vdb renumbered.tif --renumber --max-voxels 5000"
    yield "edit keep_manifold.vdb joined.vdb --join-below 300"
    yield "edit sintered32.truth.tif edited_image.vdb --renumber --drop 1 --quiet"


def sweep():
    yield "sweep snow.vdb sweep.csv --plot sweep.svg"
    yield ("sweep snow.vdb sweep_gamma.csv --gamma 0,5 --theta -1:-0.5:0.25,-0.1 --merge angle "
           "--plot sweep_gamma.svg")
    yield ("sweep sintered.vdb sweep_cell.csv --grid object --merge both --adjacency cell "
           "--boundary closed --small 1000 --gamma 20")
    yield ("sweep spheres32.tif sweep_image.csv --phase 1 --gamma 0 --boundary open --merge both "
           "--theta -0.9 --plot -")
    yield ("sweep snow.vdb sweep_invert.csv --invert --gamma 0,20 --merge neck,both --quiet --plot "
           "sweep_invert.svg")
    yield ("sweep sintered32.truth.raw sweep_raw.csv --dims 32x32x32 --type int32 --range 2:4 "
           "--threads 1 --gamma 0")
    yield "sweep snow.vdb sweep_domain.csv --domain -8,-8,-8:71,72,73 --gamma 160"
    yield "sweep solid_none.vdb sweep_none.csv --plot sweep_none.svg"


def measure():
    for sample in ("snow", "sintered", "spheres", "pack"):
        yield f"measure all_{sample}_0.vdb measured_{sample}_dir"
    for boundary in ("auto", "open", "closed"):
        yield f"measure open_0_both_manifold.vdb measured_{boundary}_dir --boundary {boundary}"
    yield "measure all_snow_20.vdb measured_options_dir --voxel-size 12nm --density 900 --threads 1"
    yield "measure all_snow_20.vdb measured_options_dir --voxel-size 8.5um --threads 2 --verbose"
    yield "measure all_snow_20.vdb measured_grid_dir --grid grain --domain -8,-8,-8:71,72,73"
    yield "measure large_labels.vdb measured_large_dir --quiet"
    yield "measure sintered.vdb measured_truth_dir"
    for ending in IMAGES:
        name = f"sintered32.truth.{ending}"
        yield f"measure {name} measured_{ending}_dir{layout(name, kind='int32')} --voxel-size 1um"
    for name in ("tiles", "plain", "solid_labels", "none", "one_labels", "large_tile", "theta1"):
        yield f"measure {name}.vdb measured_{name}_dir"
    yield "! measure i8_little.npy measured_noise_dir"


def collect():
    yield "collect measured_snow_dir measured_pack_dir all_sintered_20_dir collected.csv"
    yield ("collect measured_spheres_dir measured_tiles_dir measured_none_dir collected_voxels.csv "
           "--quiet")
    yield "collect measured_snow_dir png_dir measured_snow_dir collected_one.csv"
    yield "collect measured_snow_dir -"
    yield "! collect measured_snow_dir measured_spheres_dir mixed.csv"
    yield "! collect png_dir never.csv"


def compare():
    truth = "compare sintered.vdb all_sintered_0.vdb"
    yield truth
    yield f"{truth} --json compared.json --grains compared.csv --confusion confusion.csv"
    yield f"{truth} --json -"
    yield f"{truth} --grains -"
    yield f"{truth} --confusion - --quiet"
    yield f"{truth} --truth-grid truth --test-grid grain --threads 1"
    yield f"{truth} --test-grid distance_squared"
    yield "compare spheres.vdb all_spheres_20.vdb --json spheres.json"
    yield "compare all_snow_0.vdb all_snow_20.vdb --grains snow.csv"
    yield "compare all_snow_0.vdb all_snow_0.vdb"
    yield "compare sintered32.truth.tif sintered32.truth.raw --dims 32x32x32 --type int32"
    yield "compare large_labels.vdb threads1.vdb --json large_compared.json --verbose"
    yield "compare labels.vdb tiles.vdb --confusion tiles.csv"
    yield "compare open_0_both_manifold.vdb domain.vdb"


def track():
    yield ("track all_snow_0.vdb all_snow_20.vdb tracked.vdb --grains tracked.csv --links "
           "links.csv --bonds linked.csv --json tracked.json")
    yield "track keep_manifold.vdb edited.vdb tracked.tif --shift 1,0,-1 --share 0.3 --min-faces 4"
    yield "track keep_manifold.vdb edited.vdb scene.zarr"


def report():
    for sample in ("snow", "sintered", "spheres", "pack"):
        yield f"report all_{sample}_0.vdb {sample}.html"
    yield "report all_snow_0.vdb flat.html --no-3d --max-dim 16 --ice --title '<Snow>'"
    yield "report all_snow_0.vdb all_pack_0.vdb both.html --threads 2"


def render():
    for sample in ("snow", "sintered", "spheres", "pack"):
        yield f"render all_{sample}_0.vdb {sample}.png"
    yield "render large_labels.vdb large.png"
    for size in (16, 50, 64, 200, 700):
        yield f"render all_snow_20.vdb size{size}.png --size {size}"
    for only in ("slices", "view"):
        yield f"render all_snow_0.vdb {only}.png --only {only}"
        yield f"render sintered32.truth.tif {only}_image.png --only {only} --size 90 --quiet"
    for number, (azimuth, elevation) in enumerate(((0, 0), (90, 90), (-135, -30), (33.3, 12.5),
                                                   (360, -90))):
        yield (f"render all_pack_0.vdb view{number}.png --only view --size 150 --azimuth {azimuth} "
               f"--elevation {elevation}")
    yield "render sintered.vdb truth.png --grid truth --threads 1"
    yield "render sintered.vdb truth_threads.png --grid truth --threads 2"
    yield "render spheres32.truth.raw raw.png --dims 32x32x32 --type int32"
    for name in ("tiles", "plain", "solid_labels", "large_tile", "none", "one_labels", "size5"):
        yield (f"{'?' if name in ('none', 'size5') else ''} render {name}.vdb of_{name}.png --size "
               f"100")


def export():
    yield "export sintered.vdb truth_clumps.csv --as clumps"
    yield "export sintered32.truth.tif image_clumps.csv --as clumps"
    labels = "export all_snow_0.vdb"
    for ending in ("ply", "obj", "stl", "vtp", "glb"):
        for number, options in enumerate(("", "--smooth 0", "--smooth 3 --reduce 2", "--max-dim 20",
                                          "--triangles 4000", "--voxel-size 3um --threads 1")):
            yield f"{labels} mesh{number}.{ending} --as mesh {options}"
        yield f"export all_pack_20.vdb pack.{ending} --as mesh"
        yield f"export tiles.vdb tiles.{ending} --as mesh"
        yield f"export large_labels.vdb large.{ending} --as mesh --threads 2"
    yield f"{labels} mesh.ply"
    yield f"{labels} stl_dir --as mesh"
    yield f"{labels} stl_exact_dir --as mesh --smooth 0 --reduce 2"
    for kind in ("viz", "lod"):
        for number, options in enumerate(("", "--reduce 2", "--reduce 3 --threads 1",
                                          "--max-dim 30", "--max-dim 500")):
            yield f"{labels} {kind}{number}.vdb --as {kind} {options}"
        yield f"export large_labels.vdb {kind}_large.vdb --as {kind} --max-dim 64"
        yield f"export tiles.vdb {kind}_tiles.vdb --as {kind} --reduce 2"
    for number, options in enumerate(("", "--smooth 0", "--smooth 3 --voxel-size 1um",
                                      "--threads 1")):
        yield f"export sintered32.vdb grids{number}.vdb --as grids {options}"
        yield f"export sintered32.vdb surface{number}.vdb --as surface {options}"
    yield "export all_sintered_0.vdb grids.vdb --as grids"
    yield "export all_sintered_0.vdb surface.vdb --as surface"
    yield "export all_sintered_0.vdb bool_grids.vdb --as grids --bool"
    yield f"{labels} cells.vti"
    yield f"{labels} cells.dat --as palabos"
    yield f"{labels} compressed.vti --compress --threads 1"
    yield f"{labels} named.vti --as vti"
    yield f"{labels} cells.ome.zarr"
    yield f"{labels} cells5.zarr --ome 0.5 --threads 1"
    yield f"{labels} network.graphml"
    for ending in ("vtp", "graphml", "csv"):
        yield f"{labels} network.{ending} --as network --voxel-size 2mm"
        yield f"export all_pack_20.vdb pack_network.{ending} --as network"
        yield f"export one_labels.vdb one_network.{ending} --as network"
    for ending in ("csv", "txt", "data"):
        for number, options in enumerate(("", "--balls 5", "--uncovered 0.2",
                                          "--uncovered 0 --balls 1000")):
            yield f"{labels} clumps{number}.{ending} --as clumps {options}"
        yield f"export threads1.vdb clumps_open.{ending} --as clumps --balls 20"
        yield f"export solid_labels.vdb clumps_solid.{ending} --as clumps"
        yield (f"{labels} clumps_apart.{ending} --as clumps --apart --bonds bonds_{ending}.csv "
               f"--cover cover_{ending}.csv")
    for ending in ("vtu", "inp"):
        yield f"{labels} hexa.{ending}"
        yield f"{labels} hexa_named.{ending} --as hexa --voxel-size 1um"
        yield f"export tiles.vdb hexa_tiles.{ending} --grid grain"
    for ending in ("raw", "mhd", "mha", "tif", "nrrd", "npy", "h5"):
        yield f"{labels} mask_{ending}.{ending} --as mask"
        yield f"export tiles.vdb mask_tiles_{ending}.{ending} --as mask"
    for ending in IMAGES:
        name = f"sintered32.truth.{ending}"
        yield f"export {name} of_{ending}.ply{layout(name, kind='int32')} --voxel-size 1um"
    for number, (name, options) in enumerate(product(("none", "solid_labels", "one_labels"), (
            "surface.vdb --as surface", "mesh.ply", "viz.vdb --as viz", "lod.vdb --as lod",
            "grids.vdb --as grids", "cells.vti", "network.vtp --as network", "hexa.vtu",
            "mask.raw --as mask"))):
        yield f"? export {name}.vdb {name}_{options}"
    yield "convert surface0.vdb of_surface.vdb"
    yield "convert surface0.vdb of_surface.npy"
    yield "segment surface0.vdb of_surface_labels.vdb"
    yield "convert viz1.vdb of_viz.npy --grid density"
    yield "segment viz1.vdb of_viz_labels.vdb --grid density --threshold 0.5"
    yield "measure lod0.vdb of_lod_dir"


def all_runs():
    yield from remerge()
    yield from edit()
    yield from sweep()
    yield from measure()
    yield from collect()
    yield from compare()
    yield from track()
    yield from render()
    yield from report()
    yield from export()
