# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""The part of the list of tests/same_bytes that is refused: see same_bytes_runs.py."""

# One file, or few, of each reader.
DAMAGED = ("u1.npy", "i8_little.npy", "raw.nrrd", "big.nrrd", "gzip.nrrd", "beside.nhdr",
           "local.mha", "zlib.mha", "beside.mhd", "plain.isq", "blocks.isq", "plain.nii",
           "scaled.nii", "packed.nii.gz", "version2.vol", "version3.vol", "version3.longvol",
           "pyhst_float.vol", "pyhst_byte.vol", "hdf5.h5", "imagej.tif", "deflate.tif", "lzw.tif",
           "packbits.tif", "bigtiff.tif", "tiled.tif", "bits.tif", "png_dir/slice8.png",
           "png16_dir/slice9.png", "bmp_dir/slice8.bmp", "bmp24_dir/slice9.bmp")


class Edit:
    """Writes `target`, made of the bytes of `source`."""

    def __init__(self, source, target, change):
        self.source, self.target, self.change = source, target, change


def wrong_command_lines():
    for line in ("", "-q", "frobnicate", "''", "--frobnicate", "generate", "generate cubes x.vdb",
                 "info", "info ''"):
        yield f"! {line}"
    tail = {
        "segment": (
            "", "in.vdb", "in.vdb o.vdb more", "in.vdb o.vdb --frobnicate", "in.vdb o.tif",
            "in.vdb in.vdb", "in.vdb o.vdb --json in.vdb", "in.vdb o.vdb --json o.vdb",
            "in.vdb o.vdb --tables t_dir --json t_dir/bonds.csv",
            "in.vdb o.vdb --merge both --theta nan",
            "in.vdb o.vdb --merge both --theta -1.001",
            "in.vdb o.vdb --merge neck --theta 1.001", "in.vdb o.vdb --theta",
            "in.vdb o.vdb --theta 0", "in.vdb o.vdb --merge both --strictness 3",
            "in.vdb o.vdb --gamma -1",
            "in.vdb o.vdb --gamma 0.5", "in.vdb o.vdb --gamma 99999999999999999999",
            "in.vdb o.vdb --paper --merge both", "in.vdb o.vdb --paper --adjacency cell",
            "in.vdb o.vdb --merge most", "in.vdb o.vdb --adjacency near",
            "in.vdb o.vdb --boundary wide", "in.vdb o.vdb --keep distance,all",
            "in.vdb o.vdb --threads 0", "in.vdb o.vdb --threads 1.5",
            "in.vdb o.vdb --voxel-size 8.5", "in.vdb o.vdb --voxel-size um",
            "in.vdb o.vdb --voxel-size 0um", "in.vdb o.vdb --voxel-size 2m",
            "in.vdb o.vdb --voxel-size nanum", "in.vdb o.vdb --domain 0,0,0",
            "in.vdb o.vdb --domain 5,5,5:4,9,9", "in.vdb o.vdb --domain 0,0,0:99999999,1,1",
            "in.vdb o.vdb --phase 1 --threshold 2", "in.vdb o.vdb --phase nan",
            "in.vdb o.vdb --range 3:1", "in.vdb o.vdb --range 3", "in.vdb o.vdb --threshold one",
            "in.raw o.vdb --dims 4x4", "in.raw o.vdb --dims 4x4x0 --type uint8",
            "in.raw o.vdb --dims 4x4x4", "in.raw o.vdb --type uint8",
            "in.raw o.vdb --dims 4x4x4 --type uint9", "in.raw o.vdb --big-endian",
            "in.vdb o.vdb --max-memory 3X", "in.vdb o.vdb --max-memory 0", "snow.vdb"),
        "convert": ("in.tif out.jpg", "in.tif in.tif", "in.raw in.mhd --dims 4x4x4 --type uint8",
                    "in.tif o.raw --out-type text", "in.tif o.vdb --out-type int32",
                    "in.tif o.vdb --boundary wide", "in.tif o.vdb --type uint8", "in.tif",
                    "snow.vdb ./snow.vdb"),
        "remerge": ("in.vdb o.tif", "in.vdb in.vdb", "in.vdb o.vdb --merge both --theta 2",
                    "in.vdb o.vdb --gamma 2", "in.vdb"),
        "edit": ("in.vdb o.vdb", "in.vdb in.vdb --renumber", "in.vdb o.vdb --merge 12",
                 "in.vdb o.vdb --drop 1,1", "in.vdb o.jpg --renumber"),
        "sweep": ("in.vdb o.txt", "in.vdb o.csv --plot o.csv",
                  "in.vdb o.csv --merge both --theta -1:0",
                  "in.vdb o.csv --strictness 9:11:0", "in.vdb o.csv --strictness 11:9:0.1",
                  "in.vdb o.csv --theta -0.5", "in.vdb o.csv --strictness 9,9",
                  "in.vdb o.csv --gamma 0,x", "in.vdb o.csv --gamma 3,3",
                  "in.vdb o.csv --merge cell", "in.vdb o.csv --small 0.5",
                  "in.vdb o.csv --plot o.png", "in.vdb o.csv --strictness ,",
                  "in.vdb o.csv --gamma ,"),
        "measure": ("in.vdb", "in.vdb o_dir --density 0", "in.vdb o_dir --density ice",
                    "in.vdb o_dir --boundary wide", "o_dir/grains.csv o_dir"),
        "collect": ("o_dir", "o_dir o.txt", "o.csv"),
        "compare": ("in.vdb", "in.vdb other.vdb --json other.vdb",
                    "in.vdb other.vdb --grains in.vdb",
                    "in.vdb other.vdb --json a.x --confusion a.x"),
        "track": ("in.vdb", "in.vdb other.vdb other.vdb", "in.vdb other.vdb --shift 1,2",
                  "in.vdb other.vdb --share 0"),
        "render": ("in.vdb o.jpg", "in.vdb o.png --only all", "in.vdb o.png --size 0",
                   "in.vdb o.png --elevation 100", "in.vdb o.png --azimuth nan",
                   "in.vdb o.png --elevation nan", "in.vdb"),
        "report": ("in.vdb", "o.html", "in.vdb o.htm --triangles 0", "in.vdb o.html --max-dim 8"),
        "export": ("in.vdb o.vdb", "in.vdb o.xyz", "in.vdb o.ply --as cubes",
                   "in.vdb o.ply --as viz", "in.vdb o.vdb --as mesh", "in.vdb o.vdb --as clumps",
                   "in.vdb o.vdb --as hexa", "in.vdb o.vdb --as vti", "in.vdb o.vdb --as mask",
                   "in.vdb o.vdb --as network", "in.vdb o.ply --smooth -1",
                   "in.vdb o.ply --reduce 0", "in.vdb o.ply --reduce 2 --max-dim 9",
                   "in.vdb o.ply --triangles 0", "in.vdb o.ply --select 0",
                   "in.vdb o.csv --as clumps --balls 0", "in.vdb o.csv --as clumps --uncovered 1.5",
                   "in.vdb in.ply --as", "in.vdb o.ply --bonds b.csv",
                   "in.ply in.ply"),
        "info": ("in.vdb --json in.vdb", "in.vdb more"),
        "generate": ("snow o.jpg", "snow o.vdb --size 0", "snow o.vdb --size 16 --dims 16x16x16",
                     "snow o.vdb --size 16 --seed -1", "snow o.vdb --size 16 --length nan",
                     "snow o.vdb --size 16 --fraction 1", "pack o.vdb --size 16 --fraction nan",
                     "pack o.vdb --size 16 --radius 9:6", "pack o.vdb --dims 4x4",
                     "spheres o.vdb --size 24 --count 0",
                     "spheres o.vdb --size 24 --count 1000 --radius 4",
                     "sintered o.vdb --size 24 --neck -1", "snow", "snow o.vdb --radius 3")}
    for verb, lines in tail.items():
        for line in lines:
            yield f"! {verb} {line}"


def wrong_files():
    names = ["missing.vdb", "missing.tif", "missing.xyz", "empty_dir"]
    for ending in ("vdb", "tif", "mhd", "mha", "nrrd", "npy", "png", "bmp", "isq", "nii", "nii.gz",
                   "vol", "longvol", "info", "h5", "raw", "xyz"):
        names += [f"empty.{ending}", f"garbage.{ending}"]
    for name in names:
        yield f"! info {name}"
        yield f"! convert {name} never.npy"
    for name in ("missing.vdb", "garbage.vdb", "garbage.tif", "empty.mha", "mixed_dir"):
        for rest in ("segment {} never.vdb", "sweep {} never.csv", "measure {} never_dir",
                     "render {} never.png", "export {} never.ply", "remerge {} never.vdb",
                     "compare {} snow.vdb", "compare sintered.vdb {}"):
            yield "! " + rest.format(name)
    for size in ("11x7x5 --type uint8", "11x7x7 --type uint8", "11x7x6 --type uint16"):
        yield f"! segment small.raw never.vdb --dims {size}"
    yield "! convert two.hdf5 never.mha --dataset missing"
    yield "! convert group.zarr never.mha --dataset c"
    yield "! convert ome.zarr never.mha --dataset 1"
    yield "! segment snow32.tif never.vdb --dataset object"
    yield "! segment snow.vdb never.vdb --dataset object"


def wrong_content():
    """Files that are sound, but not what the verb needs."""
    for line in ("segment sintered.vdb never.vdb --grid snow",
                 "render sintered.vdb never.png --grid snow",
                 "render sintered.vdb never.png --grid object", "render snow.vdb never.png",
                 "measure snow.vdb never_dir", "export snow.vdb never.ply",
                 "segment all_snow_0.vdb never.vdb", "convert many.vdb never.npy",
                 "convert many.vdb never.npy --grid vector",
                 "compare sintered.vdb all_snow_0.vdb --truth-grid snow",
                 "remerge sintered.vdb never.vdb", "segment snow32.tif never.vdb --grid truth",
                 "measure sintered32.truth.tif never_dir --grid truth",
                 "segment snow.vdb never.vdb --domain 0,0,0:9,9,9",
                 "segment snow32.tif never.vdb --threshold 0",
                 "segment object.vdb never.vdb --boundary open",
                 "segment object.vdb never.vdb --invert",
                 "segment snow.vdb never.vdb --invert --domain 0,0,0:1048575,1048575,1048575",
                 "convert snow32.tif never.raw --domain 0,0,0:9,9,9",
                 "convert snow32.tif never.raw --boundary open",
                 "convert solid_none.vdb none.npy --domain 0,0,0:-1,0,0",
                 "segment snow.vdb never.vdb --max-memory 500K",
                 "compare all_snow_0.vdb all_pack_0.vdb",
                 "export all_snow_0.vdb never.ply --select 1000000",
                 "convert beside.mhd beside.dat.raw/o.raw",
                 "convert float.raw never.tif --dims 11x7x6 --type float32 --out-type int32",
                 "convert i4_little.npy never.tif --out-type uint8",
                 "convert f8_little.npy never.mha --out-type float32"):
        yield f"{'?' if 'out-type' in line else '!'} {line}"
    floats = " --dims 2x2x1 --type float32"
    for name in ("half.raw", "nan.raw", "huge.raw"):
        yield f"! render {name} never.png{floats}"
        yield f"! measure {name} never_dir{floats}"
        yield f"! convert {name} never.tif --out-type int32{floats}"
    yield f"! compare left.raw right.raw{floats}"
    # Where nothing can be written.
    for line in ("segment snow.vdb {}.vdb", "convert snow.vdb {}.vdb",
                 "remerge all_snow_0.vdb {}.vdb", "render all_snow_0.vdb {}.png",
                 "export all_snow_0.vdb {}.ply", "sweep snow.vdb {}.csv",
                 "measure all_snow_0.vdb {}_dir", "generate snow {}.vdb --size 16",
                 "convert snow.vdb {}.raw", "segment snow.vdb never.vdb --json {}.json",
                 "segment snow.vdb never.vdb --tables {}_dir",
                 "export all_snow_0.vdb {}_dir --as mesh"):
        yield "! " + line.format("missing_dir/never")
        yield "! " + line.format("snow.vdb/never")
    yield "convert snow32.mhd mhd_copy.mhd"
    yield "! convert mhd_copy.mhd mhd_copy.raw --out-type int32"
    yield "! convert tiff_dir tiff_dir/slice9.tif"
    for line in ("--help", "segment --help", "--version", "info snow.vdb",
                 "compare all_snow_0.vdb all_snow_20.vdb", "segment snow.vdb full.vdb",
                 "render all_snow_0.vdb full.png", "info snow.vdb --json /dev/full"):
        yield f"! {line} > /dev/full"


def cut(share):
    return lambda data: data[:int(share * len(data))]


def flipped(place):
    """One bit less or more, at a place that is a share of the file or a number of bytes."""
    def change(data):
        at = int(place * len(data)) if isinstance(place, float) else min(place, len(data) - 1)
        return data[:at] + bytes([data[at] ^ 0x10]) + data[at + 1:]
    return change


def damaged_files():
    damages = {"cut1": cut(0.02), "cut2": cut(0.5), "cut3": cut(0.99),
               "long": lambda data: data + b"more"}
    heads = {f"bit{place}": flipped(place) for place in (5, 17, 42, 77, 130)}
    for name in DAMAGED:
        for what, change in {**damages, **heads}.items():
            target = f"{what}_{name.replace('_dir/', '_')}"
            yield Edit(name, target, change)
            if name.startswith("pyhst"):
                yield Edit(f"{name}.info", f"{target}.info", bytes)
            yield f"? convert {target} {target.replace('.', '_')}_copy.mha"
    for name in (".zarray", "0.0.0"):
        for what, change in {**damages, **heads}.items():
            folder = f"{what}_{name.strip('.')}.zarr"
            for file in (".zarray", "0.0.0", "0.0.1", "0.0.2", "0.1.0", "0.1.1", "0.1.2", "0.2.0",
                         "0.2.1", "0.2.2"):
                yield Edit(f"plain.zarr/{file}", f"{folder}/{file}",
                           change if file == name else bytes)
            yield f"? convert {folder} {folder.replace('.', '_')}_copy.mha"
    shares = [round(0.001 + 0.083 * i, 3) for i in range(12)]
    for name in ("snow32.vdb", "tiles.vdb", "keep_balls_power.vdb"):
        changes = {**damages, **{f"byte{share}": flipped(share) for share in shares},
                   **{f"bit{place}": flipped(place) for place in range(3, 400, 29)}}
        for what, change in changes.items():
            target = f"{what}_{name}"
            yield Edit(name, target, change)
            yield f"? info {target}"
    for place in range(0, 60, 4):
        target = f"graph{place}.vdb"
        yield Edit("keep_manifold.vdb", target, lambda data, place=place: flipped(
            data.rindex(b"madf_manifold_graph") + 19 + place)(data))
        yield f"? remerge {target} graph{place}_merged.vdb"


def all_runs():
    yield from wrong_command_lines()
    yield from wrong_files()
    yield from wrong_content()
    yield from damaged_files()
