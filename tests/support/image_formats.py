# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""Writes one volume in formats of other programs, or reads what we wrote, with those programs' own
modules.

    image_formats.py write FOLDER   volume.raw (int16, x fastest) and labels.raw (int64), and the
    same
                                    as other files; prints a line each: "file TRUTH NAME METRES
                                    [DATASET]", METRES 0 where the format knows none; or "skipped
                                    MODULE"
    image_formats.py check FOLDER   compares ours.npy, ours.tif, ours.nrrd, ours.h5 with labels.raw;
    prints "same NAME"

The axes of the arrays are [z, y, x], all of other length; no two voxels of the volume are equal.
"""
import importlib
import os
import sys

SHAPE = (6, 7, 11)
UM = 8.5


def module(name):
    try:
        return importlib.import_module(name)
    except ImportError:
        print("skipped", name)
        return None


def write_numpy(np, folder, volume, labels):
    np.save(f"{folder}/volume.npy", volume)
    print("file volume.raw volume.npy 0")
    np.save(f"{folder}/labels.npy", labels)
    print("file labels.raw labels.npy 0")


def write_nifti(nib, folder, volume, labels):
    for name in ("volume.nii", "volume.nii.gz"):
        image = nib.Nifti1Image(volume.transpose(2, 1, 0),
                                [[UM / 1e3, 0, 0, 0], [0, UM / 1e3, 0, 0],
                                                           [0, 0, UM / 1e3, 0], [0, 0, 0, 1]])
        image.header.set_xyzt_units("mm")
        nib.save(image, f"{folder}/{name}")
        print("file volume.raw", name, UM / 1e6)


def write_zarr(zarr, folder, volume, labels):
    """Zarr 2 by its module, whose version 3 has other calls for it."""
    import numcodecs
    new = int(zarr.__version__.split(".")[0]) >= 3

    def save(name, array, chunks, separator=".", **more):
        if not new:
            store = zarr.DirectoryStore(f"{folder}/{name}", dimension_separator=separator)
            zarr.create(array.shape, chunks=chunks, dtype=array.dtype, store=store, overwrite=True,
                        **more)[:] = array
            return
        if "compressor" in more:
            more["compressors"] = more.pop("compressor")
        config = {"write_empty_chunks": more.pop("write_empty_chunks", True)}
        zarr.create_array(f"{folder}/{name}", shape=array.shape, chunks=chunks, dtype=array.dtype,
                          zarr_format=2, chunk_key_encoding={"name": "v2", "separator": separator},
                          config=config, overwrite=True, **more)[:] = array

    for name, compressor in (("blosc", numcodecs.Blosc(cname="zstd", shuffle=2)),
                             ("zlib", numcodecs.Zlib()), ("gzip", numcodecs.GZip()),
                             ("zstd", numcodecs.Zstd()), ("none", None)):
        save(f"{name}.zarr", volume, (4, 3, 5), compressor=compressor)
        print(f"file volume.raw {name}.zarr 0")
    group = zarr.open_group(f"{folder}/image.ome.zarr", mode="w",
                            **({"zarr_format": 2} if new else {}))
    save("image.ome.zarr/0", labels[None, None], (1, 1, 4, 3, 5), "/", fill_value=0,
         write_empty_chunks=False)
    save("image.ome.zarr/1", volume[None, None], (1, 1, 2, 8, 8), "/", order="F")
    scale = [{"type": "scale", "scale": [1, 1, UM, UM, UM]}]
    group.attrs["multiscales"] = [{
        "version": "0.4",
        "axes": [{"name": "t", "type": "time"}, {"name": "c", "type": "channel"}] +
                [{"name": a, "type": "space", "unit": "micrometer"} for a in "zyx"],
        "datasets": [{"path": p, "coordinateTransformations": scale} for p in "01"]}]
    print("file labels.raw image.ome.zarr", UM / 1e6)
    print("file volume.raw image.ome.zarr", UM / 1e6, "1")


def crc32c(data):
    total = 0xffffffff
    for byte in data:
        total ^= byte
        for _ in range(8):
            total = total >> 1 ^ (0x82f63b78 if total & 1 else 0)
    return (total ^ 0xffffffff).to_bytes(4, "little")


def write_zarr3(numcodecs, folder, volume, labels):
    """Zarr 3 by its definition: the module for zarr of Debian 12 has no such version. Each codec,
    then shards of 2 x 2 x 2 chunks, whose last ones are left out."""
    import itertools
    import json
    import numpy
    chunk = (4, 3, 5)
    codecs = {
        "none": ([], lambda b: b),
        "gzip": ([{"name": "gzip", "configuration": {"level": 5}}], numcodecs.GZip(5).encode),
        "zstd": ([{"name": "zstd", "configuration": {"level": 3, "checksum": False}},
                  {"name": "crc32c"}], lambda b: (lambda e: e
                                                  + crc32c(e))(bytes(numcodecs.Zstd(3).encode(b)))),
        "blosc": ([{"name": "blosc", "configuration": {"cname": "zstd", "clevel": 5, "typesize": 2,
                                                       "shuffle": "bitshuffle", "blocksize": 0}}],
                  numcodecs.Blosc("zstd", 5, 2).encode)}

    def chunk_at(number, encode):
        block = numpy.full(chunk, 77, ">i2")
        part = volume[tuple(slice(n * c, (n + 1) * c) for n, c in zip(number, chunk))]
        block[tuple(slice(n) for n in part.shape)] = part
        return bytes(encode(block.transpose(1, 2, 0).tobytes()))

    counts = [-(-n // c) for n, c in zip(volume.shape, chunk)]
    for name, (bytes_codecs, encode) in codecs.items():
        inner = [{"name": "transpose", "configuration": {"order": [1, 2, 0]}},
                 {"name": "bytes", "configuration": {"endian": "big"}}, *bytes_codecs]
        for sharded in (False, True):
            path = f"{folder}/{name}{'_sharded' * sharded}.zarr3.zarr"
            index = [{"name": "bytes", "configuration": {"endian": "little"}}, {"name": "crc32c"}]
            files = {}
            for number in itertools.product(*(range(n) for n in counts)):
                if not sharded:
                    files["c/" + "/".join(map(str, number))] = chunk_at(number, encode)
            for shard in itertools.product(*(range(-(-n // 2)) for n in counts)):
                if sharded:
                    data, places = b"", b""
                    for inside in itertools.product(range(2), repeat=3):
                        number = [2 * s + i for s, i in zip(shard, inside)]
                        there = all(n < c for n, c in zip(number, counts))
                        coded = chunk_at(number, encode) if there else b""
                        place = (len(data), len(coded)) if there else (2**64 - 1, 2**64 - 1)
                        places += numpy.array(place, "<u8").tobytes()
                        data += coded
                    files["c/" + "/".join(map(str, shard))] = data + places + crc32c(places)
            shape = [2 * c for c in chunk] if sharded else chunk
            codec = [{"name": "sharding_indexed", "configuration": {
                "chunk_shape": chunk, "codecs": inner,
                "index_codecs": index}}] if sharded else inner
            files["zarr.json"] = json.dumps({
                "zarr_format": 3, "node_type": "array", "shape": volume.shape, "data_type": "int16",
                "chunk_grid": {"name": "regular", "configuration": {"chunk_shape": shape}},
                "chunk_key_encoding": {"name": "default", "configuration": {"separator": "/"}},
                "fill_value": 0, "codecs": codec, "attributes": {}}).encode()
            for file_name, content in files.items():
                os.makedirs(os.path.dirname(f"{path}/{file_name}"), exist_ok=True)
                with open(f"{path}/{file_name}", "wb") as file:
                    file.write(content)
            print(f"file volume.raw {os.path.basename(path)} 0")


def write_hdf5(h5py, folder, volume, labels):
    with h5py.File(f"{folder}/volume.h5", "w") as file:
        data = file.create_dataset("exported_data", data=volume, chunks=(4, 3, 5),
                                   compression="gzip", shuffle=True)
        data.attrs["element_size_um"] = (UM, UM, UM)
        file.create_dataset("more/labels", data=labels)
    print("file volume.raw volume.h5", UM / 1e6, "exported_data")
    print("file labels.raw volume.h5 0 more/labels")


def write_slices(image, folder, volume, labels):
    small = (labels % 251).astype("uint8")
    small.tofile(f"{folder}/small.raw")
    for kind in ("png", "bmp"):
        os.mkdir(f"{folder}/{kind}")
        for z, plane in enumerate(small):
            image.fromarray(plane).save(f"{folder}/{kind}/slice{z}.{kind}")
        print(f"file small.raw {kind} 0")


def write(folder):
    np = module("numpy")
    if np is None:
        return
    count = SHAPE[0] * SHAPE[1] * SHAPE[2]
    volume = (np.random.RandomState(1).permutation(count) - 200).astype("<i2").reshape(SHAPE)
    labels = np.where(volume % 3 == 0, volume.astype("<i8") + 200, 0)
    volume.tofile(f"{folder}/volume.raw")
    labels.tofile(f"{folder}/labels.raw")
    write_numpy(np, folder, volume, labels)
    for name, function in (("nibabel", write_nifti), ("zarr", write_zarr),
                           ("numcodecs", write_zarr3), ("h5py", write_hdf5),
                           ("PIL.Image", write_slices)):
        found = module(name)
        if found:
            function(found, folder, volume, labels)


def check(folder):
    np = module("numpy")
    if np is None:
        return
    labels = np.fromfile(f"{folder}/labels.raw", "<i8").reshape(SHAPE)
    ours = {"ours.npy": np.load(f"{folder}/ours.npy")}
    tifffile, nrrd = module("tifffile"), module("nrrd")
    if tifffile:
        ours["ours.tif"] = tifffile.imread(f"{folder}/ours.tif")
    if nrrd:
        ours["ours.nrrd"] = nrrd.read(f"{folder}/ours.nrrd", index_order="C")[0]
    h5py = module("h5py") if os.path.exists(f"{folder}/ours.h5") else None
    if h5py:
        with h5py.File(f"{folder}/ours.h5") as file:
            data = file["data"]
            if list(data.attrs["element_size_um"]) == [UM] * 3 and data.compression == "gzip":
                ours["ours.h5"] = data[...]
            else:
                print("differs ours.h5", dict(data.attrs), data.compression)
    for name, array in ours.items():
        if array.shape == labels.shape and (array == labels).all():
            print("same", name, array.dtype)
        else:
            print("differs", name, array.dtype, array.shape)


if __name__ == "__main__":
    {"write": write, "check": check}[sys.argv[1]](sys.argv[2])
