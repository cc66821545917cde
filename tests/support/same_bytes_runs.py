# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""What tests/same_bytes runs: command lines of vdb_madf, and edits of files between them.

A command line has to succeed; one that begins with '!' has to fail, and '?' leaves it open. Paths
have an ending with a letter, or hold '_dir' (folders): by that a path is told from other words.
"""
from itertools import product

import same_bytes_labels
import same_bytes_refusals
from hand_made_files import REFUSED
from same_bytes_labels import IMAGES, layout
from same_bytes_refusals import DAMAGED, Edit

TYPES = ("uint8", "int8", "uint16", "int16", "uint32", "int32", "float32", "float64")
VERBS = ("generate", "convert", "segment", "remerge", "edit", "sweep", "measure", "collect",
         "compare", "track", "render", "report", "export", "info")
KINDS = {"spheres": "--count 6 --radius 6:9", "pack": "--radius 4:8", "snow": "--length 12",
         "sintered": "--count 6 --radius 7:9", "particles": "--count 6 --radius 7:9",
         "bed": "--radius 7:9 --rounds 2"}


def mark(name):
    """What is expected of reading a file that was made by hand; HDF5 needs a library."""
    return "!" if name in REFUSED else "?" if name.endswith(("h5", "hdf5")) else ""


def help_texts():
    yield "--help"
    yield "--version"
    for verb in VERBS:
        yield f"{verb} --help"
    for kind in KINDS:
        yield f"generate {kind} --help"


def generate():
    # The samples of all that follows.
    yield "generate snow snow.vdb --size 64 --length 18 --voxel-size 10um"
    yield "generate sintered sintered.vdb --size 64 --count 12 --radius 9:13 --voxel-size 8.5um"
    yield "generate spheres spheres.vdb --size 64 --count 12 --radius 8:12"
    yield "generate pack pack.vdb --dims 96x72x40 --radius 5:10 --fraction 0.3 --voxel-size 1mm"
    yield ("generate snow large.vdb --size 128 --length 24 --fraction 0.35 --seed 3 --voxel-size "
           "20um")
    for kind, ending in product(KINDS, ("vdb", "tiff") + IMAGES):
        yield f"generate {kind} {kind}32.{ending} --size 32 {KINDS[kind]}"
    for kind, options in KINDS.items():
        for number, more in enumerate(("--seed 2", "--threads 1", "--threads 2", "--quiet --seed 5",
                                       "--verbose --seed 18446744073709551615",
                                       "--voxel-size 15nm")):
            yield f"generate {kind} {kind}_{number}.vdb --dims 40x36x33 {options} {more}"
    for number, options in enumerate((
            "spheres --count 9 --radius 7 --overlap 0.2",
            "spheres --count 9 --radius 6:8 --max-cover 0",
            "spheres --count 9 --radius 6:8 --max-cover 1 --overlap 0",
            "pack --fraction 0.5 --radius 3:5", "pack --fraction 0.05 --radius 6",
            "snow --fraction 0.1 --length 9", "snow --fraction 0.9 --length 30",
            "sintered --count 9 --radius 6:8 --neck 0.6 --roughness 0.3",
            "sintered --count 9 --radius 6:8 --neck 0.95 --roughness 1",
            "sintered --count 9 --radius 7 --roughness 0",
            "particles --count 9 --radius 6:8 --shape balls --neck 0.7",
            "particles --count 9 --radius 4:9 --lognormal 0.3 --shape plates",
            "particles --count 9 --radius 6:8 --shape prisms --surface 1:5",
            "spheres --count 9 --radius 6:8 --surface 1.5:4 --scan-noise 0.8:0.1",
            "snow --scan-noise 0:0.3:2", "particles --count 9 --radius 6 --shape polyhedra",
            "bed --radius 5:9 --rounds 0 --surface 1:4")):
        kind, rest = options.split(" ", 1)
        yield f"generate {kind} option{number}.vdb --size 40 {rest}"
    yield "generate snow one.vdb --size 1 --length 4"
    yield "generate pack column.npy --dims 9x9x200 --radius 2:4"
    yield ("generate evolve spheres.vdb evolved --strain 0.1 --turn 10 --rigid-grains --vanish 0.2 "
           "--noise 0.5")


def convert(images, grids):
    for source, target in product(("vdb",) + IMAGES, ("vdb", "tiff") + IMAGES):
        name = f"snow32.{source}"
        yield f"convert {name} from_{source}.{target}{layout(name)}"
    for source, target in product(("vdb",) + IMAGES, ("vdb", "tif", "npy")):
        name = f"sintered32.truth.{source}" if source != "vdb" else "sintered32.vdb"
        yield f"convert {name} labels_from_{source}.{target}{layout(name, kind='int32')}"
    scan = "convert sintered32.truth.tif"
    for number, select in enumerate((
            "--phase 1", "--phase 0", "--phase 3.5", "--threshold 3", "--range 2:4",
            "--range 0:0")):
        for invert in ("", " --invert"):
            yield f"{scan} select{number}{invert.strip(' -')}.vdb {select}{invert}"
            yield (f"convert sintered32.vdb grid{number}{invert.strip(' -')}.vdb --grid truth "
                   f"{select}{invert}")
    yield f"{scan} select.npy --phase 2"
    yield f"{scan} inverted.mha --invert"
    yield "convert snow.vdb inverted.vdb --invert"
    yield "convert snow.vdb inverted_domain.vdb --invert --domain -8,-8,-8:71,79,63"
    yield "convert snow.vdb moved.nrrd --domain -8,-9,-10:70,71,72"
    yield "convert snow.vdb moved.mhd --domain -8,-9,-10:70,71,72"
    yield "convert snow32.vdb truth_grid.vdb --grid object"
    yield "convert sintered.vdb truth_only.vdb --grid truth"
    yield "convert spheres.vdb open.vdb --boundary open"
    yield "convert spheres.vdb closed.vdb --boundary closed"
    yield "convert spheres32.tif closed_mask.vdb --boundary closed --voxel-size 3um"
    for number, size in enumerate(("250nm", "8.5um", "0.1mm", "0.02m", "12nm")):
        yield f"convert snow32.tif size{number}.vdb --voxel-size {size}"
        yield f"convert snow32.tif size{number}.nrrd --voxel-size {size}"
        yield f"convert snow32.tif size{number}.tif --voxel-size {size}"
        yield f"convert snow32.vdb size{number}.mha --voxel-size {size}"
    for kind, ending in product(TYPES, ("npy", "tif", "mha")):
        yield f"convert spheres32.truth.npy {kind}.{ending} --out-type {kind}"
    for kind in TYPES:
        yield f"convert spheres32.vdb {kind}_grid.npy --grid truth --out-type {kind}"
    yield "convert spheres32.truth.npy typed.tif --type uint8"
    yield "convert solid.raw solid.vdb --dims 40x40x40 --type uint8"
    yield "convert solid.raw solid_none.vdb --dims 40x40x40 --type uint8 --invert"
    yield "convert short_big.raw big.npy --dims 11x7x6 --type uint16 --big-endian"
    yield "convert short_big.raw big_mask.vdb --dims 11x7x6 --type uint16 --big-endian --range 1:2"
    yield "convert float.raw quiet.npy --dims 11x7x6 --type float32 --quiet --threads 1"
    yield "convert nan.raw nan.vdb --dims 2x2x1 --type float32 --threshold 0"
    yield "convert huge.raw huge.npy --dims 2x2x1 --type float32 --out-type uint32"
    # The files of all other formats.
    for name in images:
        yield f"{mark(name)} convert {name} copy_of_{name.replace('.', '_')}.mha"
    for name in images:
        if name.endswith((".npy", "_dir", ".zarr")) or name in DAMAGED:
            yield f"{mark(name)} convert {name} mask_of_{name.replace('.', '_')}.vdb --range 1:2"
    yield "? convert two.hdf5 scan.mha --dataset scan"
    yield "? convert two.hdf5 labels.mha --dataset more/labels"
    yield "convert group.zarr a.mha --dataset a"
    yield "convert ome.zarr ome.mha --dataset 0"
    yield "convert ome.zarr/0 inner.mha"
    for name in grids:
        for ending in ("vdb", "npy", "tif"):
            if name != "many.vdb" or ending == "vdb":
                yield f"convert {name} copy_of_{name.replace('.', '_')}.{ending}"
        if name != "many.vdb":
            yield f"convert {name} object_of_{name.replace('.', '_')}.vdb --threshold 0.25"
    for grid in ("int64", "double", "label"):
        yield f"convert many.vdb {grid}.npy --grid {grid}"
        yield f"convert many.vdb {grid}.vdb --grid {grid} --range 0.2:2"
    yield "convert many.vdb inverted_double.vdb --grid double --range 0.2:2 --invert"


def segment():
    for boundary, gamma, merge, adjacency in product(("open", "closed"), (0, 20),
                                                     ("both", "angle", "neck"),
                                                     ("manifold", "cell")):
        yield (f"segment snow.vdb {boundary}_{gamma}_{merge}_{adjacency}.vdb --boundary {boundary} "
               f"--gamma {gamma} --merge {merge} --adjacency {adjacency}")
    for sample, gamma in product(("snow", "sintered", "spheres", "pack"), (0, 20)):
        yield (f"segment {sample}.vdb all_{sample}_{gamma}.vdb --grid object --gamma {gamma}"
               f" --keep distance,power,manifold,balls --tables all_{sample}_{gamma}_dir"
               f" --json all_{sample}_{gamma}.json --boundary closed")
    yield ("segment large.vdb large_labels.vdb --json large.json --tables large_dir --keep "
           "manifold,balls")
    for threads in (1, 2):
        yield (f"segment large.vdb threads{threads}.vdb --threads {threads} --gamma 20 --json "
               f"threads{threads}.json --keep distance,power,manifold,balls --tables "
               f"threads{threads}_dir")
        yield (f"segment sintered.vdb grid_threads{threads}.vdb --grid object --threads {threads} "
               f"--boundary closed")
    for keep in ("distance", "power", "manifold", "balls", "balls,power"):
        yield f"segment snow.vdb keep_{keep.replace(',', '_')}.vdb --keep {keep}"
    for theta in (-1, -0.95, -0.6, 0, 1):
        yield (f"segment snow.vdb theta{theta}.vdb --merge both --theta {theta} "
               f"--json theta{theta}.json")
    for strictness in (-200, 9, 10.5, 14):
        yield f"segment snow.vdb strict{strictness}.vdb --strictness {strictness}"
    yield "segment snow.vdb least_grain.vdb --min-grain 300"
    yield "segment snow.vdb snow.slabs --slab-height 24 --keep manifold --boundary closed"
    yield "convert snow.slabs snow_slabs.npy --grid grain"
    yield "segment snow.vdb paper.vdb --paper --keep manifold --json paper.json"
    yield "segment snow.vdb paper_theta.vdb --paper --theta -0.5 --gamma 160"
    yield "segment snow.vdb quiet.vdb --quiet"
    yield "segment snow.vdb verbose.vdb --verbose --tables verbose_dir"
    yield "segment snow.vdb said.vdb --json -"
    yield "segment snow.vdb said_again.vdb --json /dev/stdout"
    yield "segment snow.vdb memory.vdb --max-memory 1.5GiB"
    yield "segment snow.vdb --dry-run --max-memory 2G --json dry.json"
    yield "segment snow.vdb --dry-run"
    yield "segment snow.vdb --dry-run --max-memory 500K --json -"
    yield "segment snow32.vdb dry_out.vdb --dry-run --max-memory 3TiB --gamma 20 --keep balls"
    yield "segment snow.vdb selected.vdb --threshold 1 --voxel-size 1um"
    yield "segment snow.vdb pores.vdb --invert --json pores.json"
    yield "segment snow.vdb domain.vdb --domain -8,-8,-8:71,72,73 --tables domain_dir"
    for number, select in enumerate(("--phase 2", "--threshold 4", "--range 2:4",
                                     "--range 1:3 --invert", "")):
        for ending in ("tif", "raw"):
            name = f"sintered32.truth.{ending}"
            yield (f"segment {name} image{number}_{ending}.vdb{layout(name, kind='int32')} "
                   f"{select} --voxel-size 8.5um")
    yield "segment png_dir picture_dir_labels.vdb --threshold 100 --json picture.json"
    yield ("segment solid.vdb solid_labels.vdb --boundary closed --keep "
           "distance,power,manifold,balls")
    yield "segment object.vdb tile_labels.vdb --boundary closed --keep distance,manifold,balls"
    yield "segment inverted.vdb pores_labels.vdb --keep manifold"
    yield "segment fog.vdb fog_labels.vdb --threshold 0.2"
    yield "segment level_set.vdb level_set_labels.vdb"
    yield "segment tiles.vdb again.vdb --range 1:3"
    yield "segment all_snow_0.vdb of_labels.vdb --grid grain --keep manifold"
    yield "segment all_snow_0.vdb of_distance.vdb --grid distance_squared --threshold 9"
    yield "segment solid_none.vdb none.vdb --keep manifold,balls --tables none_dir --json none.json"
    yield "segment one.vdb one_labels.vdb --boundary closed --tables one_dir"


def info(images, grids):
    for name in images:
        if not name.endswith((".npy", ".tif")):
            yield f"{'?' if name in REFUSED else mark(name)} info {name}"
    for name in grids:
        yield f"info {name}"
    yield "info imagej.tif"
    yield "info i8_big.npy"
    for name in ("snow", "sintered", "inverted", "solid", "all_snow_20", "threads1",
                 "remerged_cell", "viz1", "lod1", "surface0", "grids0", "bool_grids", "none",
                 "size0", "size4"):
        yield f"info {name}.vdb"
        yield f"info {name}.vdb --json info_{name}.json"
    yield "info all_snow_0.vdb --json -"
    yield "info all_snow_0.vdb --quiet --json info_quiet.json"
    for ending in ("tif", "mhd", "mha", "nrrd", "npy", "raw"):
        name = f"snow32.{ending}"
        yield f"info {name} --json info_{ending}.json{layout(name)}"
    yield "? info two.hdf5 --dataset scan"
    yield "info moved.nrrd"


def crop(size, begin, edge):
    """A cube of a RAW file of bytes."""
    def change(data):
        nx, ny, _ = size
        return b"".join(data[(z * ny + y) * nx + begin:][:edge] for z in range(begin, begin + edge)
                        for y in range(begin, begin + edge))
    return change


def scan():
    """A real scan, nmc.tif, whole and cropped."""
    yield "info nmc.tif"
    yield "convert nmc.tif nmc.raw"
    yield "convert nmc.tif nmc.vdb --phase 1 --voxel-size 0.4um"
    yield "segment nmc.vdb nmc_labels.vdb --gamma 160 --json nmc.json"
    yield "segment nmc.tif nmc_paper.vdb --phase 1 --paper --threads 1"
    yield "measure nmc_labels.vdb nmc_dir"
    yield "render nmc_labels.vdb nmc.png"
    yield Edit("nmc.raw", "nmc_crop.raw", crop((301, 301, 251), 60, 128))
    yield ("segment nmc_crop.raw nmc_crop.vdb --dims 128x128x128 --type uint8 --phase 1 "
           "--voxel-size 0.4um --keep distance,power,manifold,balls --tables nmc_crop_dir "
           "--boundary closed --json nmc_crop.json")
    yield "remerge nmc_crop.vdb nmc_merged.vdb --merge both --theta -0.5"
    yield ("sweep nmc_crop.raw nmc_sweep.csv --dims 128x128x128 --type uint8 --phase 1 --gamma "
           "0,160 --plot nmc_sweep.svg")
    yield "compare nmc_crop.vdb nmc_merged.vdb --json nmc_compared.json"
    for options in ("nmc.ply", "nmc.vtp --as mesh", "nmc_view.vdb --as viz",
                    "nmc_surface.vdb --as surface", "nmc.graphml",
                    "nmc_clumps.txt --as clumps --balls 20", "nmc.vti --compress"):
        yield f"export nmc_crop.vdb {options}"


def all_runs(images, grids, with_scan):
    """`images` and `grids`: the names of the files that hand_made_files writes."""
    yield from help_texts()
    yield from generate()
    yield from convert(images, grids)
    yield from segment()
    yield from same_bytes_labels.all_runs()
    yield from info(images, grids)
    yield from same_bytes_refusals.all_runs()
    if with_scan:
        yield from scan()
